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

/// Values of all ranks, none negative, that weigh something. No rank has those of others: values are found by
/// bisection, which ends since doubles from 0 on are ordered as their bits are.
class Distribution {
 public:
  Distribution(MPI_Comm comm, std::vector<std::pair<double, double>> value_and_weight)
      : comm_(comm), mine_(std::move(value_and_weight)) {
    std::ranges::sort(mine_);
    double sum = 0;
    for (auto &[value, weight] : mine_) weight = sum += weight;
    total_ = sum_of_ranks(comm, sum);
  }
  double total() const { return total_; }
  /// The least value that has this weight together with all below it; the largest, where all have less.
  double at(double weight) const {
    std::uint64_t low = 0, high = std::bit_cast<std::uint64_t>(mine_.empty() ? 0. : mine_.back().first);
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, &high, 1, MPI_UINT64_T, MPI_MAX, comm_), "finding the largest motion");
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (sum_of_ranks(comm_, weight_up_to(std::bit_cast<double>(middle))) >= weight)
        high = middle;
      else
        low = middle + 1;
    }
    return std::bit_cast<double>(low);
  }

 private:
  double weight_up_to(double value) const {
    const auto above = std::ranges::upper_bound(mine_, value, {}, &std::pair<double, double>::first);
    return above == mine_.begin() ? 0 : std::prev(above)->second;
  }

  MPI_Comm comm_;
  std::vector<std::pair<double, double>> mine_;  ///< sorted, with the sum of the weights up to each
  double total_;
};

/// Quantile of values that weigh 1 each, linear between them.
double quantile(const Distribution &of, double share) {
  const double place = share * (of.total() - 1), below = std::floor(place), low = of.at(below + 1);
  return low + (place - below) * (of.at(below + 2) - low);
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
  const std::size_t count = state.id.size();
  std::vector<std::pair<double, double>> ways, speeds;
  for (std::size_t i = 0; i < count; ++i) ways.emplace_back(size_of(*displacement, i), mass->values[i]);
  const double particles = sum_of_ranks(comm, static_cast<double>(count)),
               space = sum_of_ranks(comm, std::accumulate(volume->values.begin(), volume->values.end(), 0.));
  if (particles == 0) return {};
  const Distribution displacements(comm, ways);
  double moved = 0, number = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (ways[i].first > std::pow(volume->values[i], 1. / displacement->components)) moved += mass->values[i], ++number;
  moved = sum_of_ranks(comm, moved), number = sum_of_ranks(comm, number);
  double single = (1 - nearly_all) * displacements.total();
  if (number >= several) single = std::min(single, of_moved * moved);
  const double spacing = std::pow(space / particles, 1. / displacement->components),
               largest = displacements.at(displacements.total() - single);
  if (largest <= slides_least * spacing) return {};
  double slid = 0, fast = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (ways[i].first <= slides_share * largest) continue;
    const double speed = size_of(*velocity, i);
    speeds.emplace_back(speed, 1), slid += mass->values[i], fast += speed > slow ? mass->values[i] : 0;
  }
  slid = sum_of_ranks(comm, slid), fast = sum_of_ranks(comm, fast);
  if (fast <= restless * slid) return {};
  return MotionLeft{fast / slid, quantile(Distribution(comm, speeds), nearly_all)};
}

}  // namespace talus
