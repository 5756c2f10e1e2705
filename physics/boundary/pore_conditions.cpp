#include "physics/boundary/pore_conditions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "base/room.h"

namespace talus {
namespace {

/// Behind tied sides ground goes on, and so does what flows in it.
bool stops_fluids(const Boundary &kind) { return kind.water == OnWater::wall && kind.in_motion != OnSoil::tied; }

/// Normal of two opposite sides, the same on all ranks. Collective.
template <int dim>
PetscErrorCode find_normal(const BackgroundMesh<dim> &mesh, const std::vector<std::string> &sides, Vec<dim> &normal) {
  PetscFunctionBeginUser;
  normal = {};
  for (const std::string &side : sides)
    for (const Facet<dim> &f : mesh.facets(side)) {
      const auto leading = std::ranges::max_element(f.normal, {}, [](double n) { return std::abs(n); });
      add_scaled<dim>(normal, *leading > 0 ? f.area : -f.area, f.normal);
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, normal.data(), dim, MPI_DOUBLE, MPI_SUM, mesh.comm()));
  const double length = std::sqrt(dot<dim>(normal, normal));
  for (double &n : normal) n /= length;
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode PoreConditions<dim>::setup(const BackgroundMesh<dim> &mesh, const std::vector<Source> &sources,
                                          bool sealed, int vertical, const Vec<dim> &upward) {
  PetscFunctionBeginUser;
  sources_ = &sources, sealed_ = sealed, vertical_ = vertical, upward_ = upward;
  for (const Source &source : sources)
    if (source.kind.in_motion == OnSoil::tied)
      PetscCall(find_normal<dim>(mesh, source.groups, through_.emplace_back()));
  std::set<std::pair<int, int>> open;  // facets with a face of the fluids
  std::vector<SourceFacets<dim>> walls, faces;
  for (int s = 0; s < static_cast<int>(sources.size()); ++s) {
    if (std::ranges::count(sources[s].groups, std::string(free_surface))) rain_ = s;
    if (!sources[s].kind.fluid_face()) continue;
    faces.push_back({s, {}});
    for (const std::string &group : sources[s].groups) {
      if (group == free_surface) continue;
      for (const Facet<dim> &f : mesh.facets(group)) faces.back().facets.push_back(f), open.emplace(f.cell, f.face);
    }
  }
  PetscCall(set_corners(mesh, faces));
  for (int s = 0; s < static_cast<int>(sources.size()); ++s) {
    if (!stops_fluids(sources[s].kind)) continue;
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
  size_t most_faces = mesh.node_count();
  for (const Corners &named : named_) most_faces += named.corners.size();
  walls_alone_.reserve(mesh.node_count()), faces_.reserve(most_faces), gaps_.reserve(mesh.node_count());
  gap_cells_.reserve((dim + 1) * mesh.cell_count());
  PetscFunctionReturn(0);
}

/// Facets of a boundary make one face at a node. Where it prescribes a flux, they make one for each of the boundary's
/// patches there, so that every side of an edge has its own. Collective.
template <int dim>
PetscErrorCode PoreConditions<dim>::set_corners(const BackgroundMesh<dim> &mesh,
                                                const std::vector<SourceFacets<dim>> &faces) {
  PetscFunctionBeginUser;
  std::vector<SourceFacets<dim>> pumps;
  for (const SourceFacets<dim> &face : faces)
    if (prescribes(face.source)) pumps.push_back(face);
  std::vector<NodeNormal<dim>> normals;
  if (!pumps.empty()) PetscCall(find_node_normals(mesh, pumps, normals));
  std::map<std::pair<int, int>, std::vector<Vec<dim>>> sides;  // of a source at a node
  std::vector<int> most(sources_->size(), 1);                  // sides at a node
  for (const NodeNormal<dim> &n : normals) {
    auto &at = sides[{n.source, n.node}];
    at.push_back(n.normal);
    most[n.source] = std::max(most[n.source], static_cast<int>(at.size()));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most.data(), static_cast<int>(most.size()), MPI_INT, MPI_MAX, mesh.comm()));
  for (const auto &[source, facets] : faces) {
    const size_t first = named_.size();
    named_.resize(first + most[source], {source, {}});
    for (const Facet<dim> &f : facets)
      for (const int node : f.node) {
        int side = 0;
        if (const auto found = sides.find({source, node}); found != sides.end())
          for (int k = 1; k < static_cast<int>(found->second.size()); ++k)
            if (dot<dim>(f.normal, found->second[k]) > dot<dim>(f.normal, found->second[side])) side = k;
        double depth = 0;
        for (int other : f.node) depth += mesh.position[node][vertical_] - mesh.position[other][vertical_];
        named_[first + side].corners.push_back({f.cell, node, f.normal, f.area, depth});
      }
  }
  PetscFunctionReturn(0);
}

template <int dim>
void PoreConditions<dim>::add_face(int node, int source, const NamedFace &named) {
  Face face{node, source, face_of_node_[node], named.area, named.area, named.moment};
  face.length = std::sqrt(dot<dim>(named.area, named.area));
  for (double &n : face.normal) n /= face.length;
  if (named.facets > 0) face.spread = named.facets / face.length;
  face_of_node_[node] = static_cast<int>(faces_.size());
  faces_.push_back(face);
}

/// Finds which faces of a node lie in one plane, and the directions in which fluxes are prescribed there. `surface` as
/// for `begin`.
template <int dim>
void PoreConditions<dim>::relate_faces(const FilledGrid<dim> &grid, const std::vector<Vec<dim>> &surface) {
  for (Face &f : faces_) {
    for (int before = f.further; before >= 0; before = faces_[before].further)
      if (same_side(f.normal, faces_[before].normal))
        f.leads = faces_[before].leads >= 0 ? faces_[before].leads : before;
    if (f.leads < 0) continue;
    Face &leader = faces_[f.leads];
    f.next = leader.next, leader.next = static_cast<int>(&f - faces_.data());
  }
  for (Face &f : faces_) {
    if (f.leads >= 0) continue;
    bool pumps = false;
    each_in_plane(f, [&](const Face &g) { pumps |= prescribes(g.source); });
    if (!pumps) continue;
    PrescribedDirections<dim> known;
    walls_at(grid, f.node, [&](const Vec<dim> &n) {
      if (in_plane_of_wall(f.normal, n)) {
        f.wall = std::max(0., dot<dim>(surface[f.node], f.normal) - dot<dim>(taken_[f.node], f.normal));
      } else {
        known.direction[known.count++] = n;
      }
    });
    for (int before = f.further; before >= 0; before = faces_[before].further)
      if (faces_[before].across > 0) known.add(faces_[before].direction, faces_[before].source);
    const int before = known.count;
    known.add(f.normal, f.source);
    if (known.count == before) continue;
    f.direction = known.direction[before];
    f.across = dot<dim>(f.normal, f.direction);
  }
}

template <int dim>
PetscErrorCode PoreConditions<dim>::begin(FilledGrid<dim> &grid, const std::vector<double> &filling,
                                          const std::vector<Vec<dim>> &surface, const std::vector<Vec<dim>> &moment) {
  PetscFunctionBeginUser;
  const BackgroundMesh<dim> &mesh = grid.mesh();
  const int nodes = grid.node_count();
  walls_alone_.clear(), faces_.clear();
  std::fill_n(face_of_node_.begin(), nodes, -1);
  for (auto *field : {&taken_, &taken_moment_}) std::fill_n(field->begin(), nodes, Vec<dim>{});
  const auto large = [&](int node, const Vec<dim> &area, double least) {
    double square = 0;
    for (double a : area) square += a * a;
    const double edge = mesh.mean_edge[grid.mesh_node[node]];
    return std::sqrt(square) > least * (dim == 2 ? edge : edge * edge);
  };
  for (const auto &[source, corners] : named_) {
    std::fill_n(nodal_.begin(), nodes, NamedFace{});
    for (const Corner &corner : corners) {
      const int cell = grid.find_cell(corner.cell);
      if (cell < 0) continue;
      const double part = std::min(1., filling[cell]) * corner.area / dim;
      NamedFace &face = nodal_[grid.find_node(corner.node)];
      for (int d = 0; d < dim; ++d) {
        face.area[d] += part * corner.normal[d];
        face.moment[d] += part / (dim + 1) * corner.depth * corner.normal[d];
      }
      face.facets += part;
    }
    PetscCall(grid.sum(nodal_[0].area.data(), 2 * dim + 1));
    for (int i = 0; i < nodes; ++i) {
      const NamedFace &face = nodal_[i];
      if (!large(i, face.area, 1e-9)) continue;
      add_face(i, source, face);
      for (int d = 0; d < dim; ++d) taken_[i][d] += face.area[d], taken_moment_[i][d] += face.moment[d];
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
      add_face(i, rain_, {rest, open_water() ? open_part(grid, i, moment[i], taken_moment_[i]) : Vec<dim>{}, 0});
    else if (large(i, rest, nothing))
      gaps_.push_back(i), at_gap_[i] = 1;
  }
  relate_faces(grid, surface);
  for (int i = 0; i < nodes; ++i)
    if (wall_of_node_[grid.mesh_node[i]] >= 0 && face_of_node_[i] < 0) walls_alone_.push_back(i);
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
