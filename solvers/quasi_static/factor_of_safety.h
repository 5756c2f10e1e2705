#pragma once
/// Result of a strength reduction, docs/theory/finite_elements.md section 5.
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace talus {

/// What soil does whose strength was divided by the factor of a trial.
enum class TrialOutcome {
  equilibrium,  ///< it carries its loads
  mechanism,    ///< it moves without bound under its loads
  undecided     ///< the iterations found neither
};
inline const char *name_of(TrialOutcome outcome) {
  switch (outcome) {
    case TrialOutcome::equilibrium:
      return "equilibrium";
    case TrialOutcome::mechanism:
      return "mechanism";
    case TrialOutcome::undecided:
      return "undecided";
  }
  return "";
}

/// One trial: strength divided by `factor`.
struct StrengthTrial {
  int search = 1;  ///< 1: for the critical mechanism; then one for each time that soil was held at its strength
  double factor = 0;
  TrialOutcome outcome = TrialOutcome::undecided;
  bool dilating = false;    ///< with psi = phi, for the upper end of the spread; else with the soil's own psi
  int iterations = 0;       ///< linear systems that were solved
  double residual = 0;      ///< out-of-balance force over the size of the forces where the trial ended [-]
  double displacement = 0;  ///< largest displacement of a node since strength was first changed [m]
  double surplus = 0;       ///< of a mechanism: share of the work of the loads that the soil does not take up [-]
  double wall_seconds = 0;
  /// Largest displacement [m] and out-of-balance force [-] after each iteration.
  std::vector<std::pair<double, double>> curve;
};

/// Strength divided by `lower` has an equilibrium, divided by `upper` a mechanism. `decided` is false if trials between
/// the two were undecided, so that the bracket is wider than was asked for.
struct FactorBracket {
  double lower = 0, upper = 0;
  bool decided = true;
  double value() const { return (lower + upper) / 2; }
  /// Is it so wide that it says nothing of the factor?
  bool failed() const { return !decided && upper > widest * lower; }

  static constexpr double widest = 1.1;
};

/// A motion by which soil fails, and the factor of safety at which it does.
struct Mechanism : FactorBracket {
  FactorBracket dilating;               ///< of the same soil with psi = phi, if FactorOfSafety::davis
  double moving_volume = 0;             ///< of the soil that moves [m3], in 2D per metre of thickness
  std::array<double, 3> low{}, high{};  ///< corners of the box around it [m]
  double of_critical = 1;               ///< share of the soil of the critical mechanism that it moves too [-]
  std::vector<std::array<double, 2>> slip_surface;  ///< 2D: where it shears most, along x [m]
};

/// The critical mechanism, with the least factor, and those that were searched for besides.
struct FactorOfSafety : Mechanism {
  bool davis = false;                    ///< some soil has psi < phi: its strength is that of Davis (1968)
  std::vector<Mechanism> further;        ///< with larger factors, in the order in which they were found
  std::vector<std::string> lost_stages;  ///< stages before it that found no equilibrium
  std::vector<StrengthTrial> trials;
};

}  // namespace talus
