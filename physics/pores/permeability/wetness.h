#pragma once
#include <cmath>

namespace talus {

/// What relative permeabilities depend on.
struct Wetness {
  double wet;      ///< effective saturation S_e [-]
  double dry;      ///< 1 - S_e [-], without the round-off of a difference
  double suction;  ///< [Pa]
};

/// ln S_e from whichever of S_e and 1 - S_e has the digits.
inline double log_wet(double wet, double dry) { return wet < 0.5 ? std::log(wet) : std::log1p(-dry); }

}  // namespace talus
