#include "meshes/background_mesh.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/archive.h"
#include "base/freed_memory.h"
#include "base/local_numbers.h"
#include "meshes/complaints.h"
#include "meshes/gmsh_file.h"
#include "meshes/mesh_part.h"
#include "meshes/partition.h"
#include "meshes/patches.h"
#include "meshes/plex.h"
#include "meshes/simplex.h"
#include "meshes/soundness.h"

namespace talus {

/// What rank 0 keeps of a mesh: on one rank the cells that may have finite elements, on several all for new partitions.
template <int dim>
struct WholeMesh {
  TakenCells with_elements;

  GmshMesh source;
  std::vector<char> has_elements;          ///< cells that may have finite elements
  std::vector<int> patch;                  ///< of cells
  std::vector<Vec<dim>> centre;            ///< of patches [m]
  std::vector<std::vector<int>> touching;  ///< patches that share faces with a patch

  std::vector<double> weight_of_patches(const std::vector<double> &cell_weight) const {
    std::vector<double> weight(centre.size(), 0);
    for (std::size_t c = 0; c < patch.size(); ++c) weight[patch[c]] += cell_weight[c];
    return weight;
  }
  void find_patches(const Simplices<dim> &cells);
  std::vector<int> ranks_of_cells(const Cuts &cuts) const {
    const std::vector<int> rank_of_patch = ranks_by_cuts<dim>(centre, cuts);
    std::vector<int> rank;
    rank.reserve(patch.size());
    for (const int p : patch) rank.push_back(rank_of_patch[p]);
    return rank;
  }
  std::vector<int> ranks_of_element_cells(const Cuts &cuts) const {
    const std::vector<int> all = ranks_of_cells(cuts);
    std::vector<int> rank;
    for (std::size_t c = 0; c < all.size(); ++c)
      if (has_elements[c]) rank.push_back(all[c]);
    return rank;
  }
};

template <int dim>
void WholeMesh<dim>::find_patches(const Simplices<dim> &cells) {
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

/// Cells of regions that have a weight, or all where none has.
std::vector<char> cells_with_elements(const Regions &regions,
                                      const std::vector<std::pair<std::string, double>> &region_weight) {
  std::vector<char> of_combination, of_cell;
  for (const std::vector<std::string> &names : regions.names)
    of_combination.push_back(region_weight.empty() ||
                             std::any_of(region_weight.begin(), region_weight.end(), [&](const auto &one) {
                               return std::count(names.begin(), names.end(), one.first) > 0;
                             }));
  for (const int combination : regions.combination) of_cell.push_back(of_combination[combination]);
  return of_cell;
}

/// The largest sum of weight on a rank over the mean.
double largest_share(const std::vector<double> &weight, const std::vector<int> &rank, int ranks) {
  std::vector<double> sum(ranks, 0);
  for (std::size_t k = 0; k < weight.size(); ++k) sum[rank[k]] += weight[k];
  const double all = std::accumulate(sum.begin(), sum.end(), 0.);
  return all > 0 ? ranks * *std::max_element(sum.begin(), sum.end()) / all : 1;
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

/// A mesh that is whole on rank 0, from its file.
template <int dim>
MeshPart<dim> part_of_file(const GmshMesh &source, std::string &complaint) {
  MeshPart<dim> part;
  if (source.cells.empty()) return part;  // as on other ranks
  read_mesh<dim>(source, part.cells, part.groups, complaint);
  if (!complaint.empty()) return part;
  const long long cells = static_cast<long long>(part.cells.node.size());
  part.regions = combine(static_cast<int>(cells), source.regions);
  part.cell_number.resize(cells), part.node_number.resize(part.cells.position.size());
  std::iota(part.cell_number.begin(), part.cell_number.end(), 0);
  std::iota(part.node_number.begin(), part.node_number.end(), cells);
  part.owned.assign(part.node_number.size(), 1);
  part.mean_edge = mean_edges<dim>(part.cells, source);
  return part;
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
  mesh.comm_ = Communicator(comm);
  MeshPart<dim> all = part_of_file<dim>(source, complaint);
  agree(comm, complaint.empty() ? "" : file + ": " + complaint);
  const std::string remark = std::exchange(source.remark, "");
  {
    const CellTree<dim> tree(all.cells);
    agree(comm, complaint_about_cells(file, all.cells, tree, all.regions, Names::required));
    if (rank == 0) mesh.remarks_ = mesh_remarks(all.cells, tree, all.regions);
  }
  if (!remark.empty()) mesh.remarks_.push_back(remark);

  const int size = patch_size<dim>(is_one_element_slice<dim>(comm, all.cells.position));
  all.patch = make_patches<dim>(all.cells.node, all.cells.neighbour, all.regions.combination, size);
  const auto whole = std::make_shared<WholeMesh<dim>>();
  mesh.whole_ = whole;
  int ranks;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) {
    whole->with_elements = take_cells(dim, source, cells_with_elements(all.regions, region_weight));
    source = GmshMesh();
  } else {
    whole->source = std::move(source), whole->has_elements = cells_with_elements(all.regions, region_weight);
    whole->patch = all.patch;
    whole->find_patches(all.cells);
    mesh.cuts_ = given;
    if (static_cast<int>(given.size()) + 1 != ranks) {
      mesh.cuts_.resize(ranks - 1);
      if (rank == 0) {
        const std::vector<double> patches = whole->weight_of_patches(weights_of(all.regions, region_weight));
        mesh.cuts_ = find_cuts<dim>(whole->centre, {patches, {}}, whole->touching, ranks);
        const double sum = std::accumulate(patches.begin(), patches.end(), 0.);
        mesh.heaviest_patch_ = patches.empty() ? 0 : ranks * *std::max_element(patches.begin(), patches.end()) / sum;
      }
      MPI_Bcast(&mesh.heaviest_patch_, 1, MPI_DOUBLE, 0, comm);
      MPI_Bcast(mesh.cuts_.data(), static_cast<int>(mesh.cuts_.size() * sizeof(Cut)), MPI_BYTE, 0, comm);
    }
  }
  require(mesh.settle(std::move(all)));
  return mesh;
}

template <int dim>
PetscErrorCode BackgroundMesh<dim>::settle(MeshPart<dim> whole) {
  PetscFunctionBeginUser;
  hand_back_freed_memory();  // of what was made to read and check the mesh
  if (!cuts_.empty()) whole = deal_out(comm(), whole, whole_->ranks_of_cells(cuts_));
  PetscCall(flatten(std::move(whole)));
  hand_back_freed_memory();
  PetscFunctionReturn(0);
}

template <int dim>
Cuts BackgroundMesh<dim>::balanced_cuts(const std::vector<FilledCell<dim>> &filled, double cost,
                                        double *imbalance) const {
  int rank, ranks, count = static_cast<int>(filled.size() * sizeof(FilledCell<dim>));
  MPI_Comm_rank(comm(), &rank), MPI_Comm_size(comm(), &ranks);
  std::vector<int> counts(ranks), first(ranks + 1, 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm());
  std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
  std::vector<FilledCell<dim>> all(rank == 0 ? first[ranks] / sizeof(FilledCell<dim>) : 0);
  MPI_Gatherv(filled.data(), count, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, 0, comm());
  Cuts cuts(ranks - 1);
  if (rank == 0) {
    std::vector<double> weight(whole_->patch.size(), empty_weight);
    PatchLoad<dim> load;
    load.way.resize(whole_->centre.size());
    for (const FilledCell<dim> &one : all) {
      weight[one.number] = one.weight;
      map<dim>(load.way[whole_->patch[one.number]]) += one.weight * map<dim>(one.way);
    }
    load.weight = whole_->weight_of_patches(weight), load.partition_cost = cost;
    for (std::size_t p = 0; p < load.way.size(); ++p) map<dim>(load.way[p]) /= load.weight[p];
    cuts = find_cuts<dim>(whole_->centre, load, whole_->touching, ranks);
    *imbalance = largest_share(load.weight, ranks_by_cuts<dim>(whole_->centre, cuts), ranks);
  }
  MPI_Bcast(cuts.data(), static_cast<int>(cuts.size() * sizeof(Cut)), MPI_BYTE, 0, comm());
  MPI_Bcast(imbalance, 1, MPI_DOUBLE, 0, comm());
  return cuts;
}

template <int dim>
BackgroundMesh<dim> BackgroundMesh<dim>::divided(const Cuts &cuts) const {
  BackgroundMesh mesh;
  std::string complaint;  // there was none when it was read
  mesh.comm_ = Communicator(comm());
  mesh.whole_ = whole_, mesh.cuts_ = cuts, mesh.remarks_ = remarks_;
  MeshPart<dim> all = part_of_file<dim>(whole_->source, complaint);
  all.patch = whole_->patch;
  require(mesh.settle(std::move(all)));
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
const ElementPlex &BackgroundMesh<dim>::element_plex() const {
  if (elements_) return *elements_;
  const auto made = std::make_shared<ElementPlex>();
  const TakenCells &alone = whole_->with_elements;
  if (cuts_.empty())
    require(
        make_plex(comm(), dim, alone, std::vector<int>(alone.corner.size() / (dim + 1), 0), made->dm, made->number));
  else
    require(make_plex(comm(), dim, take_cells(dim, whole_->source, whole_->has_elements),
                      whole_->ranks_of_element_cells(cuts_), made->dm, made->number));
  PetscInt first, end;
  require(DMPlexGetDepthStratum(made->dm, 0, &first, &end));
  made->vertex.assign(node_count(), -1);
  const LocalNumbers node_of(global_node);
  for (PetscInt p = first; p < end; ++p) made->vertex[node_of(made->number[p])] = p;
  elements_ = made;
  return *elements_;
}

template <int dim>
std::vector<long long> BackgroundMesh<dim>::global_edges() const {
  PetscInt first, end;
  const ElementPlex &plex = element_plex();
  require(DMPlexGetDepthStratum(plex.dm, 1, &first, &end));
  return {plex.number.begin() + first, plex.number.begin() + end};
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
  MeshPart<dim> part;
  HostPoints points;
  mesh.comm_ = Communicator(comm);
  require(part_of_plex(plex, part, points));
  agree(comm, complaint_about_cells("the DMPlex of the host program", part.cells, CellTree<dim>(part.cells),
                                    part.regions, Names::optional));

  const int size = patch_size<dim>(is_one_element_slice<dim>(comm, part.cells.position));
  part.patch = make_patches<dim>(part.cells.node, part.cells.neighbour, part.regions.combination, size);
  require(mesh.flatten(std::move(part)));
  const auto elements = std::make_shared<ElementPlex>();
  require(PetscObjectReference((PetscObject)plex));
  *elements->dm.create() = plex;
  const LocalNumbers node_of(mesh.global_node);
  elements->vertex.assign(mesh.node_count(), -1);
  for (const PetscInt p : points.vertex)
    if (const int i = node_of.find(points.number[p]); i >= 0) elements->vertex[i] = p;
  elements->number = std::move(points.number);
  mesh.host_vertex = elements->vertex;
  mesh.elements_ = elements;
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
  std::vector<char> inside;
  for (const auto &names : regions_.names) inside.push_back(std::count(names.begin(), names.end(), name) > 0);
  std::vector<int> cell;
  for (int c = 0; c < cell_count(); ++c)
    if (inside[regions_.combination[c]]) cell.push_back(c);
  return cell;
}

template <int dim>
std::vector<Facet<dim>> BackgroundMesh<dim>::facets(const std::string &group) const {
  std::vector<Facet<dim>> facets;
  for (const auto &[name, sides] : groups_)
    for (const Side &side : sides)
      if (name == group) facets.push_back(facet_of(*this, side.cell, side.face));
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
