#pragma once
/// Soil has failed when it moves fast and stores no more of the energy that loads bring, docs/theory section 5.3.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "scene/stage.h"
#include "simulation/run.h"

namespace talus {

/// The velocity of the point is a mean over `failure_time`, as a vector, so that a vibration about a place does not
/// look like motion. Once it passes `failure_speed`, energies tell soil that has failed from soil that follows its
/// loads.
template <int dim>
class StopAtFailure final : public StopCriterion<dim> {
 public:
  StopAtFailure(const Stage &, const AtFailure &keys) : keys_(keys) {}

  std::string watched_point() const override { return keys_.failure_point; }

  bool met(Run<dim> &run, const Verdict &verdict) override {
    Tenth &present = seen_.tenth[seen_.ended % tenths];
    const double step = run.clock.last_step;
    for (int d = 0; d < 3; ++d) present.path[d] += verdict.watched_velocity[d] * step;
    present.elapsed += step;
    if (present.elapsed < keys_.failure_time / tenths * (1 - 1e-9)) return false;
    const bool over = ++seen_.ended >= tenths && watch(run);
    seen_.tenth[seen_.ended % tenths] = {};
    if (!over) return false;
    std::ostringstream text;
    text.precision(8);
    text << "failure at " << seen_.time << " s (loads at t = " << seen_.load_time << " s): point "
         << keys_.failure_point << " passed " << keys_.failure_speed
         << " m/s, and from then on the soil stored less than a third of the energy that it received";
    run.recorder.tell(
        {event::failure, text.str(), {{"failure_speed_m_s", keys_.failure_speed}}, false, seen_.time, seen_.load_time});
    return true;
  }
  void serialize(Archive &archive) override { archive.serialize("failure", seen_); }

 private:
  static constexpr int tenths = 10;
  /// Energy that is not stored over energy that is: of soil that has failed, and from its failure on.
  static constexpr double failed = 4, failing = 2;

  /// Looks at the end of a tenth: has the soil failed?
  bool watch(Run<dim> &run) {
    std::array<double, 3> path{};
    double elapsed = 0;
    for (const Tenth &one : seen_.tenth) {
      for (int d = 0; d < 3; ++d) path[d] += one.path[d];
      elapsed += one.elapsed;
    }
    const double speed = std::hypot(path[0], path[1], path[2]) / elapsed, middle = run.clock.time - elapsed / 2;
    const double last_speed = seen_.speed, last_middle = seen_.middle, limit = keys_.failure_speed;
    seen_.speed = speed, seen_.middle = middle;
    if (!(speed > limit)) {
      seen_.fast = 0;
      return false;
    }
    const EnergySums energies = run.energies.sums();
    const double stored = energies.balance.strain, not_stored = energies.not_stored(),
                 excess = failing * stored - not_stored;
    if (seen_.fast++ == 0) {
      const bool between = last_speed >= 0 && last_speed < limit;
      seen_.time = between ? middle - (middle - last_middle) * (speed - limit) / (speed - last_speed) : middle;
      seen_.load_time = run.clock.load_time - (run.clock.hold_loads ? 0 : run.clock.time - seen_.time);
      seen_.stored = stored, seen_.not_stored = not_stored, seen_.change = 0, seen_.excess = excess;
    }
    // soil that follows fast loads passes the speed long before it fails
    if (excess > seen_.excess)
      seen_.excess = excess, seen_.time = run.clock.time, seen_.load_time = run.clock.load_time;
    seen_.change = std::max(seen_.change, std::abs(stored - seen_.stored));
    return seen_.fast > tenths / 2 && not_stored - seen_.not_stored > failed * seen_.change;
  }

  struct Tenth {
    std::array<double, 3> path{};  ///< of the point [m]
    double elapsed = 0;            ///< [s]
  };
  struct Seen {
    std::array<Tenth, tenths> tenth{};  ///< the last ones of failure_time; the present one at place ended % 10
    long long ended = 0;                ///< that have ended
    double speed = -1, middle = 0;      ///< mean over the last ten of them, and their middle; -1: none [m/s], [s]
    long long fast = 0;                 ///< tenths since the speed was passed, this one included
    double time = 0, load_time = 0;     ///< of the failure, if it is one: no earlier than the speed was passed [s]
    double stored = 0, not_stored = 0;  ///< EnergySums when it was passed [J]
    double change = 0;                  ///< largest change of the stored energy since then [J]
    double excess = 0;                  ///< largest of twice the stored energy less what is not stored [J]
  };
  const AtFailure &keys_;
  Seen seen_;
};

}  // namespace talus
