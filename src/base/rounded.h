#pragma once
/// Numbers in sentences.
#include <cmath>
#include <sstream>
#include <string>

namespace talus {

/// A number to a few significant digits, with all digits before the point below ten millions: 12346, and not 1.235e+04.
inline std::string rounded(double value, int digits = 4) {
  constexpr double longest = 1e7;
  std::ostringstream text;
  text.precision(digits);
  if (std::abs(value) < longest && std::abs(value) >= std::pow(10, digits)) text << std::fixed, text.precision(0);
  text << value;
  return text.str();
}

}  // namespace talus
