#pragma once
/// What differs between two scenes.
#include <string>
#include <vector>

namespace talus {

/// Paths of the keys in which two scenes differ (stage.1.duration, body.sand), given as TableReader::values prints
/// them.
std::vector<std::string> changed_keys(const std::string &before, const std::string &now);

}  // namespace talus
