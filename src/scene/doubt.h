#pragma once
/// A value, or a relation between values, that a scene may have but hardly means.
#include <string>

namespace talus {

struct Doubt {
  std::string name;      ///< short, by which the scene silences it: acknowledge = ["damping"]
  std::string sentence;  ///< without its full stop
  std::string text() const { return sentence + " [" + name + "]"; }
};

}  // namespace talus
