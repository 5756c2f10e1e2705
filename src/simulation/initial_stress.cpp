// Stress at the start of a quasi-static stage from the weight above and the earth pressure at rest.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "simulation/statics.h"

namespace talus {
namespace {

/// k0 of a body: its own, else Jaky's 1 - sin(phi) of the friction angle, else that of elastic soil held at its sides.
double earth_pressure_at_rest(const BodySource &source, const Law &law) {
  if (source.k0 > 0) return source.k0;
  return std::visit(
      [](const auto &one) {
        if constexpr (requires { one.friction_angle; })
          return 1 - std::sin(one.friction_angle);
        else
          return (3 * one.bulk_modulus() - 2 * one.shear_modulus()) /
                 (3 * one.bulk_modulus() + 4 * one.shear_modulus());
      },
      law);
}

}  // namespace

/// Vertical stress by the weight of soil and open water above, lateral stress k0 times its effective part. Every rank
/// sees all cells.
template <int dim>
void Statics<dim>::start_stress() {
  struct Block {
    std::array<Vec<dim>, dim + 1> corner;
    double density, low, high;  // extent along x
  };
  std::vector<Block> mine, all;
  for (int c = 0; c < world_.mesh.cell_count(); ++c) {
    const int b = problem_->soil().body_of(c);
    if (b < 0 || !world_.present[b]) continue;
    Block block{{}, 0, 1e300, -1e300};
    Vec<dim> centre{};
    for (int a = 0; a <= dim; ++a) {
      block.corner[a] = world_.mesh.position[world_.mesh.cells[c].node[a]];
      block.low = std::min(block.low, block.corner[a][0]), block.high = std::max(block.high, block.corner[a][0]);
      for (int d = 0; d < dim; ++d) centre[d] += block.corner[a][d] / (dim + 1);
    }
    block.density = world_.soil_density(world_.scene.body[b], centre, clock_.load_time);
    Barycentric<dim> middle;
    middle.fill(1. / (dim + 1));
    if (world_.phases.liquid) block.density += flow_->water_density(c, middle);
    mine.push_back(block);
  }
  int ranks;
  MPI_Comm_size(world_.comm, &ranks);
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  const int bytes = static_cast<int>(mine.size() * sizeof(Block));
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, world_.comm);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  all.resize(starts[ranks] / sizeof(Block));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), counts.data(), starts.data(), MPI_BYTE, world_.comm);
  double low = 1e300, high = -1e300;
  for (const Block &block : all) low = std::min(low, block.low), high = std::max(high, block.high);
  const int strips = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(all.size()))));
  const auto strip_of = [&](double x) {
    return std::clamp(static_cast<int>((x - low) / (high - low) * strips), 0, strips - 1);
  };
  std::vector<std::vector<int>> in_strip(strips);
  for (size_t k = 0; k < all.size(); ++k)
    for (int s = strip_of(all[k].low); s <= strip_of(all[k].high); ++s) in_strip[s].push_back(static_cast<int>(k));

  for (size_t b = 0; b < world_.bodies.size(); ++b) {
    GaussPoints<dim> &points = problem_->soil().points()[b];
    if (!world_.present[b]) continue;
    const double k0 = earth_pressure_at_rest(world_.scene.body[b], world_.laws[b]);
    for (int q = 0; q < points.count(); ++q) {
      const Vec<dim> &x = points.position[q];
      double weight = 0, top = x[1];
      for (int k : in_strip[strip_of(x[0])]) {
        // the part of the vertical through x that lies in the simplex and above x: barycentric coordinates are linear
        // along it
        const Block &block = all[k];
        if (x[0] < block.low || x[0] > block.high) continue;
        Square<dim> edges;
        for (int a = 0; a < dim; ++a) edges.col(a) = map<dim>(block.corner[a + 1]) - map<dim>(block.corner[0]);
        const Square<dim> inverse = edges.inverse();
        const ColumnVector<dim> at = inverse * (map<dim>(x) - map<dim>(block.corner[0])), slope = inverse.col(1);
        double from = 0, to = 1e300;  // height above x
        const auto cut = [&](double value, double rise) {
          if (rise > 0)
            from = std::max(from, -value / rise);
          else if (rise < 0)
            to = std::min(to, -value / rise);
          else if (value < 0)
            to = 0;
        };
        cut(1 - at.sum(), -slope.sum());
        for (int a = 0; a < dim; ++a) cut(at[a], slope[a]);
        if (to > from) weight -= block.density * world_.scene.gravity[1] * (to - from), top = std::max(top, x[1] + to);
      }
      double pressure = 0;
      if (world_.phases.prescribed) {
        Vec<dim> surface = x;
        surface[1] = top;
        pressure = world_.pressure(x, clock_.load_time);
        if (world_.scene.water.open_water_load) weight += world_.pressure(surface, clock_.load_time);
      }
      if (world_.phases.liquid)
        pressure = flow_->stress_pressure(points.cell[q],
                                          problem_->soil().rule().point[q % problem_->soil().points_per_cell()]);
      double *stress = &points.stress[q * stress_size<dim>];
      std::fill_n(stress, stress_size<dim>, 0.);
      stress[1] = pressure - weight, stress[0] = stress[2] = k0 * stress[1];
    }
  }
}

template void Statics<2>::start_stress();
template void Statics<3>::start_stress();

}  // namespace talus
