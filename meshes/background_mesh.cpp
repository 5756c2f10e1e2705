#include "meshes/background_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/archive.h"
#include "base/freed_memory.h"
#include "base/local_numbers.h"
#include "meshes/complaints.h"
#include "meshes/gmsh_file.h"
#include "meshes/mesh_part.h"
#include "meshes/plex.h"
#include "meshes/refine.h"
#include "meshes/side_columns.h"
#include "meshes/simplex.h"
#include "meshes/soundness.h"
#include "meshes/whole_mesh.h"

namespace talus {

namespace {

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

/// Adds up what lies in the same cell of the mesh that was divided, of which each cell was refined into `children`.
template <int dim>
std::vector<FilledCell<dim>> in_larger_cells(std::vector<FilledCell<dim>> cells, long long children) {
  if (children == 1) return cells;
  std::ranges::sort(cells, {}, &FilledCell<dim>::number);  // so that sums do not depend on the order in memory
  std::vector<FilledCell<dim>> sums;
  for (const FilledCell<dim> &one : cells) {
    if (sums.empty() || sums.back().number != one.number / children) sums.push_back({one.number / children, 0, {}});
    sums.back().weight += one.weight;
    map<dim>(sums.back().way) += one.weight * map<dim>(one.way);
  }
  for (FilledCell<dim> &sum : sums) map<dim>(sum.way) /= sum.weight;
  return sums;
}

}  // namespace

template <int dim>
BackgroundMesh<dim> BackgroundMesh<dim>::read(MPI_Comm comm, const std::string &file,
                                              const std::vector<std::pair<std::string, double>> &region_weight,
                                              const Cuts &given, int halvings, const SeedCounts &seeds,
                                              const std::vector<std::string> &sides) {
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
  if (!sides.empty()) {
    for (const std::string &side : sides)
      if (rank == 0 && complaint.empty()) complaint = add_column_beside<dim>(source, side);
    if (complaint.empty()) all = part_of_file<dim>(source, complaint);
    agree(comm, complaint.empty() ? "" : file + ": " + complaint);
  }
  double counts[2] = {static_cast<double>(all.cells.node.size()), 0};
  for (const FilledCell<dim> &one : filled_cells<dim>(all.regions, seeds.per_cell))
    counts[1] += std::ldexp(one.weight, dim * halvings);
  MPI_Bcast(counts, 2, MPI_DOUBLE, 0, comm);
  agree(comm, complaint_about_needs<dim>(comm, counts[0], counts[1], seeds.numbers_per_cell, halvings));
  if (!remark.empty()) mesh.remarks_.push_back(remark);
  for (std::string &one : mesh.remarks_)
    if (halvings > 0) one = "Of the mesh before its edges are halved: " + one;

  for (const auto &one : region_weight) mesh.element_regions_.push_back(one.first);
  cut_patches(comm, all, all.regions.combination);
  int ranks;
  MPI_Comm_size(comm, &ranks);
  if (ranks > 1) {
    const auto whole = std::make_shared<WholeMesh<dim>>(std::move(source), all);
    mesh.whole_ = whole, mesh.cuts_ = given;
    if (static_cast<int>(given.size()) + 1 != ranks) {
      mesh.cuts_.resize(ranks - 1);
      if (rank == 0) {
        const auto balance = whole->balance(filled_cells<dim>(all.regions, region_weight), 0, ranks);
        mesh.cuts_ = balance.cuts, mesh.heaviest_patch_ = balance.heaviest_patch;
      }
      MPI_Bcast(&mesh.heaviest_patch_, 1, MPI_DOUBLE, 0, comm);
      MPI_Bcast(mesh.cuts_.data(), static_cast<int>(mesh.cuts_.size() * sizeof(Cut)), MPI_BYTE, 0, comm);
    }
  }
  source = GmshMesh(), mesh.halvings_ = halvings;
  require(mesh.settle(std::move(all)));
  return mesh;
}

template <int dim>
PetscErrorCode BackgroundMesh<dim>::settle(MeshPart<dim> part) {
  PetscFunctionBeginUser;
  hand_back_freed_memory();  // of what was made to read and check the mesh
  if (!cuts_.empty()) part = deal_out(comm(), part, whole_->ranks_of_cells(cuts_));
  for (int k = 0; k < halvings_; ++k) part = refine(comm(), part);
  if (halvings_ > 0) cut_patches(comm(), part, part.patch, true);
  PetscCall(flatten(std::move(part)));
  hand_back_freed_memory();
  PetscFunctionReturn(0);
}

template <int dim>
Cuts BackgroundMesh<dim>::balanced_cuts(const std::vector<FilledCell<dim>> &filled, double cost,
                                        PartitionForecast *forecast) const {
  const std::vector<FilledCell<dim>> mine = in_larger_cells(filled, 1LL << dim * halvings_);
  int rank, ranks, count = static_cast<int>(mine.size() * sizeof(FilledCell<dim>));
  MPI_Comm_rank(comm(), &rank), MPI_Comm_size(comm(), &ranks);
  std::vector<int> counts(ranks), first(ranks + 1, 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm());
  std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
  std::vector<FilledCell<dim>> all(rank == 0 ? first[ranks] / sizeof(FilledCell<dim>) : 0);
  MPI_Gatherv(mine.data(), count, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, 0, comm());
  Cuts cuts(ranks - 1);
  if (rank == 0) {
    const auto balance = whole_->balance(all, cost, ranks);
    cuts = balance.cuts, *forecast = balance.forecast;
  }
  MPI_Bcast(cuts.data(), static_cast<int>(cuts.size() * sizeof(Cut)), MPI_BYTE, 0, comm());
  MPI_Bcast(forecast, sizeof *forecast, MPI_BYTE, 0, comm());
  return cuts;
}

template <int dim>
BackgroundMesh<dim> BackgroundMesh<dim>::divided(const Cuts &cuts) const {
  BackgroundMesh mesh;
  mesh.comm_ = Communicator(comm());
  mesh.whole_ = whole_, mesh.cuts_ = cuts, mesh.halvings_ = halvings_, mesh.remarks_ = remarks_;
  mesh.element_regions_ = element_regions_;
  require(mesh.settle(whole_->part()));
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

  cut_patches(comm, part, part.regions.combination);
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
void BackgroundMesh<dim>::tie(const std::vector<std::vector<long long>> &groups) {
  ties = LinkedNodes(comm(), united(groups), global_node, owned);
  ties.find_places([](int node) { return node; });
  require(ties.sum(nodal_volume.data(), 1));
  const LocalNumbers node_of(global_node);
  for (const auto &group : ties.groups())
    for (std::size_t k = 1; k < group.size(); ++k)
      if (const int node = node_of.find(group[k]); node >= 0) counted[node] = 0;
}

template <int dim>
MeshReport BackgroundMesh<dim>::report() const {
  MeshReport report{};
  double smallest[2] = {std::numeric_limits<double>::max(), 1}, quality = 0;
  const int count = cells_in_sheet();
  for (int c = 0; c < count; ++c) {
    const Cell<dim> &cell = cells[c];
    std::array<Vec<dim>, dim + 1> corner;
    for (int k = 0; k <= dim; ++k) corner[k] = position[cell.node[k]];
    const Shape one = shape<dim>(corner, cell.gradient);
    smallest[0] = std::min(smallest[0], one.altitude);
    smallest[1] = std::min(smallest[1], one.quality);
    quality += one.quality;
  }
  long long counts[2] = {count, std::count(owned.begin(), owned.begin() + nodes_in_sheet(), 1)};
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
