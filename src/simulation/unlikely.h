#pragma once
/// What a scene may have but hardly means: most of it comes from a number in another unit than that of its key.
#include <string>
#include <vector>

#include "physics/laws/laws.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {

/// A sentence for each value of a soil that no soil has, or none of this height, with the unit that may have been
/// meant.
std::vector<std::string> unlikely_values(const Scene &scene, const std::vector<Law> &laws,
                                         const std::vector<BodyReport> &bodies);

/// A sentence for what fits the soil badly: its size, the direction of gravity, the place of the water table, open
/// water that is not level, ends of the mesh without a condition. `bodies` and `surface` as they are at the start.
std::vector<std::string> unlikely_surroundings(const Scene &scene, const std::vector<BodyReport> &bodies,
                                               const std::vector<SoilFace> &surface);

/// A sentence for each body whose cells are too large for the height of the soil.
std::vector<std::string> coarse_cells(const Scene &scene, const std::vector<BodyReport> &bodies);

}  // namespace talus
