#include "physics/laws/strength_by_place.h"

#include <cmath>
#include <string_view>

#include "physics/laws/laws.h"
#include "scene/reader.h"

namespace talus {

struct StrengthByPlace::Reader {
  TableReader reader;
  StrengthByPlace &strength;
  void by_place(const char *key, double, bool, Unit unit, Range range, const char *meaning) {
    Function &one = std::string_view(key) == "cohesion" ? strength.cohesion_ : strength.friction_angle_;
    one = reader.function_of_place(key, unit, range, meaning);
  }
  void number(const char *, double, Unit, Range, const char *) {}
};

StrengthByPlace::StrengthByPlace(const DeferredTable &body, const Law &law) {
  if (!body.reader || !reads_shares(law)) return;
  FrictionalStrength strength = *frictional_strength(law);
  strength.fields(Reader{*body.reader, *this});
}

StrengthShares StrengthByPlace::shares(const Law &law, double x, double y, double z) const {
  StrengthShares found;
  const FrictionalStrength *largest = frictional_strength(law);
  if (!largest) return found;
  if (cohesion_.given() && largest->cohesion > 0) found.cohesion = cohesion_(x, y, z, 0) / largest->cohesion;
  if (friction_angle_.given() && largest->friction_angle > 0)
    found.friction = friction_angle_(x, y, z, 0) / largest->friction_angle;
  return found;
}

void StrengthByPlace::widen(StrengthRange &range, double x, double y, double z) const {
  const auto take = [&](const Function &value_at, std::array<double, 2> &of) {
    if (!value_at.given()) return;
    const double value = value_at(x, y, z, 0);
    of = {std::fmin(of[0], value), std::fmax(of[1], value)};  // NaN: no place so far
  };
  take(cohesion_, range.cohesion), take(friction_angle_, range.friction_angle);
}

StrengthRange strength_of(const Law &law) {
  const FrictionalStrength *one = frictional_strength(law);
  if (!one) return {};
  return {{one->cohesion, one->cohesion}, {one->friction_angle, one->friction_angle}};
}

std::string take_largest(Law &law, const StrengthRange &range) {
  std::string problem;
  law = with_changed_strength(law, [&](auto &one) {
    if (std::isnan(one.cohesion)) one.cohesion = range.cohesion[1];
    if (std::isnan(one.friction_angle)) one.friction_angle = range.friction_angle[1];
    problem = one.problem();
  });
  return problem;
}

}  // namespace talus
