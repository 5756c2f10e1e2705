#pragma once
/// What the solves for implicit pore pressure have done since the start of a run.
namespace talus {

struct PressureSolves {
  long long steps = 0, iterations = 0, most_iterations = 0;  ///< most in a step
  long long unsolved = 0;  ///< steps that end although pressures lack more than is allowed
  double worst = 0;        ///< the largest share of the pressure that one of them lacks
};

}  // namespace talus
