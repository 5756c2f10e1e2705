#include "meshes/background_mesh.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "meshes/complaints.h"
#include "meshes/gmsh_file.h"
#include "meshes/partition.h"
#include "meshes/patches.h"
#include "meshes/plex.h"
#include "meshes/simplex.h"
#include "meshes/soundness.h"

namespace talus {
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

/// Carries one number per cell of rank 0 to the cells' new places.
PetscErrorCode carry(PetscSF migration, DM from, DM to, const std::vector<PetscInt> &values,
                     std::vector<PetscInt> &carried) {
  PetscInt first, end, begin_from, end_from, begin_to, end_to;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetChart(from, &begin_from, &end_from));
  PetscCall(DMPlexGetChart(to, &begin_to, &end_to));
  std::vector<PetscInt> roots(end_from - begin_from, -1), leaves(end_to - begin_to, -1);
  PetscCall(DMPlexGetHeightStratum(from, 0, &first, &end));
  std::copy(values.begin(), values.end(), roots.begin() + (first - begin_from));
  PetscCall(PetscSFBcastBegin(migration, MPIU_INT, roots.data(), leaves.data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(migration, MPIU_INT, roots.data(), leaves.data(), MPI_REPLACE));
  PetscCall(DMPlexGetHeightStratum(to, 0, &first, &end));
  carried.assign(leaves.begin() + (first - begin_to), leaves.begin() + (end - begin_to));
  PetscFunctionReturn(0);
}

/// Ranks of cells: whole patches, equal sums of weight.
template <int dim>
std::vector<int> ranks_of_cells(const Simplices<dim> &cells, const std::vector<int> &patch,
                                const std::vector<double> &weight, int ranks) {
  const int count = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
  std::vector<Vec<dim>> centre(count, Vec<dim>{});
  std::vector<double> patch_weight(count, 0);
  std::vector<int> size(count, 0);
  std::vector<std::vector<int>> touching(count);
  for (std::size_t c = 0; c < patch.size(); ++c) {
    const int p = patch[c];
    for (const auto &x : cells.corners(static_cast<int>(c))) map<dim>(centre[p]) += map<dim>(x) / (dim + 1);
    patch_weight[p] += weight[c], ++size[p];
    for (int other : cells.neighbour[c])
      if (other >= 0 && patch[other] != p) touching[p].push_back(patch[other]);
  }
  for (int p = 0; p < count; ++p) map<dim>(centre[p]) /= size[p];
  const auto rank = partition<dim>(centre, patch_weight, touching, ranks);
  std::vector<int> rank_of_cell;
  for (int p : patch) rank_of_cell.push_back(rank[p]);
  return rank_of_cell;
}

/// Gives each patch of rank 0 to one rank and moves the cells; number and patch of a cell move along.
template <int dim>
PetscErrorCode distribute_patches(Dm &plex, Simplices<dim> &cells, const std::vector<int> &patch,
                                  const std::vector<double> &weight, std::vector<PetscInt> &number,
                                  std::vector<PetscInt> &patch_of) {
  Dm distributed;
  StarForest migration;
  int ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)(DM)plex), &ranks));
  patch_of.assign(patch.begin(), patch.end());
  for (std::size_t c = 0; c < patch.size(); ++c) number.push_back(static_cast<PetscInt>(c));
  if (ranks == 1) PetscFunctionReturn(0);
  PetscCall(
      distribute(plex, ranks_of_cells<dim>(cells, patch, weight, ranks), distributed.create(), migration.create()));
  PetscCall(carry(migration, plex, distributed, std::vector(number), number));
  PetscCall(carry(migration, plex, distributed, std::vector(patch_of), patch_of));
  std::swap(plex, distributed);
  cells = {};
  PetscCall(read_simplices<dim>(plex, cells));
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

}  // namespace

template <int dim>
BackgroundMesh<dim> BackgroundMesh<dim>::read(MPI_Comm comm, const std::string &file,
                                              const std::vector<std::pair<std::string, double>> &region_weight) {
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
  const std::string remark = std::move(source.remark);
  source = {};
  require(read_simplices(mesh.plex_, cells));
  require(read_regions(mesh.plex_, regions));
  agree(comm, complaint_about_cells(file, cells, regions, Names::required));
  if (rank == 0) mesh.remarks_ = mesh_remarks(cells, regions);
  if (!remark.empty()) mesh.remarks_.push_back(remark);

  const int size = patch_size<dim>(is_one_element_slice<dim>(comm, cells.position));
  const auto patch = make_patches<dim>(cells.node, cells.neighbour, regions.combination, size);
  std::vector<PetscInt> number, patch_of;
  require(distribute_patches(mesh.plex_, cells, patch, weights_of(regions, region_weight), number, patch_of));
  require(mesh.flatten(cells, number, patch_of));
  return mesh;
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
