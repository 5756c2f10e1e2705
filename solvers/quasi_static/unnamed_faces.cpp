#include "solvers/quasi_static/unnamed_faces.h"

#include <cmath>
#include <set>
#include <utility>

namespace talus {

template <int dim>
std::vector<Facet<dim>> unnamed_faces(const BackgroundMesh<dim> &mesh, const std::vector<char> &active,
                                      const std::vector<NamedBoundary> &sources) {
  const std::vector<char> active_across = mesh.across(active);
  const auto soil_across = [&](int neighbour) {
    if (neighbour == boundary) return false;
    return (neighbour >= 0 ? active[neighbour] : active_across[-2 - neighbour]) != 0;
  };
  std::set<std::pair<int, int>> named;
  for (const NamedBoundary &source : sources)
    for (const std::string &group : source.groups)
      if (source.kind.water != OnWater::surface && mesh.has_group(group))
        for (const Facet<dim> &f : mesh.facets(group)) named.emplace(f.cell, f.face);
  std::vector<Facet<dim>> faces;
  for (int c = 0; c < mesh.cell_count(); ++c)
    for (int k = 0; k <= dim && active[c]; ++k) {
      if (soil_across(mesh.cells[c].neighbour[k]) || named.count({c, k})) continue;
      Facet<dim> facet{c, k, {}, {}, 0};
      double square = 0;  // its area is that of the cell's gradient: |grad l_k| = area / (dim volume)
      for (int d = 0; d < dim; ++d) {
        double g = 0;
        for (int j = 0; j < dim; ++j)
          g += k == 0 ? -mesh.cells[c].gradient[j][d] : j == k - 1 ? mesh.cells[c].gradient[j][d] : 0;
        facet.normal[d] = -g, square += g * g;
      }
      facet.area = std::sqrt(square) * dim * mesh.volume[c];
      for (double &n : facet.normal) n /= std::sqrt(square);
      faces.push_back(facet);
    }
  return faces;
}

template std::vector<Facet<2>> unnamed_faces(const BackgroundMesh<2> &, const std::vector<char> &,
                                             const std::vector<NamedBoundary> &);
template std::vector<Facet<3>> unnamed_faces(const BackgroundMesh<3> &, const std::vector<char> &,
                                             const std::vector<NamedBoundary> &);

}  // namespace talus
