#pragma once
/// A bar on elastic bond in soil that is strained uniformly by e (Cox 1952, Brit. J. Appl. Phys. 3): its force at the
/// distance x from its middle is E A e (1 - cosh(b x) / cosh(b L / 2)), b^2 = k / (E A). A bond of limited strength
/// that slips over all of its length: strength times L / 2 in the middle.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_bar(Rung &rung) {
  constexpr double stiffness = 1e5, strain = 1e-3, bond = 5e6, length = 0.8;
  const auto force = [&](const std::vector<std::string> &overrides) {
    return rung.run(overrides).history.column("bar_axial_force_N").back();
  };
  const auto transferred = [&](double k) {
    return stiffness * strain * (1 - 1 / std::cosh(std::sqrt(k / stiffness) * length / 2));
  };
  rung.compare("largest force, stiff bond", transferred(bond), force({}), 0.03);
  rung.compare("largest force, soft bond", transferred(bond / 10), force({"structure.bar.bond_stiffness=5e5"}), 0.03);
  const Run slips =
      rung.run({"structure.bar.kind=anchor", "structure.bar.free_length=0.3", "structure.bar.bond_strength=50"});
  rung.compare("pull-out of an anchor", 50 * 0.5, slips.history.column("bar_head_force_N").back(), 0.005);
}

}  // namespace talus::rungs
