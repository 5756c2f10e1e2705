#pragma once
/// A point passes a speed and keeps accelerating: its speed is larger at each tenth of a watching time.
#include <sstream>

#include "simulation/run.h"

namespace talus {

template <int dim>
class StopAtFailure final : public StopCriterion<dim> {
 public:
  explicit StopAtFailure(const Stage &stage) : stage_(stage) {}

  std::string watched_point() const override { return stage_.failure_point; }

  bool met(Run<dim> &run, const Verdict &verdict) override {
    const double speed = verdict.watched_speed, now = run.clock.time;
    if (seen_.time < 0) {
      if (speed > stage_.failure_speed) seen_ = {now, run.clock.load_time, now, speed};
      return false;
    }
    if (speed < stage_.failure_speed)
      seen_.time = -1;
    else if (now - seen_.last_rise >= stage_.failure_time / 10) {
      if (speed <= seen_.last_speed) seen_.time = -1;
      seen_.last_rise = now, seen_.last_speed = speed;
    }
    if (seen_.time < 0 || now - seen_.time < stage_.failure_time) return false;
    std::ostringstream text;
    text.precision(8);
    text << "failure at " << seen_.time << " s (loads at t = " << seen_.load_time << " s): point "
         << stage_.failure_point << " passed " << stage_.failure_speed << " m/s and kept accelerating";
    run.recorder.note(text.str(), seen_.time, seen_.load_time);
    return true;
  }
  void serialize(Archive &archive) override { archive.serialize("failure", seen_); }

 private:
  struct Seen {
    double time = -1, load_time = 0;  ///< when the speed was passed; -1: it was not [s]
    double last_rise = 0;             ///< when it was last compared [s]
    double last_speed = 0;            ///< [m/s]
  };
  const Stage &stage_;
  Seen seen_;
};

}  // namespace talus
