// Forces and accelerations; theory (3.5) to (3.7); included only where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "particles/own_acceleration.h"
#include "physics/soil_motion.h"
#include "scene/transfer_source.h"

namespace talus {

/// Adds the forces of the bodies' `body_acceleration`, theory (3.5).
template <int dim, class Phases>
void SoilMotion<dim, Phases>::add_body_forces(double load_time) {
  for (const auto &body : bodies_) {
    const auto &acceleration = own_acceleration(body->source());
    if (acceleration.empty()) continue;
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const auto n = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
      const auto &node = grid_.shape[grid_.find_cell(p.cell[i])].node;
      const Vec<dim> &X = p.reference[i];
      for (int d = 0; d < dim; ++d) {
        const double f = p.mass[i] * acceleration[d](X[0], X[1], dim == 3 ? X[dim - 1] : 0, load_time);
        for (int k = 0; k <= dim; ++k) force_[node[k]][d] += n[k] * f;
      }
    }
  }
}

/// Adds the forces of the stiffness part of Rayleigh damping, of nodes that move with `velocities_.moving`: those of
/// the stress by which the law would change the stress in beta, docs/theory/earthquakes.md (9.3). Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::add_viscous_forces(const State &state) {
  PetscFunctionBeginUser;
  PetscCall(rayleigh_.find_rates(grid_, velocities_.moving.data(), state, transfer_.locking, patches_, nodal_));
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const int count = points_[b].count;
    const double beta = rayleigh_.of(b).stiffness, *present = state.stress[b];
    double *ahead = rayleigh_.stress(b, count);
    if (beta > 0) {
      StressPoints<dim> points = stress_points(b, ahead, rayleigh_.history(b, count));
      points.stress_in = present;
      if (is_trial(state) && loading.softening && !softening_.averages(b)) points.history_in = state.history[b];
      points.increment = rayleigh_.strain_ahead(b, grid_.cell_count());
      points.time_step = beta, points.time = accepted_time_;
      update_stress<dim>(bodies_[b]->law(), points);
    }
    rayleigh_.take_off(b, beta > 0 ? present : nullptr, count);
  }
  rayleigh_.add_forces(grid_, points_, state, transfer_.locking, patches_, force_.data());
  PetscFunctionReturn(0);
}

/// Forces on the mixture at the nodes in a state at time t, theory (3.5), into `force_`. `damped`: with the stiffness
/// part of Rayleigh damping. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::total_force(double t, const State &state, bool damped) {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count();
  const double load_time = loading.time_at(t);
  stress_.find(grid_, points_, state.stress, state, transfer_.locking, patches_);
  std::fill_n(force_.begin(), nodes, Vec<dim>{});
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const std::array<Vec<dim>, dim + 1> forces = stress_.forces(c, state);
    for (int k = 0; k <= dim; ++k) add_scaled<dim>(force_[state.shape[c].node[k]], 1, forces[k]);
  }
  if (damped) PetscCall(add_viscous_forces(state));
  conditions_.surface_loads().add(load_time, grid_, state.position, force_.data());
  if (conditions_.structures())
    conditions_.add_structures(
        grid_, [this](int cell) { return stress_.mean(cell); }, force_.data());
  if (work_.imposes()) {
    work_.before_imposed(force_.data(), nodes);
    add_body_forces(load_time);
    if constexpr (Phases::prescribed) {
      if (!is_trial(state)) PetscCall(water_.advance_to(load_time, grid_, filling_.blend.data()));
      water_.add_force(grid_, state, load_time, loading.ramp_at(t), force_.data());
    }
    work_.after_imposed(force_.data(), nodes);
  }
  PetscCall(grid_.sum(force_[0].data(), dim));
  conditions_.add_reactions(force_.data());
  PetscCall(conditions_.add_columns(
      grid_, [this](int cell, const Vec<dim> &n) { return stress_.traction(cell, n); }, force_.data()));
  const double *extra = extra_mass();
  const Vec<dim> gravity = loading.gravity_at(t);
  for (int i = 0; i < nodes; ++i) {
    const double m = grid_.mass[i] + (extra ? extra[i] : 0);
    for (int d = 0; d < dim; ++d) force_[i][d] += m * gravity[d];
  }
  if constexpr (Phases::liquid) fluid_.add_to_mixture(pore_frame(t, state), pore_conditions_, force_.data());
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::acceleration(double t, const double *u, const double *v, double *a) {
  PetscFunctionBeginUser;
  if (damped())  // where fluids move, nodes have what is mapped back already
    PetscCall(find_moving(t, reinterpret_cast<const Vec<dim> *>(v), velocities_.share_not_mapped(t), Phases::liquid));
  PetscCall(accelerate(t, u, v, a));
  PetscFunctionReturn(0);
}

/// The same, of nodes that move with `velocities_.moving` where Rayleigh damping asks for it.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::accelerate(double t, const double *u, const double *v, double *a) {
  PetscFunctionBeginUser;
  const bool damped = this->damped();
  if (damped) rayleigh_.set(loading.damping_frequencies);
  if (u) {
    trial_.make_room(grid_, bodies_.size());
    for (size_t b = 0; b < bodies_.size(); ++b)
      trial_.make_room(b, points_[b].count, static_cast<int>(bodies_[b]->history_count()));
    PetscCall(deform(t, reinterpret_cast<const Vec<dim> *>(u), trial_));
  }
  const State &state = u ? static_cast<const State &>(trial_) : accepted_;
  PetscCall(total_force(t, state, damped));
  const Vec<dim> *unbalanced = force_.data();
  if (loading.damping > 0) {  // what supports take up is not out of balance: damping must not change their reactions
    std::copy_n(force_.begin(), grid_.node_count(), scratch_.begin());
    conditions_.project(reinterpret_cast<const Vec<dim> *>(v), scratch_.data());
    unbalanced = scratch_.data();
  }
  if constexpr (Phases::liquid)
    PetscCall(fluid_.find_accelerations(pore_frame(t, state), pore_conditions_, force_.data(),
                                        reinterpret_cast<Vec<dim> *>(a) + grid_.node_count(),
                                        reinterpret_cast<const Vec<dim> *>(v)));
  for (int i = 0; i < grid_.node_count(); ++i) {
    const double inverse = grid_.mass[i] > smallest_mass_ ? 1 / grid_.mass[i] : 0;  // a lighter node is carried along
    for (int d = 0; d < dim; ++d) {
      const double rest = unbalanced[i][d], power = rest * v[i * dim + d];
      const double held_back = loading.damping * rest * ((power > 0) - (power < 0));
      a[i * dim + d] = inverse * (force_[i][d] - held_back);
      if (loading.damping > 0) work_.damping(i)[d] = held_back;
    }
  }
  if (damped) {  // of each phase, relative to the ground from which motion comes in
    PetscCall(rayleigh_.find_mass_factors(grid_, points_, state));
    const Vec<dim> ground = loading.ground_velocity_at(t);
    const int nodes = grid_.node_count();
    for (int i = 0; i < nodes * fields; ++i)
      for (int d = 0; d < dim; ++d) {
        const double held_back = rayleigh_.mass_factor(i % nodes) * (v[i * dim + d] - ground[d]);
        a[i * dim + d] -= held_back;
        if (i < nodes) work_.damping(i)[d] = grid_.mass[i] * held_back;
      }
  }
  PetscFunctionReturn(0);
}

}  // namespace talus
