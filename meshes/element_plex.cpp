// The DMPlex of finite elements: each rank makes it of the cells that it has.

#include <petscsf.h>

#include <algorithm>
#include <limits>
#include <map>

#include "meshes/background_mesh.h"
#include "meshes/complaints.h"
#include "meshes/exchange.h"
#include "meshes/mesh_part.h"

namespace talus {
namespace {

/// Cells with elements and their nodes, both ascending in their numbers.
struct Elements {
  std::vector<int> cell, node;
  std::vector<int> place;  ///< in `node`, of each node of the mesh, or -1
};

template <int dim>
Elements find_elements(const BackgroundMesh<dim> &mesh, const std::vector<int> &cells) {
  Elements elements{cells, {}, std::vector<int>(mesh.node_count(), -1)};
  const auto sort = [](std::vector<int> &list, const std::vector<long long> &number) {
    std::sort(list.begin(), list.end(), [&](int a, int b) { return number[a] < number[b]; });
  };
  sort(elements.cell, mesh.global_cell);
  for (const int c : cells)
    for (const int i : mesh.cells[c].node)
      if (elements.place[i] < 0) elements.place[i] = 0, elements.node.push_back(i);
  sort(elements.node, mesh.global_node);
  for (std::size_t k = 0; k < elements.node.size(); ++k) elements.place[elements.node[k]] = static_cast<int>(k);
  return elements;
}

/// Vertices that several ranks have: the highest of these ranks owns them.
template <int dim>
PetscErrorCode join_vertices(const BackgroundMesh<dim> &mesh, const Elements &elements, DM plex) {
  PetscInt begin, end;
  PetscSF sf;
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(mesh.comm(), &rank));
  PetscCall(DMPlexGetChart(plex, &begin, &end));
  const PetscInt first = static_cast<PetscInt>(elements.cell.size());  // vertices come after the cells
  std::vector<std::vector<PetscInt>> mine;
  for (const std::vector<int> &nodes : mesh.halo.shared()) {
    mine.emplace_back();
    for (const int i : nodes) mine.back().push_back(elements.place[i] < 0 ? -1 : first + elements.place[i]);
  }
  const auto theirs = exchange(mesh.comm(), mesh.halo.neighbours(), mine);
  std::map<PetscInt, PetscSFNode> owner;  // neighbours ascend, so the highest one stays
  for (std::size_t k = 0; k < theirs.size(); ++k)
    for (std::size_t i = 0; i < theirs[k].size(); ++i)
      if (const int there = mesh.halo.neighbours()[k]; there > rank && mine[k][i] >= 0 && theirs[k][i] >= 0)
        owner[mine[k][i]] = {there, theirs[k][i]};
  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  for (const auto &[point, root] : owner) leaves.push_back(point), roots.push_back(root);
  PetscCall(DMGetPointSF(plex, &sf));
  PetscCall(PetscSFSetGraph(sf, end, static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES,
                            roots.data(), PETSC_COPY_VALUES));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode make_plex(const BackgroundMesh<dim> &mesh, const Elements &elements, Dm &plex) {
  int ranks;
  Dm cells;
  std::vector<PetscInt> corner;
  std::vector<double> position;
  PetscFunctionBeginUser;
  for (const int c : elements.cell) {
    for (const int i : mesh.cells[c].node) corner.push_back(elements.place[i]);
    if (dim == 3) std::swap(corner.end()[-1], corner.end()[-2]);  // DMPlex turns the sides of tetrahedra outward
  }
  for (const int i : elements.node) position.insert(position.end(), mesh.position[i].begin(), mesh.position[i].end());
  PetscCall(DMCreate(mesh.comm(), cells.create()));
  PetscCall(DMSetType(cells, DMPLEX));
  PetscCall(DMSetDimension(cells, dim));
  PetscCall(DMPlexBuildFromCellList(cells, static_cast<PetscInt>(elements.cell.size()),
                                    static_cast<PetscInt>(elements.node.size()), dim + 1, corner.data()));
  PetscCallMPI(MPI_Comm_size(mesh.comm(), &ranks));
  if (ranks > 1) PetscCall(join_vertices(mesh, elements, cells));
  PetscCall(DMPlexInterpolate(cells, plex.create()));  // which finds the edges that ranks share
  PetscCall(DMPlexBuildCoordinatesFromCellList(plex, dim, position.data()));
  PetscFunctionReturn(0);
}

/// Numbers of vertices and edges that do not depend on the partition; other points have none.
template <int dim>
PetscErrorCode number_points(const BackgroundMesh<dim> &mesh, const Elements &elements, long long end_of_nodes, DM plex,
                             std::vector<long long> &number) {
  PetscInt begin, end, first_edge, end_edge;
  PetscSF sf;
  PetscInt roots;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetChart(plex, &begin, &end));
  PetscCall(DMPlexGetDepthStratum(plex, 1, &first_edge, &end_edge));
  const PetscInt first = static_cast<PetscInt>(elements.cell.size());
  number.assign(end, std::numeric_limits<long long>::max());
  for (std::size_t k = 0; k < elements.node.size(); ++k) number[first + k] = mesh.global_node[elements.node[k]];
  for (PetscInt c = 0; c < first; ++c) {
    PetscInt *closure = nullptr, count;
    const int cell = elements.cell[c];
    const auto &node = mesh.cells[cell].node;
    PetscCall(DMPlexGetTransitiveClosure(plex, c, PETSC_TRUE, &count, &closure));
    for (PetscInt k = 0; k < count; ++k) {
      const PetscInt *ends, edge = closure[2 * k];
      if (edge < first_edge || edge >= end_edge) continue;
      PetscCall(DMPlexGetCone(plex, edge, &ends));
      const int low = elements.node[ends[0] - first], high = elements.node[ends[1] - first];
      for (std::size_t e = 0; e < simplex_edges<dim>.size(); ++e) {
        const auto [a, b] = simplex_edges<dim>[e];
        if ((node[a] != low || node[b] != high) && (node[a] != high || node[b] != low)) continue;
        const long long one = edge_number<dim>(end_of_nodes, mesh.global_cell[cell], static_cast<int>(e));
        number[edge] = std::min(number[edge], one);
      }
    }
    PetscCall(DMPlexRestoreTransitiveClosure(plex, c, PETSC_TRUE, &count, &closure));
  }
  PetscCall(DMGetPointSF(plex, &sf));
  PetscCall(PetscSFGetGraph(sf, &roots, nullptr, nullptr, nullptr));
  if (roots >= 0) {
    std::vector<long long> least = number;
    PetscCall(PetscSFReduceBegin(sf, MPI_LONG_LONG, number.data(), least.data(), MPI_MIN));
    PetscCall(PetscSFReduceEnd(sf, MPI_LONG_LONG, number.data(), least.data(), MPI_MIN));
    number = least;
    PetscCall(PetscSFBcastBegin(sf, MPI_LONG_LONG, least.data(), number.data(), MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(sf, MPI_LONG_LONG, least.data(), number.data(), MPI_REPLACE));
  }
  for (long long &one : number)
    if (one == std::numeric_limits<long long>::max()) one = -1;
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
const ElementPlex &BackgroundMesh<dim>::element_plex() const {
  if (elements_) return *elements_;
  const auto made = std::make_shared<ElementPlex>();
  std::vector<int> cells;
  std::vector<char> has_elements;  // of combinations of regions
  for (const std::vector<std::string> &names : regions_.names)
    has_elements.push_back(element_regions_.empty() ||
                           std::any_of(names.begin(), names.end(), [&](const std::string &name) {
                             return std::count(element_regions_.begin(), element_regions_.end(), name) > 0;
                           }));
  for (int c = 0; c < cell_count(); ++c)
    if (has_elements[regions_.combination[c]]) cells.push_back(c);
  const Elements elements = find_elements(*this, cells);
  require(make_plex(*this, elements, made->dm));
  require(number_points(*this, elements, end_of_numbers_, made->dm, made->number));
  made->vertex.assign(node_count(), -1);
  for (std::size_t k = 0; k < elements.node.size(); ++k)
    made->vertex[elements.node[k]] = static_cast<PetscInt>(elements.cell.size() + k);
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

template const ElementPlex &BackgroundMesh<2>::element_plex() const;
template const ElementPlex &BackgroundMesh<3>::element_plex() const;
template std::vector<long long> BackgroundMesh<2>::global_edges() const;
template std::vector<long long> BackgroundMesh<3>::global_edges() const;

}  // namespace talus
