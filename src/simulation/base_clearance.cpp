#include "simulation/base_clearance.h"

#include <algorithm>
#include <limits>

#include "meshes/locate.h"
#include "simulation/world.h"

namespace talus {
namespace {

/// A facet and the lowest particle over it.
struct Lowest {
  int cell, face, source;
  double area;
  double coordinate;  ///< the least barycentric coordinate of a particle that vanishes on the facet
};

template <int dim>
double altitude(const Cell<dim> &cell, int face) {
  ColumnVector<dim> gradient = ColumnVector<dim>::Zero();
  for (int k = 0; k < dim; ++k)
    if (face == 0 || face == k + 1) gradient += map<dim>(cell.gradient[k]);
  return 1 / gradient.norm();
}

}  // namespace

template <int dim>
std::vector<double> base_clearances(const World<dim> &world) {
  const auto &sources = world.conditions.sources();
  std::vector<double> sums(2 * sources.size(), 0), mean(sources.size(), 0);  // area times height, then area
  if (std::none_of(sources.begin(), sources.end(), [](const auto &s) { return s.kind.in_motion == OnSoil::contact; }))
    return mean;
  std::vector<Lowest> facets;
  for (const auto &[source, all] : world.conditions.bases().facets())
    for (const Facet<dim> &f : all)
      facets.push_back({f.cell, f.face, source, f.area, std::numeric_limits<double>::infinity()});
  std::stable_sort(facets.begin(), facets.end(), [](const Lowest &a, const Lowest &b) { return a.cell < b.cell; });
  const auto beside = [&](int cell) {
    return std::equal_range(facets.begin(), facets.end(), Lowest{cell, 0, 0, 0, 0},
                            [](const Lowest &a, const Lowest &b) { return a.cell < b.cell; });
  };
  for (const auto &body : world.bodies) {
    const ParticleArrays<dim> &p = body->particles();
    auto of_cell = beside(-1);
    for (int i = 0; i < p.count; ++i) {
      if (i == 0 || p.cell[i] != p.cell[i - 1]) of_cell = beside(p.cell[i]);
      if (of_cell.first == of_cell.second) continue;
      const auto n = barycentric(world.mesh.cells[p.cell[i]], p.position[i]);
      for (auto f = of_cell.first; f != of_cell.second; ++f) f->coordinate = std::min(f->coordinate, n[f->face]);
    }
  }
  for (const Lowest &f : facets) {
    if (f.coordinate == std::numeric_limits<double>::infinity()) continue;
    sums[f.source] += f.area * f.coordinate * altitude(world.mesh.cells[f.cell], f.face);
    sums[sources.size() + f.source] += f.area;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, world.comm);
  for (size_t s = 0; s < sources.size(); ++s)
    if (sums[sources.size() + s] > 0) mean[s] = sums[s] / sums[sources.size() + s];
  return mean;
}

template std::vector<double> base_clearances(const World<2> &);
template std::vector<double> base_clearances(const World<3> &);

}  // namespace talus
