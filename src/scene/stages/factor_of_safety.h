#pragma once
/// The factor of safety of the soil as the stages before left it.
#include "scene/stages/traits.h"

namespace talus {

/// Where strength is divided, and for how many mechanisms: [factor_of_safety], factor_source.h.
struct FactorKeys {
  static constexpr const char *name = "factor_of_safety",
                              *meaning =
                                  "factor of safety of the soil as the stages by finite elements before left it, "
                                  "which it does not change; it has no duration and no further keys, and "
                                  "[factor_of_safety] says where it searches";
  static constexpr StageTraits traits{
      .finite_elements = true, .soil_moves = false, .finds_factor = true, .end = "factor of safety"};
  template <class Visitor>
  void fields(Visitor &&) {}
};

}  // namespace talus
