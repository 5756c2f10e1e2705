#pragma once
/// Numbers in sentences.
#include <sstream>
#include <string>

namespace talus {

/// A number to a few significant digits.
inline std::string rounded(double value, int digits = 4) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

}  // namespace talus
