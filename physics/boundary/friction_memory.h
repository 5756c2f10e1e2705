#pragma once
/// What a contact that rubs remembers of the normal impulses on it: friction follows them with a delay, docs/theory
/// (6.1), (6.2).
#include <cmath>
#include <limits>

namespace talus {

struct FrictionMemory {
  static constexpr double never = std::numeric_limits<double>::infinity();
  double capacity = 0;  ///< friction impulse that normal impulses of the recent past still allow [N s]
  double gathered = 0;  ///< time since which `capacity` gathers, where soil was at the start; elsewhere `never`
  double since_pressed = never;  ///< time since the node last pressed [s]

  bool gathers(double delay) const { return gathered < delay; }
  /// Of the capacity, that a step gamma may spend [-].
  double share(double gamma, double delay) const {
    const double adapted = delay > 0 ? 1 - std::exp(-gamma / delay) : 1;
    return gathers(delay) ? gamma / (gathered + gamma) : adapted;
  }
  /// Does the contact adhere in a step gamma?
  bool adheres(bool presses, double gamma, double delay) const { return presses || since_pressed + gamma <= delay; }
  /// A step gamma has passed, which leaves this capacity.
  void pass(double gamma, bool presses, double left) {
    since_pressed = presses ? 0 : since_pressed + gamma;
    gathered += gamma;
    capacity = left;
  }
};

}  // namespace talus
