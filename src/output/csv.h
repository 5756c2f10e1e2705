#pragma once
/// Texts in CSV files.
#include <string>

namespace talus {

/// A text as one field of a CSV line.
inline std::string csv_field(const std::string &text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

}  // namespace talus
