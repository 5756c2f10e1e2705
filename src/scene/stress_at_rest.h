#pragma once
/// How soil comes by the stress of its weight.
#include <algorithm>
#include <string>

#include "scene/scene.h"
#include "scene/stage.h"

namespace talus {

/// Does the stress of a body begin with the earth pressure at rest? So it does if the first stage that has the body and
/// moves soil says so.
inline bool begins_at_rest(const Scene &scene, const std::string &body) {
  const auto adds = [&](const Stage &stage) { return stage.adds(body); };
  auto first = std::ranges::find_if(scene.stage, adds);
  if (first == scene.stage.end()) first = scene.stage.begin();  // there from the start
  first = std::find_if(first, scene.stage.end(), [](const Stage &stage) { return stage.soil_moves(); });
  return first != scene.stage.end() && first->begins_at_rest();
}

}  // namespace talus
