#include "solvers/quasi_static/slip_surface.h"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

/// Difference of the extreme principal strains in the plane of the section.
double shearing_of(const std::array<double, stress_size<2>> &strain) {
  return std::hypot(strain[0] - strain[1], 2 * strain[3]);
}

/// Calls visit(points of a body, place among them) for the Gauss points of the bodies that are there.
template <int dim, class Visit>
void each_point(const SoilElements<dim> &soil, const Visit &visit) {
  for (const GaussPoints<dim> &p : soil.points())
    for (int q = 0; p.present && q < p.count(); ++q) visit(p, q);
}

template <int dim>
double displacement_of(const SoilElements<dim> &soil, const GaussPoints<dim> &p, int q) {
  const int cell = p.cell[q], place = q - soil.first_point(cell);
  const Vec<dim> u = soil.displacement(cell, soil.rule().point[place]);
  return map<dim>(u).norm();
}

/// Over all ranks, in place.
void reduce(MPI_Comm comm, std::vector<double> &values, MPI_Op operation) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, operation, comm);
}

std::vector<std::array<double, 2>> slip_surface(const SoilElements<2> &soil, double moving) {
  const MPI_Comm comm = soil.nodes().comm();
  std::vector<double> ends{-1e300, -1e300}, sums{0, 0};  // -low, high along x; volume and number of cells
  each_point(soil, [&](const GaussPoints<2> &p, int q) {
    ends[0] = std::max(ends[0], -p.position[q][0]), ends[1] = std::max(ends[1], p.position[q][0]);
    sums[0] += p.volume[q], sums[1] += 1. / soil.points_per_cell();
  });
  reduce(comm, ends, MPI_MAX), reduce(comm, sums, MPI_SUM);
  const double low = -ends[0], width = std::sqrt(2 * sums[0] / sums[1]);
  const size_t strips = static_cast<size_t>((ends[1] - low) / width) + 1;
  const auto strip_of = [&](const GaussPoints<2> &p, int q) {
    return std::min(strips - 1, static_cast<size_t>((p.position[q][0] - low) / width));
  };
  std::vector<double> most(strips, 0), moved(strips, 0), height(strips, -1e300), place(strips, -1e300);
  each_point(soil, [&](const GaussPoints<2> &p, int q) {
    const size_t s = strip_of(p, q);
    most[s] = std::max(most[s], shearing_of(p.increment[q].strain));
    moved[s] = std::max(moved[s], displacement_of(soil, p, q));
  });
  reduce(comm, most, MPI_MAX), reduce(comm, moved, MPI_MAX);
  each_point(soil, [&](const GaussPoints<2> &p, int q) {
    const size_t s = strip_of(p, q);
    if (shearing_of(p.increment[q].strain) == most[s]) place[s] = p.position[q][0], height[s] = p.position[q][1];
  });
  reduce(comm, place, MPI_MAX), reduce(comm, height, MPI_MAX);
  std::vector<std::array<double, 2>> surface;
  for (size_t s = 0; s < strips; ++s)
    if (moved[s] > moving) surface.push_back({place[s], height[s]});
  return surface;
}

}  // namespace

template <int dim>
void find_slip_surface(const SoilElements<dim> &soil, FactorOfSafety *result) {
  constexpr double share = 0.1;
  const double moving = share * soil.largest_displacement();
  std::vector<double> volume{0};
  each_point(soil, [&](const GaussPoints<dim> &p, int q) {
    if (displacement_of(soil, p, q) > moving) volume[0] += p.volume[q];
  });
  reduce(soil.nodes().comm(), volume, MPI_SUM);
  result->moving_volume = volume[0];
  if constexpr (dim == 2) result->slip_surface = slip_surface(soil, moving);
}

template void find_slip_surface<2>(const SoilElements<2> &, FactorOfSafety *);
template void find_slip_surface<3>(const SoilElements<3> &, FactorOfSafety *);

}  // namespace talus
