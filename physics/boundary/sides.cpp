#include "physics/boundary/sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/local_numbers.h"

namespace talus {
namespace {

/// Nodes of two planes, and how they lie.
template <int dim>
struct TwoPlanes {
  std::vector<FaceNode<dim>> front, back;  ///< which look along the normal and against it
  Vec<dim> normal{};
  double near;  ///< two places that are one [m]
};

template <int dim>
TwoPlanes<dim> find_planes(const BackgroundMesh<dim> &mesh, const std::vector<Facet<dim>> &facets, std::string &fault) {
  constexpr double tolerance = 1e-3;  // of the smallest facet
  TwoPlanes<dim> planes;
  double smallest = std::numeric_limits<double>::max();
  for (const Facet<dim> &f : facets) smallest = std::min(smallest, std::pow(f.area, 1. / (dim - 1)));
  MPI_Allreduce(MPI_IN_PLACE, &smallest, 1, MPI_DOUBLE, MPI_MIN, mesh.comm());
  planes.near = tolerance * smallest;
  for (const FaceNode<dim> &node : nodes_of_planes<dim>(mesh, facets, planes.normal, fault))
    (node.side > 0 ? planes.front : planes.back).push_back(node);
  return planes;
}

template <int dim>
std::vector<Facet<dim>> facets_of(const BackgroundMesh<dim> &mesh, const std::vector<std::string> &groups) {
  std::vector<Facet<dim>> all;
  for (const std::string &group : groups) {
    const auto more = mesh.facets(group);
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

template <int dim>
std::vector<std::vector<long long>> pairs_of(const BackgroundMesh<dim> &mesh, const std::vector<std::string> &groups,
                                             std::string &fault) {
  const TwoPlanes<dim> planes = find_planes<dim>(mesh, facets_of<dim>(mesh, groups), fault);
  if (!fault.empty()) return {};
  if (planes.front.empty() || planes.back.empty()) {
    fault = "must have both of two opposite sides, and all of its facets look the same way";
    return {};
  }
  const bool fewer = planes.front.size() < planes.back.size();  // a node without a partner is one of the more
  return opposite_nodes<dim>(fewer ? planes.back : planes.front, fewer ? planes.front : planes.back, planes.normal,
                             planes.near, fault);
}

/// The groups of a boundary that are sides of the mesh and no faces of columns.
std::vector<std::string> sides_of(const NamedBoundary &source) {
  return {source.groups.begin(), source.groups.end() - static_cast<std::ptrdiff_t>(source.columns.size())};
}

}  // namespace

template <int dim>
Ties find_ties(const BackgroundMesh<dim> &mesh, const std::vector<NamedBoundary> &sources) {
  Ties ties;
  for (std::size_t s = 0; s < sources.size() && ties.fault.empty(); ++s) {
    std::vector<std::vector<std::string>> tied;  // groups of two opposite faces
    if (sources[s].kind.in_motion == OnSoil::tied) tied.push_back(sources[s].groups);
    for (const std::string &column : sources[s].columns) tied.push_back({column});
    for (const auto &groups : tied) {
      if (!ties.fault.empty()) break;
      const auto pairs = pairs_of<dim>(mesh, groups, ties.fault);
      ties.groups.insert(ties.groups.end(), pairs.begin(), pairs.end());
    }
    ties.source = static_cast<int>(s);
  }
  return ties;
}

template <int dim>
std::vector<SideColumn<dim>> find_columns(const BackgroundMesh<dim> &mesh, const std::vector<NamedBoundary> &sources) {
  std::vector<SideColumn<dim>> columns;
  const LocalNumbers local(mesh.global_node);
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const std::vector<std::string> sides = sides_of(sources[s]);
    for (std::size_t k = 0; k < sources[s].columns.size(); ++k) {
      std::string none;
      SideColumn<dim> column{static_cast<int>(s), {}, {}, {}, {}};
      const TwoPlanes<dim> side = find_planes<dim>(mesh, facets_of<dim>(mesh, {sides[k]}), none),
                           faces = find_planes<dim>(mesh, facets_of<dim>(mesh, {sources[s].columns[k]}), none);
      const bool along = dot<dim>(side.normal, faces.normal) > 0;
      const auto &towards = along ? faces.back : faces.front;  // the face of the column that looks at the side
      column.links = LinkedNodes(mesh.comm(), opposite_nodes<dim>(side.front, towards, side.normal, side.near, none),
                                 mesh.global_node, mesh.owned);
      for (const auto &[nodes, to] : {std::pair(&side.front, &column.beside), std::pair(&towards, &column.nodes)})
        for (const FaceNode<dim> &node : *nodes)
          if (const int i = local.find(node.number); i >= 0) to->push_back(i);
      for (const Facet<dim> &f : facets_of<dim>(mesh, {sources[s].columns[k]}))
        if (dot<dim>(f.normal, side.normal) < 0) column.facets.push_back(f);
      columns.push_back(std::move(column));
    }
  }
  return columns;
}

#define TALUS_SIDES(dim)                                                                    \
  template Ties find_ties(const BackgroundMesh<dim> &, const std::vector<NamedBoundary> &); \
  template std::vector<SideColumn<dim>> find_columns(const BackgroundMesh<dim> &, const std::vector<NamedBoundary> &);
TALUS_SIDES(2)
TALUS_SIDES(3)

}  // namespace talus
