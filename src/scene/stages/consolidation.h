#pragma once
/// Equilibrium of the soil and flow of its pore water together, by finite elements.
#include "scene/stages/static_keys.h"
#include "scene/stages/traits.h"

namespace talus {

struct ConsolidationKeys : StaticKeys {
  static constexpr const char *name = "consolidation",
                              *meaning = "equilibrium and flow of pore water together in time, by finite elements";
  static constexpr StageTraits traits{
      .finite_elements = true, .water_flows = true, .end = "consolidation by finite elements"};
};

}  // namespace talus
