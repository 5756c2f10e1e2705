#pragma once
/// Keys of all stages by finite elements.
#include <string>
#include <vector>

#include "base/units.h"

namespace talus {

enum class InitialStress { kept, k0 };
enum class WhenLost { stop, go_on };

struct StaticKeys {
  int load_steps = 5;  ///< in which loads come; fewer or more as Newton's iterations ask for
  InitialStress initial_stress = InitialStress::kept;
  std::vector<std::string> add, remove;  ///< bodies and structures that come and go with the stage
  WhenLost when_lost = WhenLost::stop;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.integer(
        "load_steps", load_steps, Range{1, 10000, {1, 200}},
        "quasi-static: number of steps in which loads are applied; a step is halved where Newton's iterations fail");
    v.choice("initial_stress", initial_stress, {{"kept", InitialStress::kept}, {"k0", InitialStress::k0}},
             "quasi-static: stress at the start of the stage: the present stress, or vertical stress from the weight "
             "above and k0 times it laterally");
    v.texts("add", add, "quasi-static: bodies and structures that this stage adds; they are absent before it");
    v.texts("remove", remove, "quasi-static: bodies and structures that this stage removes");
    v.choice(
        "when_lost", when_lost, {{"stop", WhenLost::stop}, {"next_stage", WhenLost::go_on}},
        "quasi-static: if there is no equilibrium under the loads, end with status 1 or continue with the next stage");
  }
};

}  // namespace talus
