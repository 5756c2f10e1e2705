#pragma once
/// Steps of seepage and consolidation in time, docs/theory/seepage.md section 3: implicit Euler, each step as long as
/// its error allows.
#include <functional>
#include <vector>

#include "solvers/quasi_static/flow_step.h"

namespace talus {

struct QuasiStaticSource;

/// What a path of flow is to do.
struct FlowPath {
  double duration;                              ///< [s]
  bool steady;                                  ///< the flow that the loads at the end keep up
  int load_steps;                               ///< at least so many
  bool softening;                               ///< soil remembers plastic strain
  std::function<double(double share)> load_at;  ///< load time at a share of the path [s]
  std::function<void(double share)> done;       ///< told after each step
  std::vector<double> events;                   ///< shares at which steps end, ascending: there loads change
  /// Says whether soil in the present state whose pore water does not flow fails under the loads at a share; empty for
  /// soil at rest.
  std::function<PetscErrorCode(double share, StepOutcome *)> find_failure;
};

/// Carries the flow, and with it the equilibrium of `soil` unless it is null (soil at rest), from share 0 towards 1.
/// Returns the outcome of the last step and, in `share`, how far it came. Steps that become short without need ask
/// whether the soil fails, seepage.md section 3. Collective over `comm`.
template <int dim>
PetscErrorCode follow_flow(MPI_Comm comm, QuasiStatic<dim> *soil, PoreFlow<dim> &flow,
                           const QuasiStaticSource &settings, const FlowPath &path, double *share, StepOutcome *outcome,
                           int *iterations);

}  // namespace talus
