#include "physics/laws/strength_by_place.h"

#include <cmath>
#include <string_view>

#include "scene/reader.h"

namespace talus {
namespace {

/// Calls `use` with the strength of a frictional law.
template <class OneLaw, class Use>
void with_strength(OneLaw &law, Use use) {
  std::visit(
      [&](auto &one) {
        if constexpr (requires { one.reads_shares; }) use(one);
      },
      law);
}

}  // namespace

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
  with_strength(law, [&](auto one) {
    if (body.reader && one.reads_shares) one.FrictionalStrength::fields(Reader{*body.reader, *this});
  });
}

StrengthShares StrengthByPlace::shares(const Law &law, double x, double y, double z) const {
  StrengthShares found;
  with_strength(law, [&](const auto &one) {
    if (cohesion_.given() && one.cohesion > 0) found.cohesion = cohesion_(x, y, z, 0) / one.cohesion;
    if (friction_angle_.given() && one.friction_angle > 0)
      found.friction = friction_angle_(x, y, z, 0) / one.friction_angle;
  });
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
  StrengthRange range;
  with_strength(law, [&](const auto &one) {
    range = {{one.cohesion, one.cohesion}, {one.friction_angle, one.friction_angle}};
  });
  return range;
}

std::string take_largest(Law &law, const StrengthRange &range) {
  std::string problem;
  with_strength(law, [&](auto &one) {
    if (std::isnan(one.cohesion)) one.cohesion = range.cohesion[1];
    if (std::isnan(one.friction_angle)) one.friction_angle = range.friction_angle[1];
    problem = one.problem();
  });
  return problem;
}

}  // namespace talus
