#pragma once
/// Pores that may dry, in the solve for implicit pressure, docs/theory/pores.md (8.2a).
#include <algorithm>

#include "physics/pores/storage.h"

namespace talus {

struct DryingPores {
  struct Pressure {
    double value, slope;  ///< P_l [Pa], and over that of full pores
  };

  /// Pores of the saturation 1 - `share`, whose content of liquid would have the pressure `full` were they full, have
  /// the pressure `pressure` at the start of a step [Pa].
  void begin(const Liquid &liquid, double full, double pressure, double share) {
    start_ = full, share_ = share, at_start_ = {pressure, 1}, reach_ = 0;
    if (full >= -soil->entry()) return;
    const double content = content_at(liquid, full);
    at_start_.slope = slope(liquid, content, share, pressure);
    reach_ = near * std::min(share, 1 - share) * liquid.density / liquid.density_slope(content);
  }
  /// Pressure after `full` has become another one, by (3.2).
  Pressure at(const Liquid &liquid, double full) {
    if (std::abs(full - start_) <= reach_)
      return {at_start_.value + at_start_.slope * (full - start_), at_start_.slope};
    if (full >= -soil->entry()) return {full, 1};
    const double content = content_at(liquid, full);
    PoreLanes<1> p{{content}, {}, {share_}, {}, {}, {}};
    unsaturated_pressures(*soil, liquid, p);
    share_ = p.gas_share[0];
    return {p.liquid[0], slope(liquid, content, p.gas_share[0], p.liquid[0])};
  }

  const SoilPores *soil;

 private:
  static constexpr double least_content = 1e-6;  ///< of full pores
  static constexpr double near = 1e-2;           ///< change of the gas share over which the curve counts as straight
  static double content_at(const Liquid &liquid, double full) {
    return std::max(liquid.density_at(full), least_content * liquid.density);
  }
  double slope(const Liquid &liquid, double content, double share, double pressure) const {
    const double rho = liquid.density_at(pressure);
    return liquid.density_slope(content) /
           (rho / std::max(soil->at(share).slope, 1e-300) + (1 - share) * liquid.density_slope(rho));
  }

  double start_, reach_, share_;
  Pressure at_start_;
};

}  // namespace talus
