#pragma once
/// Keys that a scene must give.
#include <limits>

namespace talus {

/// A number with this initial value has no default: the scene must give it.
inline constexpr double required = std::numeric_limits<double>::quiet_NaN();

}  // namespace talus
