#pragma once
/// The interface of the time loop: one step of any integrator over any motion.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/archive.h"
#include "base/units.h"
#include "physics/motion.h"

namespace talus {

/// What bounds a step from outside.
struct StepBounds {
  double critical;  ///< 2 / omega_max of the present state [s]
  double until;     ///< time at which some step must end [s]
};

/// What omega_max is taken from.
enum class FrequencyBound {
  automatic,  ///< one of the others, which the scene decides (src/simulation/step_bound.h)
  cells,      ///< the fastest filled cell by itself: safe
  mesh        ///< the filled mesh, by power iteration: sharp, and from below
};

/// What a scene fixes about steps, in units of the critical step 2 / omega_max where it is not a time.
struct StepRule {
  double fixed;  ///< [s]; 0: chosen as the run goes
  double share;  ///< largest step that is taken [-]
  double limit;  ///< largest step at which elastic motion does not grow [-]
  FrequencyBound bound = FrequencyBound::cells;
};

/// The key `omega_max`, by which a scene chooses the bound.
template <class Visitor>
void frequency_bound(Visitor &&v, FrequencyBound &bound) {
  v.choice(
      "omega_max", bound,
      {{"auto", FrequencyBound::automatic}, {"cells", FrequencyBound::cells}, {"mesh", FrequencyBound::mesh}},
      "largest frequency: that of the fastest filled cell alone (cells), or that of the whole filled mesh by power "
      "iteration at remaps (mesh), which allows longer steps, above all on tetrahedra; auto is mesh in dry and drained "
      "3D scenes, and cells in plane strain and slices, where pore fluids move, beside a fixed step, with a fraction "
      "above 0.8, with the laws cam_clay and umat, and where softening is brittle");
}

/// The keys `step` and `fraction` of [integrator], which every kind has.
struct StepKeys {
  double step = 0;  ///< fixed step [s]; 0: chosen as the run goes
  double fraction;  ///< largest step over the limit of the kind [-]
  explicit StepKeys(double by_default) : fraction(by_default) {}

 protected:
  template <class Visitor>
  void step_fields(Visitor &&v, const char *step_meaning, const char *fraction_meaning) {
    v.number("step", step, second, Range{0, 1e9}, step_meaning);
    v.number("fraction", fraction, one, Range{0.001, 1, {0.1, 0.95}}, fraction_meaning);
  }
};

/// Sums since the start of a run.
struct StepStatistics {
  long long steps = 0, evaluations = 0;  ///< evaluations of the forces
  long long rejections = 0;              ///< attempts that failed the error test
  long long inversions = 0;              ///< attempts that failed because a stage turned a cell inside out
  long long by_error = 0, by_stability = 0,
            by_schedule = 0;  ///< steps by what bounded them: error, stability or given step, an output
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;  ///< [s]
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  /// Takes one step from t and says how long it was [s]; it does not pass `bounds.until`.
  virtual PetscErrorCode advance(Motion &motion, double t, const StepBounds &bounds, double *taken) = 0;
  /// To be called when nodes or loads have changed since the last step: after a remap, between stages.
  virtual void restart() {}
  /// Saves or loads what the next step depends on beside the motion, such as an adapted step size.
  virtual void serialize(Archive &archive) { archive.serialize("integrator", statistics_); }
  /// Why no further step is possible, the same on all ranks; empty while one is.
  virtual std::string obstacle() const { return ""; }
  /// Component of the velocity on this rank whose error is the obstacle, -1: it is on another rank.
  virtual int obstructing_component() const { return -1; }

  const StepStatistics &statistics() const { return statistics_; }

 protected:
  enum class Bound { error, stability, schedule };
  /// What bounded a step that no error bounded, with `left` to go at its start.
  static Bound bounded_by(double left, double step) { return left > 2 * step ? Bound::stability : Bound::schedule; }
  /// Length of a step that no error bounds [s].
  static double step_length(const StepRule &rule, double t, const StepBounds &bounds);
  void count(double step, Bound bound) {
    ++statistics_.steps;
    ++(bound == Bound::error       ? statistics_.by_error
       : bound == Bound::stability ? statistics_.by_stability
                                   : statistics_.by_schedule);
    statistics_.shortest = std::min(statistics_.shortest, step),
    statistics_.longest = std::max(statistics_.longest, step);
  }
  StepStatistics statistics_;
};

/// A little less than `step`, so that the last of equal steps ends at `left`; a fixed step is only cut at the end.
inline double even_step(double step, double left, bool fixed) {
  const double count = std::ceil(left / step * (1 - 1e-9));
  if ((fixed && count > 1) || count > 1e6) return step;
  return left / std::max(1., count);
}

inline double Integrator::step_length(const StepRule &rule, double t, const StepBounds &bounds) {
  const bool fixed = rule.fixed > 0;
  return even_step(fixed ? rule.fixed : rule.share * bounds.critical, bounds.until - t, fixed);
}

}  // namespace talus
