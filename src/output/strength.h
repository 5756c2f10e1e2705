#pragma once
/// Strength envelopes of a run's soils for its pictures, from the laws themselves.
#include <string>
#include <vector>

#include "physics/laws/strength_range.h"

namespace talus {

/// Strength of a soil in triaxial compression: q = slope p + intercept, where p is the mean effective stress, positive
/// in compression.
struct StrengthLine {
  std::string body;
  bool residual;     ///< after any amount of plastic strain; else the peak
  double suction;    ///< [Pa]
  double slope;      ///< [-]
  double intercept;  ///< [Pa]
};

/// Lines of the Mohr-Coulomb and Drucker-Prager soils in the text of a scene: the peak and, where soil softens, the
/// residual strength; at no suction and, where strength depends on suction, at 1, 2, 5, 10 ... kPa up to 1 MPa. Soil
/// whose strength is a function of place has lines of the least and of the largest values in `ranges`, by body; none
/// without a range. Throws what the reader of scenes throws.
std::vector<StrengthLine> strength_lines(const std::string &scene, const std::vector<StrengthRange> &ranges = {});

/// Writes DIR/pictures/strength.csv (body,state,suction_Pa,slope,intercept_Pa) for the run in `dir`; nothing where no
/// soil has such a line. Throws std::exception with the cause.
void write_strength(const std::string &dir);

}  // namespace talus
