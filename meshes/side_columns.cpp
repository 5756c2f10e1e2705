#include "meshes/side_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "base/vec.h"

namespace talus {
namespace {

/// `size` nodes that stand at place `k`, ascending.
template <int size>
std::array<int, size> sorted_nodes(const std::vector<int> &nodes, std::size_t k) {
  std::array<int, size> some;
  std::copy_n(&nodes[k * size], size, some.begin());
  std::sort(some.begin(), some.end());
  return some;
}

template <int dim>
Vec<dim> place(const GmshMesh &mesh, int node) {
  Vec<dim> x;
  std::copy_n(&mesh.position[static_cast<std::size_t>(node) * dim], dim, x.begin());
  return x;
}

/// Normal of a facet, as long as it is large: length in 2D, twice the area in 3D.
template <int dim>
ColumnVector<dim> area_normal(const GmshMesh &mesh, const std::array<int, dim> &facet) {
  const Vec<dim> a = place<dim>(mesh, facet[0]), b = place<dim>(mesh, facet[1]);
  const ColumnVector<dim> along = map<dim>(b) - map<dim>(a);
  if constexpr (dim == 2) {
    return {along[1], -along[0]};
  } else {
    const Vec<dim> c = place<dim>(mesh, facet[2]);
    return along.cross(ColumnVector<dim>(map<dim>(c) - map<dim>(a)));
  }
}

}  // namespace

template <int dim>
std::string add_column_beside(GmshMesh &mesh, const std::string &side) {
  using Facet = std::array<int, dim>;
  std::map<Facet, int> behind;  // cell of a facet of the side
  for (const auto &[name, facets] : mesh.groups)
    if (name == side)
      for (const int f : facets) behind.emplace(sorted_nodes<dim>(mesh.facets, f), -1);
  if (behind.empty()) return "";
  const auto fault = [&](const std::string &text) {
    return "group '" + side + "' has kind = \"free_field\", and " + text;
  };

  const std::size_t cells = mesh.cells.size() / (dim + 1);
  for (std::size_t c = 0; c < cells; ++c) {
    const auto nodes = sorted_nodes<dim + 1>(mesh.cells, c);
    for (int k = 0; k <= dim; ++k) {
      Facet facet;
      for (int j = 0, i = 0; j <= dim; ++j)
        if (j != k) facet[i++] = nodes[j];
      const auto found = behind.find(facet);
      if (found == behind.end()) continue;
      if (found->second >= 0) return fault("lies inside the mesh: name a side of it");
      found->second = static_cast<int>(c);
    }
  }

  ColumnVector<dim> normal = ColumnVector<dim>::Zero();
  double thickness = 0;
  for (const auto &[facet, cell] : behind) {
    if (cell < 0) return fault("has a facet that is not the side of a cell");
    ColumnVector<dim> n = area_normal<dim>(mesh, facet);
    ColumnVector<dim> inward = ColumnVector<dim>::Zero();
    const auto nodes = sorted_nodes<dim + 1>(mesh.cells, cell);
    for (const int node : nodes) inward += map<dim>(place<dim>(mesh, node)) - map<dim>(place<dim>(mesh, facet[0]));
    if (n.dot(inward) > 0) n = -n;
    thickness += std::pow(n.norm(), 1. / (dim - 1)) / static_cast<double>(behind.size());
    if (normal.isZero()) normal = n.normalized();
    if (normal.dot(n.normalized()) < 1 - 1e-9)
      return fault("is no plane: give each side of the mesh a group of its own, and an upright plane");
  }

  std::map<int, std::array<int, 2>> moved;  // node of the side -> nodes of the column, near and far
  for (const auto &[facet, cell] : behind)
    for (const int node : facet) moved.try_emplace(node);
  for (const int far : {0, 1})
    for (auto &[node, to] : moved) {
      to[far] = static_cast<int>(mesh.position.size() / dim);
      const Vec<dim> x = place<dim>(mesh, node);
      for (int d = 0; d < dim; ++d) mesh.position.push_back(x[d] + (1 + far) * thickness * normal[d]);
    }
  // of the prism over a facet or edge: each simplex has the first nodes on the near side and the last on the far one
  const auto add_prism = [&](const auto &nodes, std::vector<int> &to) {
    const std::size_t count = nodes.size();
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i <= k; ++i) to.push_back(moved.at(nodes[i])[0]);
      for (std::size_t i = k; i < count; ++i) to.push_back(moved.at(nodes[i])[1]);
    }
  };

  std::map<int, std::vector<int>> beside;  // cell behind the side -> cells of the column
  for (const auto &[facet, cell] : behind)
    for (int k = 0; k < dim; ++k) {
      if (k == 0) add_prism(facet, mesh.cells);
      beside[cell].push_back(static_cast<int>(mesh.cells.size() / (dim + 1)) - dim + k);
    }
  for (auto &[name, of_region] : mesh.regions) {
    std::vector<int> more;
    for (const int c : of_region)
      if (const auto found = beside.find(c); found != beside.end())
        more.insert(more.end(), found->second.begin(), found->second.end());
    of_region.insert(of_region.end(), more.begin(), more.end());
  }

  const auto last_facet = [&] { return static_cast<int>(mesh.facets.size() / dim) - 1; };
  for (auto &[name, facets] : mesh.groups) {
    std::set<std::array<int, dim - 1>> edges;  // at which facets of the group meet the side
    for (const int f : facets) {
      std::array<int, dim - 1> edge;
      int count = 0;
      for (const int node : sorted_nodes<dim>(mesh.facets, f))
        if (moved.count(node) && count++ < dim - 1) edge[count - 1] = node;
      if (count == dim - 1) edges.insert(edge);
    }
    for (const auto &edge : edges) {
      const int before = last_facet();
      add_prism(edge, mesh.facets);
      for (int f = before + 1; f <= last_facet(); ++f) facets.push_back(f);
    }
  }
  std::vector<int> faces;
  for (const auto &[facet, cell] : behind)
    for (const int far : {0, 1}) {
      for (const int node : facet) mesh.facets.push_back(moved.at(node)[far]);
      faces.push_back(last_facet());
    }
  mesh.groups.emplace_back(column_of(side), std::move(faces));
  mesh.facet_number.resize(mesh.facets.size() / dim, 0);
  return "";
}

template std::string add_column_beside<2>(GmshMesh &, const std::string &);
template std::string add_column_beside<3>(GmshMesh &, const std::string &);

}  // namespace talus
