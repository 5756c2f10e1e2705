#include "simulation/still_moving.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "output/together.h"

namespace talus {
namespace {

struct Particle {
  double displacement, speed, mass, volume;
};

/// Magnitudes of the rows of a column.
double size_of(const Column &column, std::size_t row) {
  const double *x = column.values.data() + row * column.components;
  return std::sqrt(std::inner_product(x, x + column.components, x, 0.));
}

/// The displacement that nearly all of the mass has at most.
double largest_displacement(std::vector<Particle> all) {
  std::ranges::sort(all, {}, &Particle::displacement);
  double mass = 0, sum = 0;
  for (const Particle &p : all) mass += p.mass;
  for (const Particle &p : all)
    if ((sum += p.mass) >= nearly_all * mass) return p.displacement;
  return all.empty() ? 0 : all.back().displacement;
}

/// Quantile of sorted values, linear between them.
double quantile(const std::vector<double> &sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

std::optional<MotionLeft> of_all(const std::vector<Particle> &all, int dimension) {
  if (all.empty()) return {};
  double volume = 0, mass = 0, fast = 0;
  for (const Particle &p : all) volume += p.volume;
  const double spacing = std::pow(volume / static_cast<double>(all.size()), 1. / dimension),
               largest = largest_displacement(all);
  if (largest <= slides_least * spacing) return {};
  std::vector<double> speeds;
  for (const Particle &p : all) {
    if (p.displacement <= slides_share * largest) continue;
    speeds.push_back(p.speed), mass += p.mass, fast += p.speed > slow ? p.mass : 0;
  }
  if (fast <= restless * mass) return {};
  std::ranges::sort(speeds);
  return MotionLeft{fast / mass, quantile(speeds, nearly_all)};
}

}  // namespace

std::string MotionLeft::sentence() const {
  std::ostringstream text;
  text.precision(3);
  text << 100 * share << " % of what slid is faster than " << slow << " m/s, at up to " << speed << " m/s";
  return text.str();
}

std::optional<MotionLeft> still_moving(MPI_Comm comm, const Snapshot &state) {
  const auto column = [&](const char *name) { return std::ranges::find(state.columns, name, &Column::name); };
  const auto displacement = column("displacement"), velocity = column("velocity"), mass = column("mass"),
             volume = column("volume"), none = state.columns.end();
  if (displacement == none || velocity == none || mass == none || volume == none) return {};  // on all ranks
  std::vector<Particle> mine;
  for (std::size_t i = 0; i < state.id.size(); ++i)
    mine.push_back({size_of(*displacement, i), size_of(*velocity, i), mass->values[i], volume->values[i]});
  const std::vector<Particle> all = gather(comm, mine);
  double found[3]{};
  if (const auto left = of_all(all, displacement->components))
    found[0] = 1, found[1] = left->share, found[2] = left->speed;
  check_mpi(MPI_Bcast(found, 3, MPI_DOUBLE, 0, comm), "sending the motion that is left");
  if (found[0] == 0) return {};
  return MotionLeft{found[1], found[2]};
}

}  // namespace talus
