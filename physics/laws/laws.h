#pragma once
/// The list of soil laws: one word to add one. What a law states of itself: soil_law.h. Who asks a law for what all
/// laws answer includes law.h.
#include <utility>
#include <variant>

#include "physics/laws/bingham.h"
#include "physics/laws/cam_clay.h"
#include "physics/laws/drucker_prager.h"
#include "physics/laws/hencky.h"
#include "physics/laws/hoek_brown.h"
#include "physics/laws/hysteretic.h"
#include "physics/laws/law.h"
#include "physics/laws/linear_elastic.h"
#include "physics/laws/mohr_coulomb.h"
#include "physics/laws/mu_i.h"
#include "physics/laws/newtonian.h"
#include "physics/laws/soil_law.h"
#include "physics/laws/umat.h"

namespace talus {

template <SoilLaw... OneLaw>
using ListOfLaws = std::variant<OneLaw...>;
using Laws = ListOfLaws<LinearElastic, MohrCoulomb, DruckerPrager, CamClay, MuI, Newtonian, Bingham, HenckyElastic,
                        HenckyMohrCoulomb, HenckyDruckerPrager, HystereticMohrCoulomb, HoekBrown, Umat>;

struct Law::Kind {
  Laws law;
  bool holds_water = false;
  double pore_stiffness = 0;  ///< [Pa]
};

template <class OneLaw>
requires(!std::same_as<OneLaw, Law>) Law::Law(OneLaw law) : kind_(std::make_shared<const Kind>(Kind{std::move(law)})) {}

template <class Use>
decltype(auto) Law::visit(Use &&use) const {
  return std::visit(std::forward<Use>(use), kind_->law);
}

template <class OneLaw>
const OneLaw *Law::as() const {
  return std::get_if<OneLaw>(&kind_->law);
}

/// The law after change(law), which is called if it has cohesion and friction.
template <class Change>
Law with_changed_strength(const Law &law, const Change &change) {
  return law
      .visit([&](auto one) -> Law {
        if constexpr (FrictionalLaw<decltype(one)>) change(one);
        return one;
      })
      .drained_as(law);
}

}  // namespace talus
