#pragma once
/// The stage takes its duration.
#include "scene/stages/traits.h"

namespace talus {

struct AtDuration {
  static constexpr const char *name = "duration", *meaning = "the stage takes its duration";
  static constexpr StopTraits traits{};
  template <class Visitor>
  void fields(Visitor &&) {}
};

}  // namespace talus
