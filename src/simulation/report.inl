// What a simulation says about its bodies before it runs.
#include "simulation/simulation_impl.h"

namespace talus {

template <int dim>
std::vector<BodyReport> Simulation<dim>::bodies() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<BodyReport> reports;
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    BodyReport report{bodies_[b]->name()};
    double sums[6]{};             // particles, cells, mass, volume, steps and sizes of cells
    std::array<double, 7> least;  // particles in a cell, lowest and highest corner
    least.fill(infinity);
    struct {
      double step;
      int rank;
    } mine{infinity, 0}, slowest;
    std::array<double, 3> place{};
    for (int i = 0; i < p.count;) {
      const Cell<dim> &cell = mesh_.cells[p.cell[i]];
      const int first = i;
      for (; i < p.count && p.cell[i] == p.cell[first]; ++i) sums[2] += p.mass[i], sums[3] += p.volume[i];
      const double step = critical_[b](p.cell[first]), volume = mesh_.volume[p.cell[first]];
      sums[0] += i - first, sums[1] += 1, sums[4] += step, sums[5] += std::pow(volume, 1. / dim);
      least[0] = std::min<double>(least[0], i - first);
      Vec<dim> centre{};
      for (int node : cell.node)
        for (int d = 0; d < dim; ++d) {
          const double x = mesh_.position[node][d];
          least[1 + d] = std::min(least[1 + d], x), least[4 + d] = std::min(least[4 + d], -x),
                    centre[d] += x / (dim + 1);
        }
      if (step < mine.step) mine.step = step, std::copy_n(centre.begin(), dim, place.begin());
    }
    MPI_Comm_rank(comm_, &mine.rank);
    MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_DOUBLE, MPI_SUM, comm_);
    MPI_Allreduce(MPI_IN_PLACE, least.data(), 7, MPI_DOUBLE, MPI_MIN, comm_);
    MPI_Allreduce(&mine, &slowest, 1, MPI_DOUBLE_INT, MPI_MINLOC, comm_);
    MPI_Bcast(place.data(), 3, MPI_DOUBLE, slowest.rank, comm_);
    report.particles = static_cast<long long>(sums[0]), report.cells = static_cast<long long>(sums[1]);
    report.mass = sums[2], report.volume = sums[3];
    report.fewest_per_cell = static_cast<int>(least[0]);
    for (int d = 0; d < dim; ++d) report.low[d] = least[1 + d], report.high[d] = -least[4 + d];
    report.critical_step = slowest.step, report.slowest_cell = place;
    report.mean_critical_step = sums[4] / sums[1];
    // the side of a regular simplex of the mean size: sqrt(4 A / sqrt 3), (6 sqrt 2 V)^(1/3), as softening takes it
    report.cell_size = sums[5] / sums[1] * (dim == 2 ? std::sqrt(4 / std::sqrt(3.)) : std::cbrt(6 * std::sqrt(2.)));
    reports.push_back(report);
  }
  return reports;
}

}  // namespace talus
