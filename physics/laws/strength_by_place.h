#pragma once
/// Strength that a scene gives as a function of the undeformed place. A law holds numbers only, so that its loop stays
/// one over numbers: of a function it holds the largest value, and each point has the share of that value which belongs
/// to its place (`Surroundings::cohesion`, `friction`).
#include <string>

#include "physics/laws/law.h"
#include "physics/laws/strength_range.h"
#include "scene/function.h"

namespace talus {

/// c and phi of a point over those of its law.
struct StrengthShares {
  double cohesion = 1, friction = 1;
};

/// The functions that the law in the table of a body has in place of numbers. Values that their keys do not admit are
/// faults of the scene (`Scene::function_fault`).
class StrengthByPlace {
 public:
  StrengthByPlace(const DeferredTable &body, const Law &law);

  bool given() const { return cohesion_.given() || friction_angle_.given(); }
  /// Of a law that holds the largest values.
  StrengthShares shares(const Law &law, double x, double y, double z) const;
  /// Widens `range`, which begins with NaN, to the values at a place.
  void widen(StrengthRange &range, double x, double y, double z) const;

 private:
  /// Visits the keys of a strength.
  struct Reader;
  Function cohesion_, friction_angle_;  ///< not given: the law's number
};

/// c and phi of a law's numbers: NaN in place of functions.
StrengthRange strength_of(const Law &law);
/// Puts the largest values in the place of functions; what is then wrong between the law's parameters, or "".
std::string take_largest(Law &law, const StrengthRange &range);

}  // namespace talus
