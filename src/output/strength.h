#pragma once
/// Strength envelopes of a run's soils for its pictures, from the laws themselves.
#include <string>
#include <vector>

namespace talus {

/// What a soil bears in triaxial compression: q = slope p + intercept, p the mean effective stress, positive in
/// compression.
struct StrengthLine {
  std::string body;
  bool residual;     ///< after any amount of plastic strain; else the peak
  double suction;    ///< [Pa]
  double slope;      ///< [-]
  double intercept;  ///< [Pa]
};

/// Lines of the Mohr-Coulomb and Drucker-Prager soils of a scene's text: the peak and, where soil softens, the
/// residual; without suction and, where strength follows it, at suctions of 1, 2, 5, 10 ... kPa up to 1 MPa. Throws
/// like the reader.
std::vector<StrengthLine> strength_lines(const std::string &scene);

/// Writes DIR/pictures/strength.csv (body,state,suction_Pa,slope,intercept_Pa) for the run in `dir`; nothing where no
/// soil has such a line. Throws std::exception with the cause.
void write_strength(const std::string &dir);

}  // namespace talus
