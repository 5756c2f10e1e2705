#pragma once
/// The motion of the ground in all directions, as the stages of a scene see it.
#include <array>
#include <vector>

#include "earthquake/ground_motion.h"

namespace talus {

struct EarthquakeSource;

class GroundShaking {
 public:
  GroundShaking() = default;
  /// Reads the motions. Throws SceneError for one that cannot be read or used.
  explicit GroundShaking(const std::vector<EarthquakeSource> &components);

  bool given() const { return !components_.empty(); }
  /// Of the longest component [s].
  double duration() const;
  /// Acceleration at a time after its begin [m/s2].
  std::array<double, 3> acceleration(double t) const;

  /// Velocity at that time; after the end that of the end [m/s].
  std::array<double, 3> velocity(double t) const;

  struct Component {
    std::array<double, 3> direction;  ///< unit vector
    GroundMotion motion;
    std::vector<double> velocity;  ///< at the values of the motion [m/s]
  };
  const std::vector<Component> &components() const { return components_; }

 private:
  std::vector<Component> components_;
};

}  // namespace talus
