#include "physics/laws/present_strength.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/laws/laws.h"
#include "physics/laws/principal.h"

namespace talus {
namespace {

constexpr double at_yield = 0.99;    // of the strength
constexpr double near_apex = 1e-5;   // of stress and c cot(phi): closer to the apex the angle is one of round-off
constexpr double round_off = 1e-9;   // of the stiffness: less is no stress
constexpr double almost_all = 0.95;  // of the fall from peak to residual strength that is still to come

}  // namespace

PresentStrength::PresentStrength(const Law &law)
    : law_(with_changed_strength(law, [](auto &one) { one.prepare(); })),
      known_(frictional_strength(law) || law.as<HoekBrown>()) {}

template <int dim>
Mobilised PresentStrength::operator()(const Stress<dim> &stress, double plastic_strain,
                                      const Surroundings &around) const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return law_.visit([&](const auto &one) -> Mobilised {
    if constexpr (FrictionalLaw<std::decay_t<decltype(one)>>) {
      const auto now = one.present(plastic_strain, around);
      const Principal<double> s = PrincipalAxes<dim, double>(stress).values();
      const double apex = 2 * now.c / std::tan(now.phi), depth = apex - (s.s1 + s.s3), circle = s.s1 - s.s3;
      const double scale = apex + std::abs(s.s1) + std::abs(s.s3);
      const double none = round_off * one.shear_modulus();
      double angle = std::asin(std::clamp(circle / depth, 0., 1.));
      if (now.phi <= 0)
        angle = nan;
      else if (scale <= none)
        angle = 0;
      else if (depth <= near_apex * scale)
        angle = now.phi;  // the apex itself
      const double left = one.share_left(plastic_strain, around);
      const bool softens = one.softens();
      if (softens && left <= 1 - almost_all) return {angle, StrengthState::residual};
      if (softens && left < almost_all) return {angle, StrengthState::softening};
      const bool yields = scale > none && one.share_of_strength(stress, plastic_strain, around) >= at_yield;
      return {angle, yields ? StrengthState::peak : StrengthState::elastic};
    } else if constexpr (std::same_as<std::decay_t<decltype(one)>, HoekBrown>) {
      HoekBrown rock = one;
      rock.prepare();
      const double share = rock.share_of_strength(stress, plastic_strain, around);
      return {nan, share >= at_yield ? StrengthState::peak : StrengthState::elastic};
    } else {
      return {nan, StrengthState::elastic};
    }
  });
}

template Mobilised PresentStrength::operator()<2>(const Stress<2> &, double, const Surroundings &) const;
template Mobilised PresentStrength::operator()<3>(const Stress<3> &, double, const Surroundings &) const;

}  // namespace talus
