#pragma once
/// What a scene changes with time while its soil moves.
#include <string>
#include <vector>

#include "scene/scene.h"

namespace talus {

/// A load, a support or a strength that functions of time give.
struct ChangingLoad {
  std::string key;  ///< boundary.NAME, or the path of another key
  std::vector<TimeSpan> when;
};

/// All of a scene, in the order of its boundaries, water and bodies.
std::vector<ChangingLoad> changing_loads(const Scene &scene);

}  // namespace talus
