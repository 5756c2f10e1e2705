#pragma once
#include "physics/pores/permeability/wetness.h"

namespace talus {

/// k_rl = k_rg = 1.
struct ConstantPermeability {
  static constexpr const char *name = "constant";
  static constexpr const char *meaning = "does not depend on saturation";
  template <class Visitor>
  void fields(Visitor &&) {}

  double liquid(const Wetness &) const { return 1; }
  double gas(const Wetness &) const { return 1; }
};

}  // namespace talus
