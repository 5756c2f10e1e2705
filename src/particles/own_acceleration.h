#pragma once
/// Acceleration that a scene gives the soil of a body beside gravity.
#include <vector>

#include "scene/function.h"

namespace talus {

struct BodySource;
/// Functions of the undeformed place and t [m/s2], one per component; empty: none.
const std::vector<Function> &own_acceleration(const BodySource &source);

}  // namespace talus
