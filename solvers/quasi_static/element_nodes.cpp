#include "solvers/quasi_static/element_nodes.h"

#include <petscsf.h>

#include <algorithm>
#include <map>

namespace talus {
namespace {

using Section = Owned<PetscSection, PetscSectionDestroy>;

/// Makes `value` [points of the chart] the largest of all ranks that hold the point.
PetscErrorCode share_maximum(DM plex, std::vector<PetscInt> &value) {
  PetscSF sf;
  PetscInt roots;
  PetscFunctionBeginUser;
  PetscCall(DMGetPointSF(plex, &sf));
  PetscCall(PetscSFGetGraph(sf, &roots, nullptr, nullptr, nullptr));
  if (roots < 0) PetscFunctionReturn(0);
  std::vector<PetscInt> root = value;
  PetscCall(PetscSFReduceBegin(sf, MPIU_INT, value.data(), root.data(), MPI_MAX));
  PetscCall(PetscSFReduceEnd(sf, MPIU_INT, value.data(), root.data(), MPI_MAX));
  value = root;
  PetscCall(PetscSFBcastBegin(sf, MPIU_INT, root.data(), value.data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_INT, root.data(), value.data(), MPI_REPLACE));
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode ElementNodes<dim>::setup(const BackgroundMesh<dim> &mesh, int order, const std::vector<char> &active,
                                        int components) {
  PetscInt begin, end, first_edge, end_edge;
  const PetscInt *ends;
  PetscFunctionBeginUser;
  order_ = order, per_cell_ = element_nodes<dim>(order), components_ = components;
  const ElementPlex &plex = mesh.element_plex();
  PetscCall(DMClone(plex.dm, dm_.create()));
  PetscCall(DMPlexGetChart(dm_, &begin, &end));
  PetscCall(DMPlexGetDepthStratum(dm_, 1, &first_edge, &end_edge));

  std::map<PetscInt, int> vertex;  // of the plex -> of the mesh
  for (int i = 0; i < mesh.node_count(); ++i)
    if (plex.vertex[i] >= 0) vertex[plex.vertex[i]] = i;
  std::map<std::pair<int, int>, PetscInt> edge;  // by the vertices at its ends
  if (order == 2)
    for (PetscInt e = first_edge; e < end_edge; ++e) {
      PetscCall(DMPlexGetCone(dm_, e, &ends));
      const auto a = vertex.find(ends[0]), b = vertex.find(ends[1]);
      if (a != vertex.end() && b != vertex.end()) edge[std::minmax(a->second, b->second)] = e;
    }
  const auto edge_between = [&](int a, int b) { return edge.at(std::minmax(a, b)); };

  std::vector<PetscInt> has_node(end, 0);
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (!active[c]) continue;
    const auto &node = mesh.cells[c].node;
    for (int i : node) has_node[plex.vertex[i]] = 1;
    if (order == 2)
      for (const auto &[a, b] : simplex_edges<dim>) has_node[edge_between(node[a], node[b])] = 1;
  }
  PetscCall(share_maximum(dm_, has_node));

  Section section;
  PetscCall(PetscSectionCreate(PetscObjectComm(reinterpret_cast<PetscObject>(static_cast<DM>(dm_))), section.create()));
  PetscCall(PetscSectionSetChart(section, begin, end));
  for (PetscInt p = begin; p < end; ++p)
    if (has_node[p]) PetscCall(PetscSectionSetDof(section, p, components));
  PetscCall(PetscSectionSetUp(section));
  PetscCall(DMSetLocalSection(dm_, section));
  PetscSection numbering;
  PetscCall(DMGetGlobalSection(dm_, &numbering));

  position.clear(), owned.clear(), point.clear(), number.clear(), global_.clear();
  std::vector<int> node_of(end, -1);
  for (PetscInt p = begin; p < end; ++p) {
    if (!has_node[p]) continue;
    PetscInt row;
    PetscCall(PetscSectionGetOffset(numbering, p, &row));
    node_of[p] = count();
    owned.push_back(row >= 0), point.push_back(p), number.push_back(plex.number[p]);
    global_.push_back((row >= 0 ? row : -row - 1) / components);
    position.push_back({});
    const auto found = vertex.find(p);
    if (found != vertex.end()) {
      position.back() = mesh.position[found->second];
    } else {
      PetscCall(DMPlexGetCone(dm_, p, &ends));
      for (int d = 0; d < dim; ++d)
        position.back()[d] = (mesh.position[vertex.at(ends[0])][d] + mesh.position[vertex.at(ends[1])][d]) / 2;
    }
  }
  vertex_node_.assign(mesh.node_count(), -1);
  for (int i = 0; i < mesh.node_count(); ++i)
    if (plex.vertex[i] >= 0) vertex_node_[i] = node_of[plex.vertex[i]];
  cell_node_.assign(static_cast<size_t>(mesh.cell_count()) * per_cell_, -1);
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (!active[c]) continue;
    const auto &node = mesh.cells[c].node;
    int *mine = &cell_node_[static_cast<size_t>(c) * per_cell_];
    for (int a = 0; a <= dim; ++a) mine[a] = vertex_node_[node[a]];
    if (order == 2)
      for (size_t e = 0; e < simplex_edges<dim>.size(); ++e)
        mine[dim + 1 + e] =
            node_of[edge_between(node[simplex_edges<dim>[e].first], node[simplex_edges<dim>[e].second])];
  }
  PetscCall(DMCreateLocalVector(dm_, local_.create()));
  PetscCall(DMCreateGlobalVector(dm_, scratch_.create()));
  PetscFunctionReturn(0);
}

template <int dim>
std::vector<int> ElementNodes<dim>::of_facet(int cell, int face) const {
  const int *node = of_cell(cell);
  std::vector<int> facet;
  for (int a = 0; a <= dim; ++a)
    if (a != face) facet.push_back(node[a]);
  if (order_ == 2)
    for (size_t e = 0; e < simplex_edges<dim>.size(); ++e)
      if (simplex_edges<dim>[e].first != face && simplex_edges<dim>[e].second != face)
        facet.push_back(node[dim + 1 + e]);
  return facet;
}

template <int dim>
PetscErrorCode ElementNodes<dim>::global_vector(Vector &v) const {
  PetscFunctionBeginUser;
  PetscCall(DMCreateGlobalVector(dm_, v.create()));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ElementNodes<dim>::to_local(::Vec global, std::vector<double> &local) const {
  const double *value;
  PetscFunctionBeginUser;
  PetscCall(DMGlobalToLocal(dm_, global, INSERT_VALUES, local_));
  PetscCall(VecGetArrayRead(local_, &value));
  local.assign(value, value + static_cast<size_t>(count()) * components_);
  PetscCall(VecRestoreArrayRead(local_, &value));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ElementNodes<dim>::add_to_global(const std::vector<double> &local, ::Vec global) const {
  double *value;
  PetscFunctionBeginUser;
  PetscCall(VecGetArrayWrite(local_, &value));
  std::copy(local.begin(), local.end(), value);
  PetscCall(VecRestoreArrayWrite(local_, &value));
  PetscCall(VecZeroEntries(global));
  PetscCall(DMLocalToGlobal(dm_, local_, ADD_VALUES, global));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ElementNodes<dim>::sum(std::vector<double> &local) const {
  PetscFunctionBeginUser;
  PetscCall(add_to_global(local, scratch_));
  PetscCall(to_local(scratch_, local));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ElementNodes<dim>::maximum(std::vector<PetscInt> &local) const {
  PetscInt begin, end;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetChart(dm_, &begin, &end));
  std::vector<PetscInt> value(end, PETSC_MIN_INT);
  for (int i = 0; i < count(); ++i) value[point[i]] = local[i];
  PetscCall(share_maximum(dm_, value));
  for (int i = 0; i < count(); ++i) local[i] = value[point[i]];
  PetscFunctionReturn(0);
}

template class ElementNodes<2>;
template class ElementNodes<3>;

}  // namespace talus
