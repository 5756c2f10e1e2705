#pragma once
/// The stress update of a set of points that share one law: co-rotation, elastic trial and return map, in blocks of
/// `lanes` points so that the compiler vectorises it. Compiled once per (law, dimension); one visit of the variant per
/// body and call.
#include "physics/laws/laws.h"
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
};

template <int dim>
void update_stress(const Law &law, const StressPoints<dim> &points);

/// Return map only (zero strain, no rotation): brings averaged stresses back to the yield surface of their own history.
template <int dim>
void admit_stress(const Law &law, const StressPoints<dim> &points);

}  // namespace talus
