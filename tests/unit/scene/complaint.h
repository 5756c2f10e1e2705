#pragma once
#include <stdexcept>
#include <string>

namespace talus {

/// What a statement complains about, empty when it does not.
template <class Statement>
std::string complaint(const Statement &statement) {
  try {
    statement();
  } catch (const std::invalid_argument &error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string &text, const std::string &part) { return text.find(part) != std::string::npos; }

}  // namespace talus
