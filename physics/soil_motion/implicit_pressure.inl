// Pore pressure implicit in time; theory of pores, section 8; included only where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"

namespace talus {

/// From velocities before drag to those with which the step moves the nodes; `change`: the linear part of it. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::velocity_of_step(double t, double gamma, const Vec<dim> *before_drag,
                                                         bool change) requires Phases::liquid {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count();
  Vec<dim> *solid = implicit_.after_drag.data(), *fluid = solid + nodes, *mapped = implicit_.mapped.data();
  std::copy_n(before_drag, nodes * fields, solid);
  const auto frame = pore_frame(t, accepted_);
  fluid_.apply_drag_to_solid(gamma, frame, pore_conditions_, solid, fluid);
  conditions_.constrain(loading.time_at(t), grid_, solid, true);
  fluid_.apply_drag_to_fluids(gamma, frame, pore_conditions_, solid, fluid);
  if (change)
    PetscCall(to_particles_and_back(solid, mapped));
  else
    PetscCall(map_change(gamma, solid, mapped));
  constrain(t, mapped);
  PetscFunctionReturn(0);
}

/// Adds to velocities before drag, [field][node], the impulse of the change of pore pressure in the step, so that the
/// pressures at its end act. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::add_implicit_pressure(double t, double gamma,
                                                              Vec<dim> *velocity) requires Phases::liquid {
  PetscFunctionBeginUser;
  constexpr double tolerance = 1e-3;  // of the pressure that acts
  constexpr double least = 1e-9;      // of the stiffness of the water
  constexpr int most_rounds = 6, most_iterations = 500;
  const int nodes = grid_.node_count(), all = nodes * fields;
  ImplicitPressure<dim> &of = implicit_;
  auto frame = pore_frame(t, accepted_);
  frame.trial = true;
  const auto sum = [&](const double *a, const double *b, double *result) -> PetscErrorCode {
    PetscFunctionBeginUser;
    *result = 0;
    for (int i = 0; i < nodes; ++i)
      if (mesh_.counted[grid_.mesh_node[i]]) *result += a[i] * b[i];
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, result, 1, MPI_DOUBLE, MPI_SUM, comm()));
    PetscFunctionReturn(0);
  };
  const auto strain_of = [&]<bool linear>(const Vec<dim> *before_drag, double *strain) -> PetscErrorCode {
    PetscFunctionBeginUser;
    PetscCall(velocity_of_step(t, gamma, before_drag, linear));
    for (int i = 0; i < all; ++i)
      for (double &x : of.mapped[i]) x *= gamma;
    PetscCall(fluid_.template find_pore_strain<linear>(frame, pore_conditions_, of.mapped.data(), of, strain));
    PetscFunctionReturn(0);
  };
  PetscCall(fluid_.start_implicit(frame, of));
  std::fill_n(of.strain.begin(), nodes, 0.);
  PetscCall(fluid_.find_squeezed(frame, of.strain.data(), of.start.data(), of.stiffness.data(), of));
  std::fill_n(of.increment.begin(), nodes, 0.);
  std::fill_n(of.before_drag.begin(), all, Vec<dim>{});
  PetscCall(strain_of.template operator()<true>(of.before_drag.data(), of.given.data()));
  for (int round = 0; round < most_rounds; ++round) {
    PetscCall(strain_of.template operator()<false>(velocity, of.strain.data()));
    PetscCall(fluid_.find_squeezed(frame, of.strain.data(), of.residual.data(), of.stiffness.data(), of));
    double sums[3] = {};  // squares: of the residual, of the pressure that acts, of the least
    for (int i = 0; i < nodes; ++i) {
      const double acting = of.start[i] + of.increment[i];
      of.residual[i] -= acting;
      if (!mesh_.counted[grid_.mesh_node[i]]) continue;
      sums[0] += of.volume[i] * of.residual[i] * of.residual[i];
      sums[1] += of.volume[i] * acting * acting;
      sums[2] += of.volume[i] * std::pow(least * of.stiffness[i], 2);
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, comm()));
    const double allowed = tolerance * tolerance * sums[1] + sums[2];
    measures_.pressure_rounds = round;
    if (sums[0] <= allowed) break;
    fluid_.find_mobility(frame, gamma, of);
    PetscCall(fluid_.find_diagonal(frame, gamma, of));
    for (int i = 0; i < nodes; ++i) of.residual[i] *= of.volume[i] / of.stiffness[i];
    const double enough = std::max(0.1 * allowed, 1e-8 * sums[0]);
    int taken = 0;
    PetscCall(of.gradients.solve(
        nodes, of.diagonal.data(), of.residual.data(), of.correction.data(), most_iterations,
        [&](const double *p, double *image) -> PetscErrorCode {
          PetscFunctionBeginUser;
          std::fill_n(of.before_drag.begin(), all, Vec<dim>{});
          PetscCall(fluid_.push_by(frame, pore_conditions_, gamma, p, of, of.before_drag.data()));
          PetscCall(strain_of.template operator()<true>(of.before_drag.data(), image));
          for (int i = 0; i < nodes; ++i)
            image[i] = of.volume[i] * (p[i] / of.stiffness[i] + image[i] - of.given[i]);
          PetscFunctionReturn(0);
        },
        sum,
        [&](const double *r, bool *small) -> PetscErrorCode {
          PetscFunctionBeginUser;
          double square = 0;
          for (int i = 0; i < nodes; ++i)
            if (mesh_.counted[grid_.mesh_node[i]])
              square += r[i] * r[i] * of.stiffness[i] * of.stiffness[i] / of.volume[i];
          PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &square, 1, MPI_DOUBLE, MPI_SUM, comm()));
          *small = square <= enough;
          PetscFunctionReturn(0);
        },
        &taken));
    measures_.pressure_iterations += taken;
    for (int i = 0; i < nodes; ++i) of.increment[i] += of.correction[i];
    PetscCall(fluid_.push_by(frame, pore_conditions_, gamma, of.correction.data(), of, velocity));
  }
  if (std::getenv("IMP_DEBUG")) PetscPrintf(comm(), "t %g rounds %d iterations %lld\n", t, measures_.pressure_rounds, measures_.pressure_iterations);
  PetscFunctionReturn(0);
}

}  // namespace talus
