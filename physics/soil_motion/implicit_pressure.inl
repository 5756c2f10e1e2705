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
  constexpr double tolerance = 1e-2;  // of the pressure that acts
  constexpr double least = 1e-9;      // of the stiffness of the water
  constexpr int most_rounds = 12, most_iterations = 500;
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
  const auto squares = [&](auto &&...term) {  // sums over nodes of volume times the squares
    std::array<double, sizeof...(term)> all{};
    for (int i = 0; i < nodes; ++i)
      if (mesh_.counted[grid_.mesh_node[i]]) {
        size_t k = 0;
        ((all[k++] += of.volume[i] * std::pow(term(i), 2)), ...);
      }
    MPI_Allreduce(MPI_IN_PLACE, all.data(), all.size(), MPI_DOUBLE, MPI_SUM, comm());
    return all;
  };
  PetscCall(fluid_.start_implicit(frame, of));
  std::fill_n(of.held.begin(), nodes, 0.);
  PetscCall(fluid_.find_squeezed(frame, of.acting.data(), of));
  std::fill_n(of.before_drag.begin(), all, Vec<dim>{});
  PetscCall(strain_of.template operator()<true>(of.before_drag.data(), of.given.data()));
  for (int round = 0; round < most_rounds; ++round) {
    double *pressure = of.residual.data();
    const auto sizes = squares([&](int i) { return of.acting[i]; }, [&](int i) { return least * of.stiffness[i]; });
    const double allowed = tolerance * tolerance * sizes[0] + sizes[1];
    for (int turn = 0; turn < most_rounds; ++turn) {  // piecewise linear
      PetscCall(fluid_.find_squeezed(frame, pressure, of));
      const auto apart = squares([&](int i) { return pressure[i] - of.acting[i]; });
      if (apart[0] <= 1e-4 * allowed) break;
      for (int i = 0; i < nodes; ++i) of.held[i] += (pressure[i] - of.acting[i]) / of.stiffness[i];
    }
    PetscCall(strain_of.template operator()<false>(velocity, of.strain.data()));
    const auto lacks = squares([&](int i) { return (of.held[i] - of.strain[i]) * of.stiffness[i]; });
    measures_.pressure_rounds = round;
    if (lacks[0] <= allowed) break;
    fluid_.find_mobility(frame, gamma, of);
    PetscCall(fluid_.find_diagonal(frame, gamma, of));
    for (int i = 0; i < nodes; ++i) of.residual[i] = of.volume[i] * (of.held[i] - of.strain[i]);
    const double enough = std::max(0.1 * allowed, 1e-5 * lacks[0]);
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
    if (std::getenv("IMP_DEBUG")) PetscPrintf(comm(), "  round %d residual %g allowed %g taken %d\n", round, std::sqrt(lacks[0]/sizes[0]), std::sqrt(allowed/sizes[0]), taken);
    for (int i = 0; i < nodes; ++i) of.acting[i] += of.correction[i];
    PetscCall(fluid_.push_by(frame, pore_conditions_, gamma, of.correction.data(), of, velocity));
  }
  if (std::getenv("IMP_DEBUG")) PetscPrintf(comm(), "t %g rounds %d iterations %lld\n", t, measures_.pressure_rounds, measures_.pressure_iterations);
  PetscFunctionReturn(0);
}

}  // namespace talus
