#pragma once
/// A point passes a speed and keeps accelerating: its mean velocity is larger in each tenth of a watching time.
#include <cmath>
#include <sstream>

#include "simulation/run.h"

namespace talus {

/// The velocity is averaged over tenths of `failure_time`, as a vector, so that a vibration about a place does not look
/// like motion, nor its backward swing like an end of acceleration.
template <int dim>
class StopAtFailure final : public StopCriterion<dim> {
 public:
  explicit StopAtFailure(const Stage &stage) : stage_(stage) {}

  std::string watched_point() const override { return stage_.failure_point; }

  /// Counts tenths that are fast and faster than the one before; ends when one and ten further ones are.
  bool met(Run<dim> &run, const Verdict &verdict) override {
    const double now = run.clock.time, step = run.clock.last_step;
    for (int d = 0; d < 3; ++d) seen_.path[d] += verdict.watched_velocity[d] * step;
    seen_.elapsed += step;
    if (seen_.elapsed < stage_.failure_time / 10 * (1 - 1e-9)) return false;
    const double speed = std::hypot(seen_.path[0], seen_.path[1], seen_.path[2]) / seen_.elapsed;
    const bool accelerates = speed > seen_.last_speed, fast = speed > stage_.failure_speed;
    if (!fast || !accelerates) seen_.watched = 0;
    if (fast && seen_.watched++ == 0) pass(run.clock, speed);
    seen_.last_speed = speed, seen_.last_middle = now - seen_.elapsed / 2;
    seen_.path = {}, seen_.elapsed = 0;
    constexpr int tenths = 10;
    if (seen_.watched <= tenths) return false;
    std::ostringstream text;
    text.precision(8);
    text << "failure at " << seen_.time << " s (loads at t = " << seen_.load_time << " s): point "
         << stage_.failure_point << " passed " << stage_.failure_speed << " m/s and kept accelerating";
    run.recorder.note(text.str(), seen_.time, seen_.load_time);
    return true;
  }
  void serialize(Archive &archive) override { archive.serialize("failure", seen_); }

 private:
  /// Notes when the speed was passed: between the middle of this tenth and, if that was slower, of the last one.
  void pass(const Clock &clock, double speed) {
    const double middle = clock.time - seen_.elapsed / 2, limit = stage_.failure_speed;
    const bool between = seen_.last_speed >= 0 && seen_.last_speed < limit;
    seen_.time =
        between ? middle - (middle - seen_.last_middle) * (speed - limit) / (speed - seen_.last_speed) : middle;
    seen_.load_time = clock.load_time - (clock.hold_loads ? 0 : clock.time - seen_.time);
  }

  struct Seen {
    std::array<double, 3> path{};    ///< of the point in the present tenth [m]
    double elapsed = 0;              ///< of the present tenth [s]
    double last_speed = -1;          ///< mean of the tenth before; -1: there is none [m/s]
    double last_middle = 0;          ///< of the tenth before [s]
    double time = 0, load_time = 0;  ///< when the speed was passed [s]
    long long watched = 0;           ///< tenths in a row, each faster than the one before
  };
  const Stage &stage_;
  Seen seen_;
};

}  // namespace talus
