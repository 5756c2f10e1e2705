#pragma once
/// What the time loop and the solvers ask of a kind of stage and of a stop criterion, not for one by its name.

namespace talus {

struct StageTraits {
  bool finite_elements = false;  ///< solved by them; otherwise particles move
  bool water_flows = false;      ///< pore water flows in it by finite elements
  bool soil_moves = true;        ///< otherwise the soil is at rest, and only its water moves
  bool finds_factor = false;     ///< it only judges the state of the stage before it, and has no duration
  const char *end = "";          ///< what it ends with, in words; empty: with its stop criterion
};

struct StopTraits {
  bool early = false;            ///< it may end the stage before its duration
  bool waits_for_loads = false;  ///< it does not while loads have still to change
  bool settles = false;          ///< it brings the soil to rest, so that damping does no harm
  bool by_mean_speed = false;    ///< it looks at the mean speed of all soil, of which a part may still slide
};

}  // namespace talus
