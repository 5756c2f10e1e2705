#pragma once
/// Where a motion takes the ground.
#include <array>
#include <vector>

#include "earthquake/shaking.h"

namespace talus {

class GroundPath {
 public:
  /// `shaking` must outlive it.
  explicit GroundPath(const GroundShaking &shaking);
  /// Displacement at a time after the begin of the motion, from rest there; after the end that of the end [m].
  std::array<double, 3> displacement(double t) const;

 private:
  const GroundShaking &shaking_;
  std::vector<std::vector<double>> at_values_;  ///< of each component [m]
};

}  // namespace talus
