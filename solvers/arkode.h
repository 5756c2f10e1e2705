#pragma once
/// Explicit Runge-Kutta of orders 2 to 5 with embedded error control on the nodal state (u, v), by SUNDIALS ARKODE
/// (Reynolds et al. 2023), docs/theory/integrators.md. Stages evaluate trial states of the accepted history; only a
/// step that passed its error test is accepted. Where phases drag at one another: an implicit-explicit method of order
/// 3 whose implicit part is that drag, solved node by node.
#include <memory>
#include <string>

#include "solvers/integrator.h"

namespace talus {

/// Keys of [integrator] with kind = "arkode".
struct ArkodeSettings : StepKeys {
  static constexpr const char *name = "arkode";
  int order = 3;
  double velocity_tolerance = 1e-3;      ///< of one step [m/s]
  double displacement_tolerance = 1e-5;  ///< of one step [m]
  double floor = 1e-4;                   ///< of the critical step: a run that needs less stops [-]
  FrequencyBound bound = FrequencyBound::automatic;
  bool drag = false;  ///< the motion has drag between phases; not a key
  ArkodeSettings() : StepKeys(0.8) {}
  template <class Visitor>
  void fields(Visitor &&v) {
    v.integer("order", order, Range{2, 5},
              "order of the Runge-Kutta method, 3 where pore fluids move; its embedded method, one order lower, "
              "estimates the error");
    v.number("velocity_tolerance", velocity_tolerance, metre_per_second, Range{1e-12, 1e3, {1e-8, 0.1}},
             "allowed error of the velocity in one step, mass-weighted root mean square");
    v.number("displacement_tolerance", displacement_tolerance, metre, Range{1e-15, 1e3, {1e-10, 1e-2}},
             "allowed error of the displacement in one step, mass-weighted root mean square");
    step_fields(v, "fixed time step without error control; 0: steps by the tolerances",
                "ratio of the largest step to the stability limit of the method: 2, 1.73, 2.83, 1.0 over omega_max for "
                "orders 2 to 5, 1.56 where pore fluids move");
    frequency_bound(v, bound);
    v.number("floor", floor, one, Range{1e-12, 1, {1e-8, 0.1}},
             "smallest ratio of the step to the critical step 2 / omega_max; a run that needs a shorter step ends");
  }
  StepRule rule() const;
  /// What is wrong with these settings where phases drag at one another; empty: nothing.
  std::string drag_problem() const {
    return order == 3 ? "" : "has order = " + std::to_string(order) + ", but only order 3 takes drag implicitly";
  }
  std::unique_ptr<Integrator> make() const;
};

class Arkode final : public Integrator {
 public:
  explicit Arkode(const ArkodeSettings &settings);
  ~Arkode() override;
  PetscErrorCode advance(Motion &motion, double t, const StepBounds &bounds, double *taken) override;
  void restart() override;
  void serialize(Archive &archive) override;
  std::string obstacle() const override;
  int obstructing_component() const override;

 private:
  struct Memory;  // SUNDIALS stays inside arkode.cpp
  ArkodeSettings settings_;
  std::unique_ptr<Memory> memory_;
};

}  // namespace talus
