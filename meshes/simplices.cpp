#include "meshes/simplices.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>

#include "meshes/gmsh_file.h"
#include "meshes/simplex.h"

namespace talus {
namespace {

/// Sides of cells by their nodes: those whose lowest node is the same stand together.
template <int dim>
class Sides {
 public:
  using Nodes = std::array<int, dim>;  ///< ascending

  explicit Sides(const Simplices<dim> &cells) : cells_(cells), first_(cells.position.size() + 1, 0) {
    const int count = static_cast<int>(cells.node.size());
    const auto each = [&](const auto &visit) {
      for (int c = 0; c < count; ++c)
        for (int k = 0; k <= dim; ++k) visit(lowest(c, k), static_cast<std::uint32_t>(c) * (dim + 1) + k);
    };
    each([&](int node, std::uint32_t) { ++first_[node + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    side_.resize(first_.back());
    std::vector<std::uint32_t> end(first_.begin(), first_.end() - 1);
    each([&](int node, std::uint32_t side) { side_[end[node]++] = side; });
  }

  Nodes nodes(Side side) const {
    Nodes nodes;
    for (int k = 0, i = 0; k <= dim; ++k)
      if (k != side.face) nodes[i++] = cells_.node[side.cell][k];
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  }
  /// Calls `visit` with the sides of each facet, all with the same nodes, ascending.
  template <class Visit>
  void of_facets(const Visit &visit) const {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> here;  // nodes above the lowest one, and the number of a side
    std::vector<Side> same;
    for (std::size_t node = 0; node + 1 < first_.size(); ++node) {
      here.clear();
      for (std::uint32_t s = first_[node]; s < first_[node + 1]; ++s) {
        std::uint64_t others = 0;
        for (const int one : nodes(side(side_[s]))) others = others << 32 | static_cast<std::uint32_t>(one);
        here.emplace_back(others, side_[s]);  // the lowest node is shifted out
      }
      std::sort(here.begin(), here.end());
      for (std::size_t begin = 0, end; begin < here.size(); begin = end) {
        same.clear();
        for (end = begin; end < here.size() && here[end].first == here[begin].first; ++end)
          same.push_back(side(here[end].second));
        visit(same);
      }
    }
  }
  /// Calls `visit` with each side that has these nodes.
  template <class Visit>
  void with(const Nodes &wanted, const Visit &visit) const {
    for (std::uint32_t s = first_[wanted[0]]; s < first_[wanted[0] + 1]; ++s)
      if (nodes(side(side_[s])) == wanted) visit(side(side_[s]));
  }

 private:
  static Side side(std::uint32_t number) {
    return {static_cast<int>(number / (dim + 1)), static_cast<int>(number % (dim + 1))};
  }
  int lowest(int cell, int face) const {
    const auto &node = cells_.node[cell];
    int lowest = node[face == 0];
    for (int k = 0; k <= dim; ++k)
      if (k != face) lowest = std::min(lowest, node[k]);
    return lowest;
  }

  const Simplices<dim> &cells_;
  std::vector<std::uint32_t> first_, side_;  // of each node; a number is cell * (dim + 1) + face
};

/// The sides of the facets of each named group; a complaint about a facet that no cell has.
template <int dim>
void find_groups(const GmshMesh &source, const Sides<dim> &sides, Groups &groups, std::string &complaint) {
  std::map<std::string, std::vector<Side>> found;
  for (const auto &[name, facets] : source.groups) {
    if (facets.empty()) continue;
    std::vector<Side> &group = found[name];
    for (const int f : facets) {
      std::array<int, dim> nodes;
      std::copy_n(&source.facets[static_cast<std::size_t>(dim) * f], dim, nodes.begin());
      std::sort(nodes.begin(), nodes.end());
      const std::size_t before = group.size();
      if (nodes[0] >= 0) sides.with(nodes, [&](Side side) { group.push_back(side); });
      if (group.size() > before) continue;
      complaint = "element " + std::to_string(source.facet_number[f]) + " of the group '" + name +
                  "' is not the side of a cell; remesh, so that cells end at the group";
      return;
    }
  }
  for (auto &[name, group] : found) {
    std::sort(group.begin(), group.end());
    group.erase(std::unique(group.begin(), group.end()), group.end());
    groups.emplace_back(name, std::move(group));
  }
}

}  // namespace

Regions combine(int cell_count, std::vector<std::pair<std::string, std::vector<int>>> cells_of) {
  std::stable_sort(cells_of.begin(), cells_of.end(), [](const auto &a, const auto &b) { return a.first < b.first; });
  std::vector<int> combination(cell_count, 0);
  std::vector<std::vector<std::string>> names(1);
  std::map<std::pair<int, std::string>, int> with;  // a combination and one region more
  for (const auto &[name, cells] : cells_of)
    for (const int c : cells) {
      const int from = combination[c];
      if (!names[from].empty() && names[from].back() == name) continue;
      const auto [at, is_new] = with.try_emplace({from, name}, static_cast<int>(names.size()));
      if (is_new) {
        names.push_back(names[from]);
        names.back().push_back(name);
      }
      combination[c] = at->second;
    }
  Regions regions;  // numbered by first appearance
  std::vector<int> number(names.size(), -1);
  for (int &one : combination) {
    if (number[one] < 0) {
      number[one] = static_cast<int>(regions.names.size());
      regions.names.push_back(names[one]);
    }
    one = number[one];
  }
  regions.combination = std::move(combination);
  return regions;
}

template <int dim>
void read_mesh(const GmshMesh &source, Simplices<dim> &cells, Groups &groups, std::string &complaint) {
  if (source.cells.size() > std::numeric_limits<std::uint32_t>::max()) {
    complaint = "has more than " + std::to_string(std::numeric_limits<std::uint32_t>::max() / (dim + 1)) +
                " cells, the most that can be read; take larger cells away from the soil";
    return;
  }
  cells.position.resize(source.position.size() / dim);
  for (std::size_t i = 0; i < cells.position.size(); ++i)
    std::copy_n(&source.position[i * dim], dim, cells.position[i].begin());
  const int count = static_cast<int>(source.cells.size() / (dim + 1));
  cells.node.resize(count);
  for (int c = 0; c < count; ++c) {
    auto &node = cells.node[c];
    std::copy_n(&source.cells[static_cast<std::size_t>(c) * (dim + 1)], dim + 1, node.begin());
    if (dim == 3) std::swap(node[0], node[1]);
    if (Simplex<dim>(cells.corners(c)).volume < 0) std::swap(node[dim - 1], node[dim]);
  }
  const Sides<dim> sides(cells);
  std::array<int, dim + 1> none;
  none.fill(-1);
  cells.neighbour.assign(count, none);
  sides.of_facets([&](const std::vector<Side> &same) {
    if (same.size() > 2) cells.crowded = std::max(cells.crowded, same.back().cell);
    if (same.size() < 2) return;
    for (const Side &side : same) cells.neighbour[side.cell][side.face] = same[side.cell == same[0].cell].cell;
  });
  find_groups(source, sides, groups, complaint);
}

template <int dim>
std::vector<double> mean_edges(const Simplices<dim> &cells, const GmshMesh &source) {
  // other corners of a cell, by corner; in the order of DMPlex, in which the lengths have always been added up
  constexpr int others[2][4][3] = {{{1, 2}, {0, 2}, {1, 0}}, {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {1, 0, 2}}};
  const std::size_t nodes = cells.position.size();
  std::vector<std::uint32_t> first(nodes + 1, 0), corner(source.cells.size());  // of each node: corners of cells
  for (const int node : source.cells) ++first[node + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> end(first.begin(), first.end() - 1);
  for (std::size_t k = 0; k < source.cells.size(); ++k) corner[end[source.cells[k]]++] = static_cast<std::uint32_t>(k);
  std::vector<double> mean(nodes);
  std::vector<int> met_by(nodes, -1);  // the last node from which an edge led here
  for (int i = 0; i < static_cast<int>(nodes); ++i) {
    double sum = 0;
    int number = 0;
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      const std::uint32_t own = corner[k] % (dim + 1), cell = corner[k] - own;
      for (int side = 0; side < dim; ++side) {
        const int other = source.cells[cell + others[dim - 2][own][side]];
        if (met_by[other] == i) continue;
        met_by[other] = i;
        sum += (map<dim>(cells.position[i]) - map<dim>(cells.position[other])).norm(), ++number;
      }
    }
    mean[i] = sum / number;
  }
  return mean;
}

template void read_mesh(const GmshMesh &, Simplices<2> &, Groups &, std::string &);
template void read_mesh(const GmshMesh &, Simplices<3> &, Groups &, std::string &);
template std::vector<double> mean_edges(const Simplices<2> &, const GmshMesh &);
template std::vector<double> mean_edges(const Simplices<3> &, const GmshMesh &);

}  // namespace talus
