#pragma once
/// The root mean square speed of the soil stays below a limit. A large model that stands may hide soil that still
/// slides: the end is said to be rest only where none does. `ended_at_rest` (commands/comparison.h) reads these words.
#include <cmath>

#include "simulation/run.h"
#include "simulation/still_moving.h"

namespace talus {

template <int dim>
class StopAtRest final : public StopCriterion<dim> {
 public:
  explicit StopAtRest(const Stage &stage) : stage_(stage) {}

  bool met(Run<dim> &run, const Verdict &) override {
    constexpr int steps_between_checks = 25, checks_of_rest = 8;
    if (run.clock.steps % steps_between_checks) return false;
    const Balance sums = run.balance();
    quiet_checks_ = std::sqrt(2 * sums.kinetic / run.world.total_mass) < stage_.rest_speed ? quiet_checks_ + 1 : 0;
    if (quiet_checks_ < checks_of_rest) return false;
    if (const auto left = still_moving(run.world.comm, run.recorder.snapshot()))
      run.recorder.note("stage " + stage_.name + " ended: the rms speed of all soil is below rest_speed = " +
                        rounded(stage_.rest_speed) + " m/s, but " + left->sentence());
    else
      run.recorder.note("stage " + stage_.name + " came to rest");
    return true;
  }
  void serialize(Archive &archive) override { archive.serialize("rest", quiet_checks_); }

 private:
  const Stage &stage_;
  int quiet_checks_ = 0;  ///< in a row
};

}  // namespace talus
