#pragma once
/// The paper's explicit Euler with the velocity updated first and strain from velocities mapped back from the particles
/// (MUSL), docs/theory (5.1)-(5.4). Alonso, Yerro & Pinyol (2015), sec. 2.2; Sulsky, Zhou & Schreyer (1995).
#include <memory>
#include <vector>

#include "base/units.h"
#include "solvers/integrator.h"

namespace talus {

/// Keys of [integrator] with kind = "euler".
struct EulerSettings {
  static constexpr const char *name = "euler";
  double step = 0;        ///< fixed step [s]; 0: a fraction of the critical step
  double fraction = 0.6;  ///< of the critical step 2 / omega_max [-]
  double limit = 1;       ///< fixed step over the critical one beyond which no run starts [-]
  FrequencyBound bound = FrequencyBound::cells;
  StepRule rule() const { return {step, fraction, limit, bound}; }
  std::string drag_problem() const { return ""; }  ///< implicit in every step
  std::unique_ptr<Integrator> make() const;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("step", step, second, Range{0, 1e9}, "fixed time step; 0: a fraction of the critical step");
    v.number("fraction", fraction, one, Range{0.001, 1},
             "ratio of the time step to the critical step 2 / omega_max, which is recomputed during the run");
    v.number(
        "limit", limit, one, Range{1, 1e12},
        "largest allowed ratio of a fixed step to the critical step; values above 1 are for studies of instability");
    frequency_bound(v, bound);
  }
};

class Euler final : public Integrator {
 public:
  explicit Euler(const EulerSettings &settings) : settings_(settings) {}
  PetscErrorCode advance(Motion &motion, double t, const StepBounds &bounds, double *taken) override;

 private:
  EulerSettings settings_;
  std::vector<double> acceleration_, mapped_;
};

}  // namespace talus
