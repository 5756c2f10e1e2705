#pragma once
/// Values that a scene may have but hardly means: most come from a number in another unit than that of its key.
#include <string>
#include <vector>

#include "physics/laws/laws.h"
#include "scene/scene.h"

namespace talus {

/// A sentence for each value of a soil that no soil has, with the unit that may have been meant.
std::vector<std::string> unlikely_values(const Scene &scene, const std::vector<Law> &laws);

}  // namespace talus
