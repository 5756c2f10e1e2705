#include "meshes/background_mesh.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/archive.h"
#include "meshes/complaints.h"
#include "meshes/gmsh_file.h"
#include "meshes/partition.h"
#include "meshes/patches.h"
#include "meshes/plex.h"
#include "meshes/simplex.h"
#include "meshes/soundness.h"

namespace talus {

/// What rank 0 keeps of a mesh, so that it can be divided anew.
template <int dim>
struct WholeMesh {
  GmshMesh source;
  std::vector<int> patch;                  ///< of cells
  std::vector<Vec<dim>> centre;            ///< of patches [m]
  std::vector<std::vector<int>> touching;  ///< patches that share faces with a patch

  WholeMesh() = default;
  WholeMesh(GmshMesh of, const Simplices<dim> &cells, const std::vector<int> &patch_of);
  std::vector<double> weight_of_patches(const std::vector<double> &cell_weight) const {
    std::vector<double> weight(centre.size(), 0);
    for (std::size_t c = 0; c < patch.size(); ++c) weight[patch[c]] += cell_weight[c];
    return weight;
  }
};

template <int dim>
WholeMesh<dim>::WholeMesh(GmshMesh of, const Simplices<dim> &cells, const std::vector<int> &patch_of)
    : source(std::move(of)), patch(patch_of) {
  const int count = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
  centre.assign(count, Vec<dim>{}), touching.resize(count);
  std::vector<int> size(count, 0);
  for (std::size_t c = 0; c < patch.size(); ++c) {
    const int p = patch[c];
    for (const auto &x : cells.corners(static_cast<int>(c))) map<dim>(centre[p]) += map<dim>(x) / (dim + 1);
    ++size[p];
    for (int other : cells.neighbour[c])
      if (other >= 0 && patch[other] != p) touching[p].push_back(patch[other]);
  }
  for (int p = 0; p < count; ++p) map<dim>(centre[p]) /= size[p];
}

namespace {

/// 3D, and all nodes of all ranks lie on two planes z = const. Collective.
template <int dim>
bool is_one_element_slice(MPI_Comm comm, const std::vector<Vec<dim>> &position) {
  if constexpr (dim == 2) return false;
  double range[2] = {std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};  // min z, min -z
  for (const auto &x : position) range[0] = std::min(range[0], x[dim - 1]), range[1] = std::min(range[1], -x[dim - 1]);
  MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_DOUBLE, MPI_MIN, comm);
  const double front = range[0], back = -range[1], tolerance = 1e-6 * (back - front);
  int off = std::any_of(position.begin(), position.end(),
                        [=](const auto &x) { return x[dim - 1] > front + tolerance && x[dim - 1] < back - tolerance; });
  MPI_Allreduce(MPI_IN_PLACE, &off, 1, MPI_INT, MPI_MAX, comm);
  return !off;
}

/// Sizes that lock neither nor soften (docs/theory, section on locking).
template <int dim>
int patch_size(bool slice) {
  return dim == 2 ? 2 : slice ? 4 : 8;
}

/// Weight of a cell without a body: so small that much air weighs nothing against the soil, and not 0, so that air
/// alone is divided too.
constexpr double empty_weight = 1e-3;

std::vector<double> weights_of(const Regions &regions,
                               const std::vector<std::pair<std::string, double>> &region_weight) {
  std::vector<double> of_combination(regions.names.size(), empty_weight), weight;
  for (std::size_t k = 0; k < regions.names.size(); ++k)
    for (const auto &[name, value] : region_weight)
      if (std::count(regions.names[k].begin(), regions.names[k].end(), name))
        of_combination[k] = std::max(of_combination[k], value);
  for (int combination : regions.combination) weight.push_back(of_combination[combination]);
  return weight;
}

/// The largest sum of weight on a rank over the mean.
double largest_share(const std::vector<double> &weight, const std::vector<int> &rank, int ranks) {
  std::vector<double> sum(ranks, 0);
  for (std::size_t k = 0; k < weight.size(); ++k) sum[rank[k]] += weight[k];
  const double all = std::accumulate(sum.begin(), sum.end(), 0.);
  return all > 0 ? ranks * *std::max_element(sum.begin(), sum.end()) / all : 1;
}

/// Carries one number per point of rank 0 to the points' new places.
PetscErrorCode carry(PetscSF migration, DM to, const std::vector<PetscInt> &values, std::vector<PetscInt> &carried) {
  PetscInt begin, end;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetChart(to, &begin, &end));
  carried.assign(end - begin, -1);
  PetscCall(PetscSFBcastBegin(migration, MPIU_INT, values.data(), carried.data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(migration, MPIU_INT, values.data(), carried.data(), MPI_REPLACE));
  PetscFunctionReturn(0);
}

/// Part of the numbers of points: those of the cells.
PetscErrorCode of_cells(DM plex, const std::vector<PetscInt> &points, std::vector<PetscInt> &cells) {
  PetscInt first, end;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(plex, 0, &first, &end));
  cells.assign(points.begin() + first, points.begin() + end);
  PetscFunctionReturn(0);
}

template <int dim>
Facet<dim> facet_of(const BackgroundMesh<dim> &mesh, int number, int face) {
  const Cell<dim> &cell = mesh.cells[number];
  ColumnVector<dim> inward = ColumnVector<dim>::Zero();  // gradient of the coordinate that is 0 on the facet
  if (face > 0)
    inward = map<dim>(cell.gradient[face - 1]);
  else
    for (const auto &gradient : cell.gradient) inward -= map<dim>(gradient);
  Facet<dim> facet;
  facet.cell = number, facet.face = face;
  for (int k = 0, i = 0; k <= dim; ++k)
    if (k != face) facet.node[i++] = cell.node[k];
  map<dim>(facet.normal) = -inward.normalized();
  facet.area = dim * mesh.volume[number] * inward.norm();
  return facet;
}

/// Numbers of local cells, unique over all ranks.
PetscErrorCode cell_numbers(DM plex, std::vector<PetscInt> &number) {
  IS numbering;
  const PetscInt *index;
  PetscInt count;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetCellNumbering(plex, &numbering));
  PetscCall(ISGetLocalSize(numbering, &count));
  PetscCall(ISGetIndices(numbering, &index));
  number.assign(index, index + count);
  PetscCall(ISRestoreIndices(numbering, &index));
  PetscFunctionReturn(0);
}

/// Numbers of local points, unique over all ranks.
PetscErrorCode point_numbers(DM plex, std::vector<PetscInt> &number) {
  IS numbering;
  const PetscInt *index;
  PetscInt count;
  PetscFunctionBeginUser;
  PetscCall(DMPlexCreatePointNumbering(plex, &numbering));
  PetscCall(ISGetLocalSize(numbering, &count));
  PetscCall(ISGetIndices(numbering, &index));
  for (PetscInt p = 0; p < count; ++p) number.push_back(index[p] < 0 ? -index[p] - 1 : index[p]);
  PetscCall(ISRestoreIndices(numbering, &index));
  PetscCall(ISDestroy(&numbering));
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
BackgroundMesh<dim> BackgroundMesh<dim>::read(MPI_Comm comm, const std::string &file,
                                              const std::vector<std::pair<std::string, double>> &region_weight,
                                              const Cuts &given) {
  int rank;
  MPI_Comm_rank(comm, &rank);
  std::string complaint;
  GmshMesh source;
  try {
    if (rank == 0) source = read_gmsh(file, dim);
  } catch (const std::invalid_argument &error) {
    complaint = error.what();
  }
  agree(comm, complaint);

  BackgroundMesh mesh;
  Simplices<dim> cells;
  Regions regions;
  require(make_plex(comm, dim, source, mesh.plex_.create(), complaint));
  agree(comm, complaint.empty() ? "" : file + ": " + complaint);
  const std::string remark = std::exchange(source.remark, "");
  require(read_simplices(mesh.plex_, cells));
  require(read_regions(mesh.plex_, regions));
  agree(comm, complaint_about_cells(file, cells, regions, Names::required));
  if (rank == 0) mesh.remarks_ = mesh_remarks(cells, regions);
  if (!remark.empty()) mesh.remarks_.push_back(remark);

  const int size = patch_size<dim>(is_one_element_slice<dim>(comm, cells.position));
  const auto patch = make_patches<dim>(cells.node, cells.neighbour, regions.combination, size);
  int ranks;
  MPI_Comm_size(comm, &ranks);
  if (ranks > 1) {
    const auto whole = rank == 0 ? std::make_shared<const WholeMesh<dim>>(std::move(source), cells, patch)
                                 : std::make_shared<const WholeMesh<dim>>();
    mesh.whole_ = whole, mesh.cuts_ = given;
    if (static_cast<int>(given.size()) + 1 != ranks) {
      mesh.cuts_.resize(ranks - 1);
      if (rank == 0) {
        const std::vector<double> patches = whole->weight_of_patches(weights_of(regions, region_weight));
        mesh.cuts_ = find_cuts<dim>(whole->centre, patches, whole->touching, ranks);
        const double all = std::accumulate(patches.begin(), patches.end(), 0.);
        mesh.heaviest_patch_ = patches.empty() ? 0 : ranks * *std::max_element(patches.begin(), patches.end()) / all;
      }
      MPI_Bcast(&mesh.heaviest_patch_, 1, MPI_DOUBLE, 0, comm);
      MPI_Bcast(mesh.cuts_.data(), static_cast<int>(mesh.cuts_.size() * sizeof(Cut)), MPI_BYTE, 0, comm);
    }
  }
  require(mesh.settle(cells, patch));
  return mesh;
}

template <int dim>
PetscErrorCode BackgroundMesh<dim>::settle(Simplices<dim> &cells, const std::vector<int> &patch) {
  PetscInt begin, end;
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm(), &rank));
  PetscCall(DMPlexGetChart(plex_, &begin, &end));
  std::vector<PetscInt> number, patch_of(end, -1), patches;
  std::copy(patch.begin(), patch.end(), patch_of.begin());  // cells are the first points
  if (cuts_.empty()) {
    number.resize(patch.size());
    std::iota(number.begin(), number.end(), 0);
    PetscCall(of_cells(plex_, patch_of, patches));
    PetscCall(flatten(cells, number, patches));
    PetscFunctionReturn(0);
  }
  Dm distributed;
  StarForest migration;
  std::vector<int> rank_of_cell;
  if (rank == 0) {
    const std::vector<int> rank_of_patch = ranks_by_cuts<dim>(whole_->centre, cuts_);
    for (int p : patch) rank_of_cell.push_back(rank_of_patch[p]);
  }
  std::vector<PetscInt> points(end), patch_of_point;
  std::iota(points.begin(), points.end(), 0);
  PetscCall(distribute(plex_, rank_of_cell, distributed.create(), migration.create()));
  PetscCall(carry(migration, distributed, points, point_number_));
  PetscCall(carry(migration, distributed, patch_of, patch_of_point));
  PetscCall(of_cells(distributed, point_number_, number));
  PetscCall(of_cells(distributed, patch_of_point, patches));
  std::swap(plex_, distributed);
  cells = {};
  PetscCall(read_simplices<dim>(plex_, cells));
  PetscCall(flatten(cells, number, patches));
  PetscFunctionReturn(0);
}

template <int dim>
Cuts BackgroundMesh<dim>::balanced_cuts(const std::vector<std::pair<long long, double>> &filled,
                                        double *imbalance) const {
  struct Weight {
    double cell, weight;
  };
  std::vector<Weight> mine;
  for (const auto &[cell, weight] : filled) mine.push_back({static_cast<double>(cell), weight});
  int rank, ranks, count = static_cast<int>(mine.size() * sizeof(Weight));
  MPI_Comm_rank(comm(), &rank), MPI_Comm_size(comm(), &ranks);
  std::vector<int> counts(ranks), first(ranks + 1, 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm());
  std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
  std::vector<Weight> all(rank == 0 ? first[ranks] / sizeof(Weight) : 0);
  MPI_Gatherv(mine.data(), count, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, 0, comm());
  Cuts cuts(ranks - 1);
  if (rank == 0) {
    std::vector<double> weight(whole_->patch.size(), empty_weight);
    for (const Weight &one : all) weight[static_cast<std::size_t>(one.cell)] = one.weight;
    const std::vector<double> patches = whole_->weight_of_patches(weight);
    cuts = find_cuts<dim>(whole_->centre, patches, whole_->touching, ranks);
    *imbalance = largest_share(patches, ranks_by_cuts<dim>(whole_->centre, cuts), ranks);
  }
  MPI_Bcast(cuts.data(), static_cast<int>(cuts.size() * sizeof(Cut)), MPI_BYTE, 0, comm());
  MPI_Bcast(imbalance, 1, MPI_DOUBLE, 0, comm());
  return cuts;
}

template <int dim>
BackgroundMesh<dim> BackgroundMesh<dim>::divided(const Cuts &cuts) const {
  BackgroundMesh mesh;
  Simplices<dim> none;
  std::string complaint;
  mesh.whole_ = whole_, mesh.cuts_ = cuts, mesh.remarks_ = remarks_;
  require(make_plex(comm(), dim, whole_->source, mesh.plex_.create(), complaint));
  require(mesh.settle(none, whole_->patch));
  return mesh;
}

template <int dim>
PetscErrorCode BackgroundMesh<dim>::find_fingerprint() {
  PetscFunctionBeginUser;
  unsigned long long sum = 0;  // a sum over cells does not depend on which rank has them
  for (int c = 0; c < cell_count(); ++c) {
    unsigned long long one = talus::fingerprint(&global_cell[c], sizeof global_cell[c]);
    for (const int node : cells[c].node) {
      one = talus::fingerprint(&global_node[node], sizeof global_node[node], one);
      one = talus::fingerprint(position[node].data(), sizeof position[node], one);
    }
    sum += one;
  }
  PetscCallMPI(MPI_Allreduce(&sum, &fingerprint_, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm()));
  PetscFunctionReturn(0);
}

template <int dim>
std::vector<long long> BackgroundMesh<dim>::global_edges() const {
  PetscInt first, end;
  require(DMPlexGetDepthStratum(plex_, 1, &first, &end));
  std::vector<long long> edges;
  for (PetscInt edge = first; edge < end; ++edge) edges.push_back(global_point(edge));
  return edges;
}

template <int dim>
unsigned long long BackgroundMesh<dim>::partition_fingerprint() const {
  return talus::fingerprint(global_cell.data(), global_cell.size() * sizeof(long long));
}

template <int dim>
BackgroundMesh<dim> BackgroundMesh<dim>::adopt(DM plex) {
  const MPI_Comm comm = PetscObjectComm((PetscObject)plex);
  agree(comm, complaint_about_plex(plex, dim));
  BackgroundMesh mesh;
  Simplices<dim> cells;
  Regions regions;
  require(PetscObjectReference((PetscObject)plex));
  *mesh.plex_.create() = plex;
  require(read_simplices(plex, cells));
  require(read_regions(plex, regions));
  agree(comm, complaint_about_cells("the DMPlex of the host program", cells, regions, Names::optional));

  const int size = patch_size<dim>(is_one_element_slice<dim>(comm, cells.position));
  const auto patch = make_patches<dim>(cells.node, cells.neighbour, regions.combination, size);
  std::vector<PetscInt> number;
  require(cell_numbers(plex, number));
  require(point_numbers(plex, mesh.point_number_));
  require(mesh.flatten(cells, number, std::vector<PetscInt>(patch.begin(), patch.end())));
  return mesh;
}

template <int dim>
bool BackgroundMesh<dim>::has_region(const std::string &name) const {
  return std::binary_search(region_names_.begin(), region_names_.end(), name);
}

template <int dim>
bool BackgroundMesh<dim>::has_group(const std::string &name) const {
  return std::binary_search(group_names_.begin(), group_names_.end(), name);
}

template <int dim>
std::vector<int> BackgroundMesh<dim>::region(const std::string &name) const {
  std::vector<PetscInt> points;
  if (has_region(name)) require(points_at_height(plex_, name, 0, points));
  std::vector<int> cell;
  for (PetscInt p : points) cell.push_back(flat_cell_[p - first_plex_cell_]);
  std::sort(cell.begin(), cell.end());
  return cell;
}

template <int dim>
std::vector<Facet<dim>> BackgroundMesh<dim>::facets(const std::string &group) const {
  std::vector<PetscInt> points;
  if (has_group(group)) require(points_at_height(plex_, group, 1, points));
  std::vector<Facet<dim>> facets;
  for (PetscInt p : points) {
    PetscInt count;
    const PetscInt *support;
    require(DMPlexGetSupportSize(plex_, p, &count));
    require(DMPlexGetSupport(plex_, p, &support));
    for (PetscInt i = 0; i < count; ++i) {
      const int cell = flat_cell_[support[i] - first_plex_cell_];
      const auto &around = plex_facet_[cell];
      facets.push_back(
          facet_of(*this, cell, static_cast<int>(std::find(around.begin(), around.end(), p) - around.begin())));
    }
  }
  std::sort(facets.begin(), facets.end(),
            [](const auto &a, const auto &b) { return std::pair(a.cell, a.face) < std::pair(b.cell, b.face); });
  return facets;
}

template <int dim>
void BackgroundMesh<dim>::close(const std::string &group) {
  closed.resize(cells.size(), 0);
  for (const Facet<dim> &f : facets(group)) closed[f.cell] = static_cast<char>(closed[f.cell] | 1 << f.face);
}

template <int dim>
MeshReport BackgroundMesh<dim>::report() const {
  MeshReport report{};
  double smallest[2] = {std::numeric_limits<double>::max(), 1}, quality = 0;
  for (const Cell<dim> &cell : cells) {
    std::array<Vec<dim>, dim + 1> corner;
    for (int k = 0; k <= dim; ++k) corner[k] = position[cell.node[k]];
    const Shape one = shape<dim>(corner, cell.gradient);
    smallest[0] = std::min(smallest[0], one.altitude);
    smallest[1] = std::min(smallest[1], one.quality);
    quality += one.quality;
  }
  long long counts[2] = {cell_count(), std::count(owned.begin(), owned.end(), 1)};
  MPI_Allreduce(MPI_IN_PLACE, smallest, 2, MPI_DOUBLE, MPI_MIN, comm());
  MPI_Allreduce(MPI_IN_PLACE, &quality, 1, MPI_DOUBLE, MPI_SUM, comm());
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_LONG_LONG, MPI_SUM, comm());
  report.cells = counts[0], report.nodes = counts[1];
  report.smallest_altitude = smallest[0], report.smallest_quality = smallest[1];
  report.mean_quality = quality / static_cast<double>(std::max(1LL, report.cells));
  report.one_element_slice = is_one_element_slice<dim>(comm(), position);
  report.remarks = remarks_;
  return report;
}

template class BackgroundMesh<2>;
template class BackgroundMesh<3>;

}  // namespace talus
