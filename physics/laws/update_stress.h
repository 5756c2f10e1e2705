#pragma once
/// The stress update of a set of points that share one law: co-rotation, elastic trial and return map, in blocks of
/// `lanes` points so that the compiler vectorises it. Compiled once per (law, dimension); one visit of the variant per
/// body and call.
#include "physics/laws/law.h"
#include "physics/laws/stress.h"

namespace talus {

/// `count` points (particles, or one per cell and body). Input and output may be the same arrays.
template <int dim>
struct StressPoints {
  int count;
  const double *stress_in;           ///< [count][stress_size<dim>] accepted stress
  const double *history_in;          ///< [count][history_size(law)] accepted history
  double *stress_out, *history_out;  ///< the same shapes
  const int *cell;                   ///< [count] index into `increment` and `size`
  const Increment<dim> *increment;   ///< per filled cell
  const double *size;                ///< per filled cell, Surroundings::size
  const double *suction = nullptr;   ///< [count] Surroundings::suction; null where there is none
  const double *cohesion_share = nullptr, *friction_share = nullptr;  ///< [count] Surroundings' shares; null: 1
  /// [count] by which the law sees more of its internal variable `averaged` than a point has, which gains what the law
  /// adds; null: the law sees the point's own.
  const double *excess = nullptr;
  int averaged = 0;
  double time_step = 0;  ///< Surroundings::time_step
  double time = 0;       ///< at the start of the step [s]; only a UMAT reads it
};

template <int dim>
void update_stress(const Law &law, const StressPoints<dim> &points);

/// The same update, and its consistent tangent: `tangent` [count][stress_size<dim>][stress_size<dim>] gets
/// d stress_out[i] / d strain[j], row-major, at fixed rotation, history_in, surroundings and time step [Pa]. Components
/// are those of the tensors in stored order, and a shear strain stands for the two equal components of its tensor: the
/// derivative along xy is that along (e_x e_y + e_y e_x), which is twice what an engineering shear strain would give.
/// Exact to round-off for the algorithm that `update_stress` runs, softening included; on a boundary between two
/// branches of the law, of the one that is taken. Not for the particle loop: some microseconds a point.
template <int dim>
void update_stress_with_tangent(const Law &law, const StressPoints<dim> &points, double *tangent);

/// Return map only (zero strain, no rotation): brings averaged stresses back to the yield surface of their own history.
template <int dim>
void admit_stress(const Law &law, const StressPoints<dim> &points);

}  // namespace talus
