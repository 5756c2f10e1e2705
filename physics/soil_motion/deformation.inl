// Deformation of cells: strain, stress, volume change, and the work done; theory, section 3; included only where
// SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"
#include "physics/soil_motion/cell_deformation.h"
#include "scene/transfer_source.h"

namespace talus {

/// Cures volumetric locking of the increments in the cells, theory (4.6), (4.7). Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::smooth_volume_strain(const Shape<dim> *shape) {
  PetscFunctionBeginUser;
  const int cells = grid_.cell_count();
  if (transfer_.locking == Locking::patches) {  // F-bar: one mean per patch, weighted as in the forces, theory (4.7)
    for (int c = 0; c < cells; ++c) patch_weight_[grid_.patch[c]] = patch_sum_[grid_.patch[c]] = 0;
    const double *weight = accepted_.weight.data();
    for (int c = 0; c < cells; ++c)
      patch_weight_[grid_.patch[c]] += weight[c], patch_sum_[grid_.patch[c]] += weight[c] * volume_strain_[c];
    for (int c = 0; c < cells; ++c) {
      const double mean = patch_sum_[grid_.patch[c]] / patch_weight_[grid_.patch[c]];
      const double correction = (mean - volume_strain_[c]) / 3;
      for (int k = 0; k < 3; ++k) increment_[c].strain[k] += correction;
      volume_strain_[c] = mean;
    }
  } else if (transfer_.locking == Locking::nodal) {
    std::fill_n(nodal_.begin(), 2 * grid_.node_count(), 0.);
    for (int c = 0; c < cells; ++c)
      for (int i : shape[c].node) {
        nodal_[2 * i] += shape[c].volume;
        nodal_[2 * i + 1] += shape[c].volume * volume_strain_[c];
      }
    PetscCall(grid_.sum(nodal_.data(), 2));
    for (int c = 0; c < cells; ++c) {
      double mean = 0;
      for (int i : shape[c].node) mean += nodal_[2 * i + 1] / nodal_[2 * i] / (dim + 1);
      const double correction = (mean - volume_strain_[c]) / 3;
      for (int k = 0; k < 3; ++k) increment_[c].strain[k] += correction;
      volume_strain_[c] = mean;
    }
  }
  PetscFunctionReturn(0);
}

/// Moves the nodes of the accepted state by `u` and finds the increments of deformation of its cells, theory (3.1),
/// (3.2).
template <int dim, class Phases>
void SoilMotion<dim, Phases>::move_nodes(const Vec<dim> *u, State &to) {
  for (int i = 0; i < grid_.node_count(); ++i)
    for (int d = 0; d < dim; ++d) to.position[i][d] = accepted_.position[i][d] + u[i][d];
  const WorstCell worst = deform_cells<dim>(grid_, u, to.position, accepted_.shape, slenderness_.data(), to.shape,
                                            increment_.data(), volume_strain_.data());
  inverted_ = worst.inverted;
  if (!is_trial(to)) step_ratio_ = 1 / std::sqrt(worst.slenderness), smallest_ratio_ = worst.volume;
}

/// Stress, history and volume of the points of a body, theory (3.3), (3.9); adds their volumes to the cells.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::update_points(double t, size_t b, State &to) {
  const PointSet &p = points_[b];
  const Body<dim> &body = *bodies_[b];
  double *history = to.history[b], *volume = to.volume[b];
  if (!loading.softening) {
    forgotten_.resize(std::max<size_t>(forgotten_.size(), p.count * body.history_count()));
    history = forgotten_.data();
  }
  update_stress<dim>(body.law(), {.count = p.count,
                                  .stress_in = p.stress,
                                  .history_in = history_seen_by_law(b),
                                  .stress_out = to.stress[b],
                                  .history_out = history,
                                  .cell = p.cell,
                                  .increment = increment_.data(),
                                  .size = softening_size(b),
                                  .suction = find_suction(b),
                                  .cohesion_share = p.cohesion_share,
                                  .friction_share = p.friction_share,
                                  .time_step = t - accepted_time_,
                                  .time = accepted_time_});
  if (nonlocal_[b]) nonlocal_[b]->restore(p, history);
  if (!loading.softening && !is_trial(to)) {
    const auto fields_of_law = history_fields(body.law());
    const size_t count = fields_of_law.size();
    for (size_t k = 0; k < count; ++k)
      for (int q = 0; fields_of_law[k].kept && q < p.count; ++q) p.history[q * count + k] = forgotten_[q * count + k];
  }
  for (int q = 0; q < p.count; ++q) {
    const int c = p.cell[q];
    volume[q] = body.admissible_volume(p.volume[q] * exp_small(volume_strain_[c]), p.limit[q],
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
  move_nodes(u, to);
  if constexpr (Phases::liquid) std::copy_n(volume_strain_.begin(), cells, pore_strain_.begin());
  PetscCall(smooth_volume_strain(to.shape));
  if constexpr (Phases::liquid) {  // the pores' volume follows the smoothing of their pressure
    // where it is not smoothed, it follows the skeleton: nothing would resist a difference of the two, which would grow
    for (int c = 0; c < cells; ++c)
      if (!fluid_.smoothed(c)) pore_strain_[c] = volume_strain_[c];
    PetscCall(fluid_.smooth_divergence(pore_frame(t, accepted_), pore_strain_));
    std::copy_n(pore_strain_.begin(), cells, volume_strain_.begin());
  }
  std::fill_n(to.particle_volume.begin(), cells, 0.);
  for (size_t b = 0; b < bodies_.size(); ++b) update_points(t, b, to);
  for (int c = 0; c < cells; ++c)
    to.weight[c] = to.particle_volume[c] + blend_[c] * (to.shape[c].volume - to.particle_volume[c]);
  if (!trial && loading.softening)
    for (size_t b = 0; b < bodies_.size(); ++b)
      if (nonlocal_[b]) PetscCall(nonlocal_[b]->update(grid_, points_[b]));
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
  conditions_.add_work(displacement);
  work_.add(grid_, displacement, loading.gravity_at(loading.set_at), extra_mass(), loading.damping > 0);
  moved_ = 0, speed_squared_ = 0;
  for (int i = 0; i < grid_.node_count(); ++i) {
    const Vec<dim> &x = grid_.position[i], &X = mesh_.position[grid_.mesh_node[i]];
    double distance = 0, speed = 0;
    for (int d = 0; d < dim; ++d) distance += (x[d] - X[d]) * (x[d] - X[d]), speed += velocity[i][d] * velocity[i][d];
    const double edge = mesh_.mean_edge[grid_.mesh_node[i]];
    moved_ = std::max(moved_, distance / (edge * edge));
    speed_squared_ = speed <= speed_squared_ ? speed_squared_ : speed;  // a NaN passes through
  }
  moved_ = std::sqrt(moved_);
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
