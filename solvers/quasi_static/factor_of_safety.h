#pragma once
/// Result of a strength reduction, docs/theory/finite_elements.md section 5.
#include <array>
#include <map>
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

/// How soil flows in a trial, docs/theory/finite_elements.md section 5.
enum class TrialFlow {
  own,    ///< with its own dilation angle, psi < phi
  davis,  ///< psi = phi and the strength of a plane on which it slips with its own psi (Davis 1968): lower estimate
  associated,  ///< psi = phi: upper bound (Radenkovic 1961)
  undrained,   ///< no pore water flows, so that volumes stay: s_u of the stress before, section 5.2
};
inline const char *name_of(TrialFlow flow) {
  switch (flow) {
    case TrialFlow::own:
      return "own";
    case TrialFlow::davis:
      return "davis";
    case TrialFlow::associated:
      return "associated";
    case TrialFlow::undrained:
      return "undrained";
  }
  return "";
}

/// One trial: strength divided by `factor`.
struct StrengthTrial {
  int search = 1;  ///< 1: for the critical mechanism; then one for each time that soil was held at its strength
  double factor = 0;
  TrialOutcome outcome = TrialOutcome::undecided;
  TrialFlow flow = TrialFlow::associated;
  int iterations = 0;       ///< linear systems that were solved
  int steps = 0;            ///< of damped motion, where the iterations stalled
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
  std::map<TrialFlow, FactorBracket> by_flow;  ///< the same soil by each flow that was tried
  double moving_volume = 0;                    ///< of the soil that moves [m3], in 2D per metre of thickness
  std::array<double, 3> low{}, high{};         ///< corners of the box around it [m]
  double of_critical = 1;                      ///< share of the soil of the critical mechanism that it moves too [-]
  std::vector<std::array<double, 2>> slip_surface;  ///< 2D: where it shears most, along x [m]
};

/// The critical mechanism, with the least factor, and those that were searched for besides.
struct FactorOfSafety : Mechanism {
  /// Of the factor itself: `own` where some soil has psi < phi, and `undrained` where pore water moves and the factor
  /// without flow is the lower one.
  TrialFlow flow = TrialFlow::associated;
  /// Of soil with psi < phi that weakens from great strength, where it is less than 1 though the stages found an
  /// equilibrium with psi = phi; else empty.
  FactorBracket weakened;
  std::vector<Mechanism> further;        ///< with larger factors, in the order in which they were found
  std::vector<std::string> lost_stages;  ///< stages before it that found no equilibrium
  std::vector<StrengthTrial> trials;
};

/// The flow of soil that fails while its pore pressure is held.
inline TrialFlow drained_flow(const Mechanism &m) {
  return m.by_flow.contains(TrialFlow::own) ? TrialFlow::own : TrialFlow::associated;
}
/// What is said of the pore water, before the number of a factor; empty where it does not move.
inline std::string about_water(const Mechanism &m, TrialFlow flow) {
  if (!m.by_flow.contains(TrialFlow::undrained)) return "";
  return flow == TrialFlow::undrained ? ", no flow during failure (undrained)"
                                      : ", with the pore pressure of the stage held";
}
/// The flow that the factor is not of, where pore water moves.
inline TrialFlow other_flow(const Mechanism &m, TrialFlow flow) {
  return flow == TrialFlow::undrained ? drained_flow(m) : TrialFlow::undrained;
}

}  // namespace talus
