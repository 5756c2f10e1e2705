#pragma once
/// Explicit Runge-Kutta methods of PETSc's TS on the nodal state (u, v), without error control: steps follow the
/// stability limit or are fixed. A third family beside `euler` and `arkode`, up to order 8, docs/theory/integrators.md,
/// section 2. Vectors are as long as the mesh allows.
#include <petscts.h>

#include <memory>
#include <string>

#include "solvers/integrator.h"

namespace talus {

enum class RungeKutta { rk3, rk4, rk5, rk8 };

/// Keys of [integrator] with kind = "petsc".
struct PetscTsSettings : StepKeys {
  static constexpr const char *name = "petsc";
  RungeKutta method = RungeKutta::rk4;
  PetscTsSettings() : StepKeys(0.8) {}
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice("method", method,
             {{"rk3", RungeKutta::rk3}, {"rk4", RungeKutta::rk4}, {"rk5", RungeKutta::rk5}, {"rk8", RungeKutta::rk8}},
             "explicit Runge-Kutta method of PETSc: by Kutta (orders 3 and 4), Bogacki and Shampine (order 5), Verner "
             "(order 8)");
    step_fields(v, "fixed time step; 0: a fraction of the stability limit of the method",
                "ratio of the time step to the stability limit of the method: 1.73, 2.83, 1.66, 2.59 over omega_max");
  }
  StepRule rule() const;
  std::string drag_problem() const { return "takes no drag implicitly"; }
  std::unique_ptr<Integrator> make() const;
};

class PetscTs final : public Integrator {
 public:
  explicit PetscTs(const PetscTsSettings &settings);
  ~PetscTs() override;
  PetscErrorCode advance(Motion &motion, double t, const StepBounds &bounds, double *taken) override;

 private:
  struct Memory;
  PetscTsSettings settings_;
  std::unique_ptr<Memory> memory_;
};

}  // namespace talus
