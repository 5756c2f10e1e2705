#pragma once
/// The paper's explicit Euler with the velocity updated first and strain from velocities mapped back from the particles
/// (MUSL), docs/theory (5.1)-(5.4). Alonso, Yerro & Pinyol (2015), sec. 2.2; Sulsky, Zhou & Schreyer (1995).
#include <memory>
#include <vector>

#include "solvers/integrator.h"

namespace talus {

/// Keys of [integrator] with kind = "euler".
struct EulerSettings : StepKeys {
  static constexpr const char *name = "euler";
  double limit = 1;  ///< fixed step over the critical step beyond which no run starts [-]
  FrequencyBound bound = FrequencyBound::automatic;
  EulerSettings() : StepKeys(0.6) {}
  StepRule rule() const { return {step, fraction, limit, bound}; }
  std::string drag_problem() const { return ""; }  ///< drag is implicit in every step
  std::unique_ptr<Integrator> make() const;
  template <class Visitor>
  void fields(Visitor &&v) {
    step_fields(v, "fixed time step; 0: a fraction of the critical step",
                "ratio of the time step to the critical step 2 / omega_max, which is recomputed during the run");
    v.number(
        "limit", limit, one, Range{1, 1e12, {1, 1}},
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
