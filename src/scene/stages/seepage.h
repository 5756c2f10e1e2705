#pragma once
/// Flow of pore water through soil at rest, by finite elements.
#include "base/units.h"
#include "scene/stages/static_keys.h"
#include "scene/stages/traits.h"

namespace talus {

struct SeepageKeys : StaticKeys {
  static constexpr const char *name = "seepage",
                              *meaning = "flow of pore water through soil at rest, by finite elements";
  static constexpr StageTraits traits{
      .finite_elements = true, .water_flows = true, .soil_moves = false, .end = "seepage by finite elements"};
  bool steady = false;  ///< the flow that the loads at the stage's end keep up
  template <class Visitor>
  void fields(Visitor &&v) {
    StaticKeys::fields(v);
    v.flag("steady", steady, "seepage: compute the steady flow under the loads at the end of the stage");
  }
};

}  // namespace talus
