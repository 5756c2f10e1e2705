#pragma once
/// Strength of soil whose pore water does not flow while it fails, docs/theory/finite_elements.md section 5.2.
#include "solvers/quasi_static/strength_reduction.h"
#include "solvers/quasi_static/trial_strength.h"

namespace talus {

/// Strength of the Gauss points of a body of this law, as trials divide it: c = s_u and phi = 0, and the soil's own c
/// and phi where `drains(point)`, with psi = phi. None where the law has no such strength.
template <int dim>
std::vector<FrictionalPoint> undrained_strength(const GaussPoints<dim> &points, const Law &law,
                                                const std::function<bool(int)> &drains);
/// That of each body whose full pores do not drain. `laws` are those of the bodies.
template <int dim>
std::vector<std::vector<FrictionalPoint>> undrained_strength(const SoilElements<dim> &soil, const PoreFlow<dim> &flow,
                                                             const std::vector<Law> &laws);

/// Gives the points of a body a strength with psi = phi in place of that of their law.
template <int dim>
void put_strength(const std::vector<FrictionalPoint> &strength, GaussPoints<dim> &points);

/// Says in `outcome` whether soil in its present state whose pore water does not flow fails under the loads of
/// `load_time`. The problem keeps its state. Supports must not move. Collective.
template <int dim>
PetscErrorCode find_undrained_failure(QuasiStatic<dim> &problem, PoreFlow<dim> &flow, const std::vector<Law> &laws,
                                      double load_time, double time, StepOutcome *outcome);

}  // namespace talus
