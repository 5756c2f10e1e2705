#include "physics/boundary/pore_conditions.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "base/room.h"
#include "physics/boundary/node_normals.h"

namespace talus {

template <int dim>
PetscErrorCode PoreConditions<dim>::setup(const BackgroundMesh<dim> &mesh, const std::vector<Source> &sources,
                                          bool sealed, int vertical) {
  PetscFunctionBeginUser;
  sources_ = &sources, sealed_ = sealed, vertical_ = vertical;
  std::set<std::pair<int, int>> open;  // facets with a face of the fluids
  std::vector<SourceFacets<dim>> walls;
  for (int s = 0; s < static_cast<int>(sources.size()); ++s) {
    if (std::ranges::count(sources[s].groups, std::string(free_surface))) rain_ = s;
    if (!sources[s].kind.fluid_face()) continue;
    groups_.emplace_back(s, std::vector<Facet<dim>>{});
    for (const std::string &group : sources[s].groups) {
      if (group == free_surface) continue;
      for (const Facet<dim> &f : mesh.facets(group)) groups_.back().second.push_back(f), open.emplace(f.cell, f.face);
    }
  }
  for (int s = 0; s < static_cast<int>(sources.size()); ++s) {
    if (sources[s].kind.water != OnWater::wall) continue;
    walls.push_back({s, {}});
    for (const std::string &group : sources[s].groups)
      for (const Facet<dim> &f : mesh.facets(group))
        if (!open.count({f.cell, f.face})) walls.back().facets.push_back(f);
  }
  std::vector<NodeNormal<dim>> normals;
  PetscCall(find_node_normals(mesh, walls, normals));
  std::stable_sort(normals.begin(), normals.end(), [](const auto &a, const auto &b) {
    return std::tie(a.source, a.normal, a.area) < std::tie(b.source, b.normal, b.area);
  });
  wall_of_node_.assign(mesh.node_count(), -1);
  for (const NodeNormal<dim> &n : normals) {
    int &index = wall_of_node_[n.node];
    if (index < 0) index = static_cast<int>(walls_.size()), walls_.emplace_back();
    walls_[index].add(n.normal, n.source);
  }
  for (auto *field : {&taken_, &taken_moment_}) make_room(*field, mesh.node_count());
  make_room(at_gap_, mesh.node_count()), make_room(face_of_node_, mesh.node_count());
  make_room(nodal_, mesh.node_count());
  active_walls_.reserve(walls_.size()), faces_.reserve(mesh.node_count()), gaps_.reserve(mesh.node_count()),
      gap_cells_.reserve((dim + 1) * mesh.cell_count());
  PetscFunctionReturn(0);
}

template <int dim>
void PoreConditions<dim>::add_face(int node, int source, const Vec<dim> &area, const Vec<dim> &moment) {
  double length = 0;
  for (double a : area) length += a * a;
  Face face{node, source, face_of_node_[node], area, area, moment};
  for (double &n : face.normal) n /= std::sqrt(length);
  face_of_node_[node] = static_cast<int>(faces_.size());
  faces_.push_back(face);
}

template <int dim>
PetscErrorCode PoreConditions<dim>::begin(FilledGrid<dim> &grid, const std::vector<double> &filling,
                                          const std::vector<Vec<dim>> &surface, const std::vector<Vec<dim>> &moment) {
  PetscFunctionBeginUser;
  const BackgroundMesh<dim> &mesh = grid.mesh();
  const int nodes = grid.node_count();
  active_walls_.clear(), faces_.clear();
  std::fill_n(face_of_node_.begin(), nodes, -1);
  for (auto *field : {&taken_, &taken_moment_}) std::fill_n(field->begin(), nodes, Vec<dim>{});
  for (int i = 0; i < nodes; ++i) {
    const int index = wall_of_node_[grid.mesh_node[i]];
    if (index >= 0) active_walls_.push_back({i, &walls_[index]});
  }
  const auto large = [&](int node, const Vec<dim> &area, double least) {
    double square = 0;
    for (double a : area) square += a * a;
    const double edge = mesh.mean_edge[grid.mesh_node[node]];
    return std::sqrt(square) > least * (dim == 2 ? edge : edge * edge);
  };
  for (const auto &[source, facets] : groups_) {
    std::fill_n(nodal_.begin(), nodes, std::array<Vec<dim>, 2>{});
    for (const Facet<dim> &f : facets) {
      const int cell = grid.find_cell(f.cell);
      if (cell < 0) continue;
      const double part = std::min(1., filling[cell]) * f.area / dim;
      for (int node : f.node) {
        double depth = 0;  // of the other nodes below this one
        for (int other : f.node) depth += mesh.position[node][vertical_] - mesh.position[other][vertical_];
        auto &[area, own_moment] = nodal_[grid.find_node(node)];
        for (int d = 0; d < dim; ++d)
          area[d] += part * f.normal[d], own_moment[d] += part / (dim + 1) * depth * f.normal[d];
      }
    }
    PetscCall(grid.sum(nodal_[0][0].data(), 2 * dim));
    for (int i = 0; i < nodes; ++i)
      if (large(i, nodal_[i][0], 1e-9)) {
        add_face(i, source, nodal_[i][0], nodal_[i][1]);
        for (int d = 0; d < dim; ++d) taken_[i][d] += nodal_[i][0][d], taken_moment_[i][d] += nodal_[i][1][d];
      }
  }
  gaps_.clear(), gap_cells_.clear();
  for (int i = 0; i < nodes; ++i) {
    const Vec<dim> rest = open_area(grid, i, surface[i]);
    // share of an edge or of its square: a smaller area is a gap between particles; nodes of a one-element slice have a
    // quarter of a square
    constexpr double least = dim == 2 ? 0.3 : 0.3 * 0.3, nothing = 1e-10;
    at_gap_[i] = 0;
    if (large(i, rest, least))
      add_face(i, rain_, rest, open_water() ? open_part(grid, i, moment[i], taken_moment_[i]) : Vec<dim>{});
    else if (large(i, rest, nothing))
      gaps_.push_back(i), at_gap_[i] = 1;
  }
  for (int c = 0; c < grid.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k)
      if (at_gap_[grid.shape[c].node[k]]) gap_cells_.push_back({grid.shape[c].node[k], c, k});
  PetscFunctionReturn(0);
}

/// An area vector (or its moment) at a node without the part of named faces and without its components along the
/// normals of walls.
template <int dim>
Vec<dim> PoreConditions<dim>::open_part(const FilledGrid<dim> &grid, int node, const Vec<dim> &whole,
                                        const Vec<dim> &taken) const {
  Vec<dim> rest = whole;
  for (int d = 0; d < dim; ++d) rest[d] -= taken[d];
  walls_at(grid, node, [&](const Vec<dim> &n) {
    double along = 0;
    for (int d = 0; d < dim; ++d) along += rest[d] * n[d];
    for (int d = 0; d < dim; ++d) rest[d] -= along * n[d];
  });
  return rest;
}

template class PoreConditions<2>;
template class PoreConditions<3>;

}  // namespace talus
