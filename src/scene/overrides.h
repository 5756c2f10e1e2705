#pragma once
/// Values given on the command line, `--set key.path=value`; included only by the reader's own files.
#include <toml++/toml.h>

#include <string>

namespace talus {

/// Puts one override into a parsed scene. Throws SceneError when its path leads nowhere.
void apply_override(toml::table &root, const std::string &text);

}  // namespace talus
