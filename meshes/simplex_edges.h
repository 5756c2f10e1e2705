#pragma once
/// Edges of a triangle or tetrahedron by its corners: 01, 02, (03,) 12, (13, 23).
#include <array>
#include <utility>

namespace talus {

/// Corners at the ends of each edge.
template <int dim>
inline constexpr auto simplex_edges = [] {
  std::array<std::pair<int, int>, dim *(dim + 1) / 2> edges{};
  int e = 0;
  for (int a = 0; a <= dim; ++a)
    for (int b = a + 1; b <= dim; ++b) edges[e++] = {a, b};
  return edges;
}();

}  // namespace talus
