#pragma once
/// `talus check` of a good scene with a few keys changed.
#include <gtest/gtest.h>

#include <cmath>

#include "bad_input/refused.h"

namespace talus {

inline Ending check(const Folder &folder, const std::vector<std::string> &overrides, int ranks = 1) {
  folder.write("scene.toml", good_scene), folder.write("section.csv", good_section);
  std::vector<std::string> arguments{"check", "scene.toml", "--json"};
  for (const std::string &one : overrides) arguments.insert(arguments.end(), {"--set", one});
  return talus(folder, arguments, ranks);
}

/// The first number behind "key": in a JSON document.
inline double number(const Ending &ending, const std::string &key) {
  const std::size_t at = ending.output.find("\"" + key + "\": ");
  return at == std::string::npos ? NAN : std::stod(ending.output.substr(at + key.size() + 4));
}

}  // namespace talus
