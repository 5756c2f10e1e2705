#pragma once
/// Writes Gmsh files without Gmsh: a box cut into triangles or tetrahedra, whose regions are given by the centres of
/// cells, so that the surfaces of bodies are rough by a part of a cell.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace talus::test {

using Place = std::array<double, 3>;
struct Region {
  std::string name;
  std::function<bool(const Place &)> has;
};

/// The box from `low` to `high` in cells of `size` [m]; inner nodes are shifted by up to `jitter` sizes. Cells in no
/// region are air. Facets: left, right (x), front, back (y in 3D), base, top.
inline void write_contact_mesh(const std::string &file, int dim, const Place &low, const Place &high, double size,
                               double jitter, const std::vector<Region> &regions) {
  std::uint64_t state = 1;
  const auto random = [&state] {  // in [-1, 1], the same everywhere
    state = state * 6364136223846793005u + 1442695040888963407u;
    return 2 * static_cast<double>(state >> 33) / 2147483648. - 1;
  };
  std::array<int, 3> count{1, 1, 0};
  for (int d = 0; d < dim; ++d) count[d] = static_cast<int>(std::lround((high[d] - low[d]) / size));
  const auto number = [&](int i, int j, int k) { return (k * (count[1] + 1) + j) * (count[0] + 1) + i; };
  std::vector<Place> node;
  for (int k = 0; k <= count[2]; ++k)
    for (int j = 0; j <= count[1]; ++j)
      for (int i = 0; i <= count[0]; ++i) {
        const std::array<int, 3> at{i, j, k};
        Place x{};
        for (int d = 0; d < dim; ++d) x[d] = low[d] + at[d] * (high[d] - low[d]) / count[d];
        for (int d = 0; d < dim; ++d) {
          const double shift = jitter * size * random();
          if (at[d] > 0 && at[d] < count[d]) x[d] += shift;
        }
        node.push_back(x);
      }
  std::vector<std::vector<int>> cells;
  for (int k = 0; k < std::max(1, count[2]); ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        const int a = number(i, j, k), b = number(i + 1, j, k), c = number(i + 1, j + 1, k), d = number(i, j + 1, k);
        if (dim == 2) {
          const bool rising = random() > 0;
          cells.push_back(rising ? std::vector<int>{a, b, c} : std::vector<int>{a, b, d});
          cells.push_back(rising ? std::vector<int>{a, c, d} : std::vector<int>{b, c, d});
          continue;
        }
        std::array<int, 3> way{0, 1, 2};
        do {
          std::array<int, 3> at{i, j, k};
          std::vector<int> cell{a};
          for (const int axis : way) ++at[axis], cell.push_back(number(at[0], at[1], at[2]));
          if ((way[1] - way[0] + 3) % 3 == 2) std::swap(cell[2], cell[3]);  // an odd permutation
          cells.push_back(cell);
        } while (std::next_permutation(way.begin(), way.end()));
      }
  std::vector<std::string> elements;
  const auto add = [&](int type, int tag, const std::vector<int> &nodes) {
    std::string line = " " + std::to_string(type) + " 2 " + std::to_string(tag) + " " + std::to_string(tag);
    for (const int i : nodes) line += " " + std::to_string(i + 1);
    elements.push_back(line);
  };
  for (const auto &cell : cells)
    for (int k = 0; k <= dim; ++k) {
      std::vector<int> facet = cell;
      facet.erase(facet.begin() + k);
      for (int d = 0; d < dim; ++d)
        for (const auto &[side, x] : {std::pair{0, low[d]}, {1, high[d]}})
          if (std::ranges::all_of(facet, [&](int i) { return std::abs(node[i][d] - x) < 1e-9; }))
            add(dim == 2 ? 1 : 2, 11 + 2 * (dim == 2 && d == 1 ? 2 : d) + side, facet);
    }
  for (const auto &cell : cells) {
    Place centre{};
    for (const int i : cell)
      for (int d = 0; d < dim; ++d) centre[d] += node[i][d] / (dim + 1);
    const auto region = std::ranges::find_if(regions, [&](const Region &one) { return one.has(centre); });
    add(dim == 2 ? 2 : 4, static_cast<int>(region - regions.begin()) + 1, cell);
  }
  std::ofstream out(file);
  out.precision(16);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n" << regions.size() + 1 + 2 * dim << "\n";
  const std::vector<std::string> sides{"left", "right", "front", "back", "base", "top"};
  for (int side = 0; side < 6; ++side)
    if (dim == 3 || side / 2 != 1) out << dim - 1 << " " << 11 + side << " \"" << sides[side] << "\"\n";
  for (size_t k = 0; k <= regions.size(); ++k)
    out << dim << " " << k + 1 << " \"" << (k < regions.size() ? regions[k].name : "air") << "\"\n";
  out << "$EndPhysicalNames\n$Nodes\n" << node.size() << "\n";
  for (size_t i = 0; i < node.size(); ++i)
    out << i + 1 << " " << node[i][0] << " " << node[i][1] << " " << node[i][2] << "\n";
  out << "$EndNodes\n$Elements\n" << elements.size() << "\n";
  for (size_t k = 0; k < elements.size(); ++k) out << k + 1 << elements[k] << "\n";
  out << "$EndElements\n";
}

}  // namespace talus::test
