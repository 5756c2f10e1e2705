#pragma once
#include <array>

namespace talus {

/// Least and largest c and phi in a body; zero where its law has neither.
struct StrengthRange {
  std::array<double, 2> cohesion{}, friction_angle{};  ///< [Pa], [rad]
};

}  // namespace talus
