#include "particles/own_acceleration.h"

#include "scene/body_source.h"

namespace talus {

const std::vector<Function> &own_acceleration(const BodySource &source) { return source.body_acceleration; }

}  // namespace talus
