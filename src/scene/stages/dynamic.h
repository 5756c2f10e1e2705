#pragma once
/// Motion by the material point method.
#include "base/units.h"
#include "scene/stages/seismic.h"
#include "scene/stages/traits.h"
#include "scene/stops/stops.h"

namespace talus {

struct DynamicKeys : SeismicKeys {
  static constexpr const char *name = "dynamic", *meaning = "motion by the material point method";
  static constexpr StageTraits traits{};

  StopKinds until;
  double damping = 0;                       ///< local (Cundall) damping factor alpha [-]
  std::vector<double> damping_frequencies;  ///< of Rayleigh damping, lower and upper [Hz]; empty: none
  double gravity_ramp = 0;                  ///< gravity and pore pressure grow linearly over this time [s]
  bool earthquake = false;                  ///< the ground moves as [[earthquake]] says, from the begin of the stage

  StopTraits stop() const {
    return std::visit([](const auto &kind) { return kind.traits; }, until);
  }
  /// Is the soil brought to rest, so that damping does no harm?
  bool settles() const { return stop().settles || gravity_ramp > 0; }
  template <class Visitor>
  void fields(Visitor &&v) {
    v.one_of("until", until, "criterion that ends the stage before its duration");
    v.number("gravity_ramp", gravity_ramp, second, Range{0, 1e9},
             "time in which gravity and pore pressure increase linearly from 0");
    v.number("damping", damping, one, Range{0, 0.99, settles() ? Usual{0, 0.8} : Usual{0, 0.1}},
             "local (Cundall) damping factor; soil that slides is slowed by it, soil that settles (until = "
             "\"equilibrium\" or a gravity_ramp) comes to rest fastest with 0.7");
    v.point("damping_frequencies", damping_frequencies, hertz,
            "Rayleigh damping: the two frequencies at which soil has the damping_ratio of its body, such as [1, 8]: "
            "the lowest of the ground and a higher one that the motion still has; between them the ratio is less, "
            "beyond them more. Shortens the step");
    SeismicKeys::fields(v);
    v.flag("earthquake", earthquake,
           "the ground moves as [[earthquake]] says, from the begin of the stage on: as a wave where a boundary has "
           "incoming_wave = true, else with the whole base, and displacements are then relative to it");
  }
};

}  // namespace talus
