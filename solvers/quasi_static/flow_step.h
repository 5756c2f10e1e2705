#pragma once
/// Implicit steps of pore water in soil: seepage through soil at rest, or consolidation, in which the soil's
/// equilibrium and the balance of its water are solved together (u-p: displacement of second order, pressure of first),
/// docs/theory/seepage.md.
#include "solvers/quasi_static/linear_system.h"
#include "solvers/quasi_static/pore_flow.h"
#include "solvers/quasi_static/quasi_static.h"

namespace talus {

struct QuasiStaticSource;

template <int dim>
class FlowStep {
 public:
  /// Without `soil` it is at rest. Both must be active and outlive the steps.
  FlowStep(QuasiStatic<dim> *soil, PoreFlow<dim> &flow, const QuasiStaticSource &settings, bool steady)
      : soil_(soil), flow_(flow), settings_(settings), steady_(steady) {}
  PetscErrorCode setup();
  /// Solves for the state a step dt later, which begins `begin` [s] after the stage, at the loads of `load_time`;
  /// prescribed motion acts over (load_time - travel, load_time). What it found is a trial state until `commit`.
  /// Collective.
  PetscErrorCode solve(double load_time, double travel, double begin, double dt, StepOutcome *outcome);
  PetscErrorCode commit(bool softening);
  /// Shortest time in which pressure crosses a cell of consolidating soil: shorter first steps overshoot beside drained
  /// faces (Vermeer & Verruijt 1981) [s]. Collective.
  double shortest_step() const;

 private:
  double storage(int body) const;
  PetscErrorCode residual(::Vec x, ::Vec f);
  PetscErrorCode jacobian(Mat matrix);
  PetscErrorCode couple();
  PetscErrorCode volume_strain(std::vector<double> &taken, std::vector<double> &size) const;
  template <class Put>
  void each_coupling(Put &&put) const;
  static PetscErrorCode snes_function(SNES, ::Vec, ::Vec, void *);
  static PetscErrorCode snes_jacobian(SNES, ::Vec, Mat, Mat, void *);
  static PetscErrorCode snes_converged(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason *, void *);
  PetscErrorCode make_solver();
  PetscErrorCode seek(StepOutcome *outcome);

  QuasiStatic<dim> *soil_;
  PoreFlow<dim> &flow_;
  const QuasiStaticSource &settings_;
  PetscInt rows_u_ = 0, rows_p_ = 0;
  Vector x_, f_, u_, force_, p_, water_;
  SparseMatrix flow_matrix_, press_, squeeze_;
  Matrix blocks_, matrix_;
  NonlinearSolver solver_;
  std::vector<double> rest_;     ///< water balance of the last residual, of local nodes [m3]
  std::vector<double> size_;     ///< sizes of its terms, of steady flow [m3]
  bool steady_;                  ///< each node is in balance by its own terms: those of dry soil are small
  std::vector<PetscInt> owned_;  ///< local pressure nodes in the order of their rows
  double load_time_ = 0, dt_ = 0;
  double water_scale_ = 0;  ///< size of the terms of the balance of water before the first iteration [m3]
  double water_moved_ = 0;  ///< that of the last evaluation [m3]
  bool scale_open_ = true;
  bool balanced_ = false;         ///< the last iterate, as for equilibrium alone
  bool nearly_balanced_ = false;  ///< to `stalled` times the tolerance
  bool newton_ = true;            ///< else Picard's method, which takes more iterations
  static constexpr int picard_iterations = 4;
  static constexpr double stalled = 100;
};

}  // namespace talus
