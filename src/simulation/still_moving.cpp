#include "simulation/still_moving.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

#include "output/together.h"

namespace talus {
namespace {

/// Magnitudes of the rows of a column.
double size_of(const Column &column, std::size_t row) {
  const double *x = column.values.data() + row * column.components;
  return std::sqrt(std::inner_product(x, x + column.components, x, 0.));
}

double sum_of_ranks(MPI_Comm comm, double mine) {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, comm), "adding up what slid");
  return mine;
}

/// A value, not negative, and what it weighs.
using Weighed = std::vector<std::pair<double, double>>;

/// The least value of all ranks that has this weight together with all below it; the largest, where all have less. No
/// rank has those of others: it is found by bisection, which ends since doubles from 0 on are ordered as their bits
/// are.
double value_at(MPI_Comm comm, const Weighed &mine, double weight) {
  std::uint64_t low = 0, high = 0;
  for (const auto &[value, w] : mine) high = std::max(high, std::bit_cast<std::uint64_t>(value));
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, &high, 1, MPI_UINT64_T, MPI_MAX, comm), "finding the largest motion");
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    double below = 0;
    for (const auto &[value, w] : mine) below += value <= std::bit_cast<double>(middle) ? w : 0;
    if (sum_of_ranks(comm, below) >= weight)
      high = middle;
    else
      low = middle + 1;
  }
  return std::bit_cast<double>(low);
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
  Weighed ways, speeds;
  double all[5]{};  // particles, volume, mass; mass and number of what moved by more than its own size
  for (std::size_t i = 0; i < state.id.size(); ++i) {
    const double way = size_of(*displacement, i), m = mass->values[i], v = volume->values[i];
    ways.emplace_back(way, m), ++all[0], all[1] += v, all[2] += m;
    if (way > std::pow(v, 1. / displacement->components)) all[3] += m, ++all[4];
  }
  for (double &sum : all) sum = sum_of_ranks(comm, sum);
  if (all[0] == 0) return {};
  double single = (1 - nearly_all) * all[2];
  if (all[4] >= several) single = std::min(single, of_moved * all[3]);
  const double spacing = std::pow(all[1] / all[0], 1. / displacement->components),
               largest = value_at(comm, ways, all[2] - single);
  if (largest <= slides_least * spacing) return {};
  double slid = 0, fast = 0, number = 0;
  for (std::size_t i = 0; i < state.id.size(); ++i) {
    if (ways[i].first <= slides_share * largest) continue;
    const double speed = size_of(*velocity, i);
    speeds.emplace_back(speed, 1), slid += ways[i].second, ++number, fast += speed > slow ? ways[i].second : 0;
  }
  slid = sum_of_ranks(comm, slid), fast = sum_of_ranks(comm, fast), number = sum_of_ranks(comm, number);
  if (fast <= restless * slid) return {};
  const double rank = nearly_all * (number - 1), below = std::floor(rank), low = value_at(comm, speeds, below + 1);
  return MotionLeft{fast / slid, low + (rank - below) * (value_at(comm, speeds, below + 2) - low)};
}

}  // namespace talus
