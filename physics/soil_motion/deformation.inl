// Deformation of cells: strain, stress, volume change, and the work done; theory, section 3; included only where
// SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"
#include "scene/transfer_source.h"

namespace talus {

/// The stress points of a body as its law sees them, from their accepted state to where it puts the next one.
template <int dim, class Phases>
StressPoints<dim> SoilMotion<dim, Phases>::stress_points(size_t b, double *stress_out, double *history_out) {
  const PointSet &p = points_[b];
  return {.count = p.count,
          .stress_in = p.stress,
          .history_in = p.history,
          .stress_out = stress_out,
          .history_out = history_out,
          .cell = p.cell,
          .increment = increments_.increment.data(),
          .size = softening_.size(b, grid_),
          .suction = find_suction(b),
          .cohesion_share = p.cohesion_share,
          .friction_share = p.friction_share,
          .excess = softening_.excess(b),
          .averaged = softening_.field(b)};
}

/// What a law remembers of its state where plastic strain is not recorded, from `forgotten_`.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::keep_history(size_t b) {
  const PointSet &p = points_[b];
  const auto fields_of_law = history_fields(bodies_[b]->law());
  const size_t count = fields_of_law.size();
  for (size_t k = 0; k < count; ++k)
    for (int q = 0; fields_of_law[k].kept && q < p.count; ++q) p.history[q * count + k] = forgotten_[q * count + k];
}

/// Volumes of the points of a body, theory (3.9), and their sums in the cells.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::update_volumes(size_t b, const double *history, State &to) {
  const PointSet &p = points_[b];
  const Body<dim> &body = *bodies_[b];
  double *volume = to.volume[b];
  for (int q = 0; q < p.count; ++q) {
    const int c = p.cell[q];
    volume[q] = body.admissible_volume(p.volume[q] * exp_small(increments_.volume_strain[c]), p.limit[q],
                                       history + q * body.history_count());
    to.particle_volume[c] += volume[q];
  }
}

/// Deforms the accepted state by nodal displacements `u`, reached at time t: into the trial state, or in place.
/// Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::deform(double t, const Vec<dim> *u, State &to) {
  PetscFunctionBeginUser;
  const int cells = grid_.cell_count();
  const bool trial = is_trial(to);
  if constexpr (Phases::liquid) {
    auto accepted = pore_frame(t, accepted_);
    accepted.trial = trial;
    PetscCall(fluid_.find_divergence(accepted, pore_conditions_, u));
  }
  for (int i = 0; i < grid_.node_count(); ++i)
    for (int d = 0; d < dim; ++d) to.position[i][d] = accepted_.position[i][d] + u[i][d];
  measures_.deform(increments_.find(grid_, u, accepted_, filling_.slenderness.data(), to), trial);
  std::vector<double> &volume_strain = increments_.volume_strain;
  if constexpr (Phases::liquid) std::copy_n(volume_strain.begin(), cells, pore_strain_.begin());
  PetscCall(
      increments_.smooth_volume_strain(transfer_.locking, grid_, accepted_.weight.data(), to.shape, patches_, nodal_));
  if constexpr (Phases::liquid) {  // the pores' volume follows the smoothing of their pressure
    // where it is not smoothed, it follows the skeleton: nothing would resist a difference of the two, which would grow
    for (int c = 0; c < cells; ++c)
      if (!fluid_.smoothed(c)) pore_strain_[c] = volume_strain[c];
    PetscCall(fluid_.smooth_divergence(pore_frame(t, accepted_), pore_strain_));
    std::copy_n(pore_strain_.begin(), cells, volume_strain.begin());
  }
  std::fill_n(to.particle_volume.begin(), cells, 0.);
  for (size_t b = 0; b < bodies_.size(); ++b) {  // stress and history, theory (3.3)
    double *history = to.history[b];
    if (!loading.softening) {
      forgotten_.resize(std::max<size_t>(forgotten_.size(), points_[b].count * bodies_[b]->history_count()));
      history = forgotten_.data();
    }
    StressPoints<dim> points = stress_points(b, to.stress[b], history);
    points.time_step = t - accepted_time_, points.time = accepted_time_;
    update_stress<dim>(bodies_[b]->law(), points);
    if (!loading.softening && !trial) keep_history(b);
    update_volumes(b, history, to);
  }
  for (int c = 0; c < cells; ++c)
    to.weight[c] = to.particle_volume[c] + filling_.blend[c] * (to.shape[c].volume - to.particle_volume[c]);
  filling_.divide_cells(to);
  if (!trial && loading.softening) PetscCall(softening_.update(grid_, points_));
  if constexpr (Phases::liquid) {
    fluid_.change_masses(pore_frame(t, to));
    if (trial) PetscCall(fluid_.update_pressures(pore_frame(t, to)));
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::accept(double t, const double *u, const double *v) {
  PetscFunctionBeginUser;
  const Vec<dim> *displacement = reinterpret_cast<const Vec<dim> *>(u);
  std::vector<Vec<dim>> &velocity = velocities_.now;
  velocities_.own_share = velocities_.own_share_at(t);
  if (v != velocity[0].data())
    std::copy_n(reinterpret_cast<const Vec<dim> *>(v), grid_.node_count() * fields, velocity.begin());
  PetscCall(deform(t, displacement, accepted_));
  accepted_time_ = t;
  conditions_.add_work(grid_, displacement);
  work_.add(grid_, displacement, loading.gravity_at(loading.set_at), extra_mass(), loading.damping > 0 || damped());
  if (damped()) work_.add_damping(grid_, displacement, rayleigh_.forces());
  measures_.move<dim>(grid_, velocity.data());
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::freeze_reactions(double t) {
  PetscFunctionBeginUser;
  PetscCall(begin(t));
  PetscCall(total_force(loading.set_at, accepted_));
  conditions_.freeze_reactions(grid_, force_.data());
  PetscFunctionReturn(0);
}

}  // namespace talus
