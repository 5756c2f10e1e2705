#pragma once
/// The phase models as compile-time traits (docs/theory, section 1): what a scene does not model costs neither memory
/// nor time.
#include <type_traits>

namespace talus {

// pressure: pore pressure acts on the total stress; prescribed: that pressure is a function of place and time;
// liquid, gas: the fluid moves on its own; suction: the saturation may be below 1
struct Dry {
  static constexpr const char *name = "dry";
  static constexpr bool pressure = false, prescribed = false, liquid = false, gas = false, suction = false;
};
struct Drained {
  static constexpr const char *name = "drained";
  static constexpr bool pressure = true, prescribed = true, liquid = false, gas = false, suction = false;
};
struct Saturated {
  static constexpr const char *name = "saturated";
  static constexpr bool pressure = true, prescribed = false, liquid = true, gas = false, suction = false;
};
struct Unsaturated {  // gas at rest at atmospheric pressure
  static constexpr const char *name = "unsaturated";
  static constexpr bool pressure = true, prescribed = false, liquid = true, gas = false, suction = true;
};
struct ThreePhase {
  static constexpr const char *name = "three-phase";
  static constexpr bool pressure = true, prescribed = false, liquid = true, gas = true, suction = true;
};
/// Velocity fields at the nodes: of the solid and of the fluids that move on their own.
template <class Phases>
inline constexpr int velocity_fields = 1 + Phases::liquid + Phases::gas;

/// The same traits as values, for code that is compiled once for all phase models.
struct PhaseTraits {
  const char *name;
  bool pressure, prescribed, liquid, gas, suction;
  int fluids() const { return liquid + gas; }  ///< that move on their own
};
template <class Phases>
inline constexpr PhaseTraits traits_of = {Phases::name,   Phases::pressure, Phases::prescribed,
                                          Phases::liquid, Phases::gas,      Phases::suction};

template <class State>
struct Absent {  // a distinct empty type per state, so it costs no bytes
  template <class... Arguments>
  explicit constexpr Absent(Arguments &&...) {}
};
template <bool present, class State>
using If = std::conditional_t<present, State, Absent<State>>;

}  // namespace talus
