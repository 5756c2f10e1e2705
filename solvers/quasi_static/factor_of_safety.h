#pragma once
/// Result of a strength reduction.
#include <string>
#include <vector>

namespace talus {

/// One trial: strength divided by `factor`.
struct StrengthTrial {
  double factor;
  bool stable;          ///< equilibrium was found
  int iterations;       ///< of Newton, over the load steps of the trial
  double residual;      ///< out-of-balance force over the size of the forces where the trial ended [-]
  double displacement;  ///< largest displacement of a node since strength was first changed [m]
  std::string reason;   ///< why it counts as failure; empty if stable
};

/// Strength divided by `lower` has an equilibrium, divided by `upper` it has none.
struct FactorOfSafety {
  double lower = 0, upper = 0;
  std::vector<StrengthTrial> trials;
  double value() const { return (lower + upper) / 2; }
};

}  // namespace talus
