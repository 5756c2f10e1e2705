#pragma once
/// How what is wrong or doubtful of terrain is said.
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/rounded.h"

namespace talus::terrain_words {

[[noreturn]] inline void complain(const std::string &text) { throw std::invalid_argument(text); }

template <class... Part>
std::string text_of(const Part &...part) {
  std::ostringstream text;
  text.precision(9);
  (text << ... << part);
  return text.str();
}

/// A number in a sentence, to three digits.
inline std::string digits(double value) { return rounded(value, 3); }
inline std::string length(double metres) { return digits(metres) + " m"; }

}  // namespace talus::terrain_words
