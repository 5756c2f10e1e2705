// Pore pressure implicit in time; theory of pores, section 8; included only where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"

namespace talus {

/// Strain of the pores in a step gamma that ends at t, from velocities before drag [field][node]. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::find_strain_of_step(double t, double gamma,
                                                            const Vec<dim> *velocity) requires Phases::liquid {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count();
  Vec<dim> *solid = implicit_.after_drag.data(), *fluid = solid + nodes, *mapped = implicit_.mapped.data();
  std::copy_n(velocity, nodes * fields, solid);
  auto frame = pore_frame(t, accepted_);
  frame.trial = true;
  fluid_.apply_drag_to_solid(gamma, frame, pore_conditions_, solid, fluid);
  conditions_.constrain(loading.time_at(t), grid_, solid, true);
  fluid_.apply_drag_to_fluids(gamma, frame, pore_conditions_, solid, fluid);
  PetscCall(map_change(gamma, solid, mapped));
  constrain(t, mapped);
  for (int i = 0; i < nodes * fields; ++i)
    for (double &x : mapped[i]) x *= gamma;
  PetscCall(fluid_.find_pore_strain(frame, pore_conditions_, mapped, implicit_));
  PetscFunctionReturn(0);
}

/// Adds to velocities before drag, [field][node], the impulse of the change of pore pressure in the step, so that the
/// pressures at its end act. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::add_implicit_pressure(double t, double gamma,
                                                              Vec<dim> *velocity) requires Phases::liquid {
  PetscFunctionBeginUser;
  constexpr double tolerance = 1e-2;  // of the pressure that acts
  constexpr double reduction = 0.1;   // of what is lacking at first: water at rest comes to rest
  constexpr double least = 1e-12;     // of the stiffness of the water
  constexpr int most_rounds = 12, most_turns = 6, most_iterations = 500;
  const int nodes = grid_.node_count();
  ImplicitPressure<dim> &of = implicit_;
  const Shape<dim> *shape = accepted_.shape;
  const double *weight = accepted_.weight.data();
  auto frame = pore_frame(t, accepted_);
  frame.trial = true;
  const auto sum = [&](auto &&...term) {  // over the nodes of all ranks
    std::array<double, sizeof...(term)> all{};
    for (int i = 0; i < nodes; ++i)
      if (mesh_.counted[grid_.mesh_node[i]]) {
        size_t k = 0;
        ((all[k++] += term(i)), ...);
      }
    MPI_Allreduce(MPI_IN_PLACE, all.data(), all.size(), MPI_DOUBLE, MPI_SUM, comm());
    return all;
  };
  const auto square = [](double x) { return x * x; };
  PetscCall(fluid_.start_implicit(frame, of));
  std::fill_n(of.held.begin(), nodes, 0.);
  PetscCall(fluid_.find_squeezed(frame, of.acting.data(), of));
  double allowed = 0, at_first = 0;  // volume times the square of what pressures may lack, and of what they lack
  for (int round = 0; round < most_rounds; ++round) {
    double *pressure = of.residual.data();
    for (int turn = 0; turn < most_turns && round > 0; ++turn) {  // piecewise linear
      PetscCall(fluid_.find_squeezed(frame, pressure, of));
      const auto apart = sum([&](int i) { return of.volume[i] * square(pressure[i] - of.acting[i]); });
      if (apart[0] <= 1e-4 * allowed) break;
      for (int i = 0; i < nodes; ++i) of.held[i] += (pressure[i] - of.acting[i]) / of.stiffness[i];
    }
    PetscCall(find_strain_of_step(t, gamma, velocity));
    const auto [lacks, acts, floor] =
        sum([&](int i) { return of.volume[i] * square((of.held[i] - of.strain[i]) * of.stiffness[i]); },
            [&](int i) { return of.volume[i] * square(of.acting[i]); },
            [&](int i) { return of.volume[i] * square(least * of.stiffness[i]); });
    if (round == 0) at_first = lacks;
    allowed = std::max(floor, std::min(square(tolerance) * acts, square(reduction) * at_first));
    if (lacks <= allowed) break;
    if (round == 0) fluid_.find_mobility(frame, pore_conditions_, gamma, of);  // once the gaps are known
    PetscCall(of.find_diagonal(grid_, shape, weight, gamma));
    for (int i = 0; i < nodes; ++i) of.residual[i] = of.volume[i] * (of.held[i] - of.strain[i]);
    const double enough = std::max(0.2 * allowed, 1e-5 * lacks);
    PetscCall(of.gradients.solve(
        nodes, of.diagonal.data(), of.residual.data(), of.correction.data(), most_iterations,
        [&](const double *x, double *y) {
          return of.apply(grid_, conditions_.prescribed(), shape, weight, gamma, x, y);
        },
        [&](const double *a, const double *b) { return sum([&](int i) { return a[i] * b[i]; })[0]; },
        [&](const double *r, const double *z) {
          return sum([&](int i) { return r[i] * z[i]; },
                     [&](int i) { return square(r[i] * of.stiffness[i]) / of.volume[i]; });
        },
        enough));
    for (int i = 0; i < nodes; ++i) of.acting[i] += of.correction[i];
    PetscCall(fluid_.push_by(frame, gamma, of.correction.data(), of, velocity));
  }
  PetscFunctionReturn(0);
}

}  // namespace talus
