#pragma once
/// [[stage]]: what happens one after another. Keys that all stages have, and the list of kinds: one name to add one.
/// What they do: simulation/stages.
#include <algorithm>
#include <array>
#include <concepts>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/units.h"
#include "scene/required.h"
#include "scene/stages/consolidation.h"
#include "scene/stages/dynamic.h"
#include "scene/stages/factor_of_safety.h"
#include "scene/stages/quasi_static.h"
#include "scene/stages/seepage.h"

namespace talus {

using StageKinds = std::variant<DynamicKeys, QuasiStaticKeys, SeepageKeys, ConsolidationKeys, FactorKeys>;

struct Stage {
  std::string name;
  StageKinds kind;
  double duration = required;  ///< longest duration [s]
  bool pore_flow = true;       ///< pore fluids move; false: pore pressures are those of [water], as in a drained
                               ///< scene
  bool softening = true;       ///< soil remembers plastic strain; false: it keeps the strength it has
  bool hold_loads = false;     ///< functions of time stand still: their t counts only stages that do not hold loads
  bool reset_displacement = false;  ///< displacements, velocities and plastic strain are zeroed when the stage ends
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("name", name, "name of the stage in logs and results; default: its number, from 0");
    v.one_of("kind", kind,
             "motion by the material point method, or by finite elements: static equilibrium, flow of pore water "
             "through soil at rest, or consolidation (both in time), or the factor of safety");
    if (finds_factor()) {
      duration = 0, hold_loads = true;
      return;
    }
    v.number("duration", duration, second, Range{0, 1e12, is_static() ? Usual{} : Usual{0, 86400}},
             "longest duration of the stage. Motion takes steps shorter than a wave through a cell, and slides take "
             "seconds to minutes: what goes on for days belongs to stages of another kind");
    v.flag(
        "pore_flow", pore_flow,
        "pore fluids move; if false, pore pressures are those of [water], scaled by the ramp, as for initial stress");
    v.flag(
        "softening", softening,
        "plastic strain is recorded and softens the soil; if false, strength does not change, as for initial stress; "
        "dilation is recorded in any case");
    v.flag("hold_loads", hold_loads,
           "functions of time stand still: their t advances only in stages with hold_loads = false");
    v.flag("reset_displacement", reset_displacement,
           "set displacement, velocity and plastic strain to zero at the end of the stage");
  }

  StageTraits traits() const {
    return std::visit([](const auto &one) { return one.traits; }, kind);
  }
  bool is_static() const { return traits().finite_elements; }
  bool water_flows() const { return traits().water_flows; }
  bool soil_moves() const { return traits().soil_moves; }
  bool finds_factor() const { return traits().finds_factor; }
  /// Does pore water flow through soil at rest?
  bool seeps() const { return water_flows() && !soil_moves(); }
  /// Does soil come to rest by finite elements?
  bool settles_soil() const { return is_static() && soil_moves(); }
  StopTraits stop() const { return motion() ? motion()->stop() : StopTraits{}; }

  // Keys of some kinds; null, zero or none where the kind has none.

  const DynamicKeys *motion() const { return std::get_if<DynamicKeys>(&kind); }
  const StaticKeys *finite_elements() const { return keys<StaticKeys>(); }
  double gravity_ramp() const { return motion() ? motion()->gravity_ramp : 0; }
  bool shakes() const { return motion() && motion()->earthquake; }
  double damping() const { return motion() ? motion()->damping : 0; }
  /// Of Rayleigh damping [Hz]; 0: there is none.
  std::array<double, 2> damping_frequencies() const {
    if (!motion() || motion()->damping_frequencies.empty()) return {};
    return {motion()->damping_frequencies[0], motion()->damping_frequencies[1]};
  }
  bool begins_at_rest() const { return finite_elements() && finite_elements()->initial_stress == InitialStress::k0; }
  bool adds(const std::string &body) const {
    return finite_elements() && std::ranges::count(finite_elements()->add, body) > 0;
  }
  bool removes(const std::string &body) const {
    return finite_elements() && std::ranges::count(finite_elements()->remove, body) > 0;
  }
  /// Pseudo-static inertia over weight, by axis; empty: none.
  const std::vector<double> &seismic_coefficient() const {
    static const std::vector<double> none;
    const auto *seismic = keys<SeismicKeys>();
    return seismic ? seismic->seismic_coefficient : none;
  }

 private:
  template <class Keys>
  const Keys *keys() const {
    return std::visit(
        [](const auto &one) -> const Keys * {
          if constexpr (std::derived_from<std::decay_t<decltype(one)>, Keys>) return &one;
          return nullptr;
        },
        kind);
  }
};

}  // namespace talus
