#pragma once
/// Static equilibrium by finite elements.
#include "scene/stages/seismic.h"
#include "scene/stages/static_keys.h"
#include "scene/stages/traits.h"

namespace talus {

struct QuasiStaticKeys : StaticKeys, SeismicKeys {
  static constexpr const char *name = "quasi_static", *meaning = "static equilibrium by finite elements";
  static constexpr StageTraits traits{.finite_elements = true, .end = "equilibrium by finite elements"};
  template <class Visitor>
  void fields(Visitor &&v) {
    StaticKeys::fields(v), SeismicKeys::fields(v);
  }
};

}  // namespace talus
