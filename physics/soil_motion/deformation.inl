// Cells that deform: strain, stress, volume, and what that takes and gives of work; theory, section 3; included only
// where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"

namespace talus {

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::smooth_volume_strain(const Shape<dim> *shape) {
  PetscFunctionBeginUser;
  const int cells = grid_.cell_count();
  if (transfer_.locking == Locking::patches) {  // F-bar: one mean per patch, weighted as in the forces, theory (4.7)
    for (int c = 0; c < cells; ++c) patch_weight_[grid_.patch[c]] = patch_sum_[grid_.patch[c]] = 0;
    for (int c = 0; c < cells; ++c)
      patch_weight_[grid_.patch[c]] += weight_[c], patch_sum_[grid_.patch[c]] += weight_[c] * volume_strain_[c];
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

/// Deforms the accepted state by nodal displacements `u`, reached at time t: into the trial state, or in place.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::deform(double t, const Vec<dim> *u, bool trial) {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count(), cells = grid_.cell_count();
  if (trial) {
    trial_position_.resize(velocity_.size()), trial_shape_.resize(cells);
    trial_particle_volume_.resize(cells), trial_weight_.resize(cells);
    trial_stress_.resize(bodies_.size()), trial_history_.resize(bodies_.size()), trial_volume_.resize(bodies_.size());
  }
  Vec<dim> *position = trial ? trial_position_.data() : grid_.position.data();
  Shape<dim> *shape = trial ? trial_shape_.data() : grid_.shape.data();
  double *particle_volume = trial ? trial_particle_volume_.data() : particle_volume_.data();
  double *weight = trial ? trial_weight_.data() : weight_.data();
  if constexpr (Phases::liquid) {
    auto accepted = pore_frame(false);
    accepted.trial = trial;
    PetscCall(fluid_.flow(accepted, pore_conditions_, u));
  }
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < dim; ++d) position[i][d] = grid_.position[i][d] + u[i][d];
  double slender = 1, smallest = 1;
  inverted_ = false;
  for (int c = 0; c < cells; ++c) {
    const Shape<dim> &from = grid_.shape[c];
    Shape<dim> &to = shape[c];
    Square<dim> g = Square<dim>::Zero();
    for (int k = 0; k < dim; ++k)
      for (int i = 0; i < dim; ++i) {
        const double du = u[from.node[k + 1]][i] - u[from.node[0]][i];
        for (int j = 0; j < dim; ++j) g(i, j) += du * from.gradient[k][j];
      }
    if (!decompose<dim>(g, increment_[c])) {
      smallest = -1, inverted_ = true;
      increment_[c] = {};
      increment_[c].rotation[0] = 1;
      if constexpr (dim == 3) increment_[c].rotation[4] = increment_[c].rotation[8] = 1;
    }
    volume_strain_[c] = trace<dim>(increment_[c]);
    std::array<const Vec<dim> *, dim + 1> x;
    for (int k = 0; k <= dim; ++k) x[k] = &position[from.node[k]];
    to.node = from.node;
    to.volume = simplex_gradients<dim>(x, to.gradient);
    double gradient = 0;
    for (const auto &row : to.gradient)
      for (double value : row) gradient += value * value;
    slender = std::max(slender, gradient / slenderness_[c]);
    smallest = std::min(smallest, to.volume / mesh_.volume[grid_.mesh_cell[c]]);
  }
  if (!trial) step_ratio_ = 1 / std::sqrt(slender), smallest_ratio_ = smallest;
  if constexpr (Phases::liquid) std::copy_n(volume_strain_.begin(), cells, pore_strain_.begin());
  PetscCall(smooth_volume_strain(shape));
  if constexpr (Phases::liquid) {  // the pores' volume follows the smoothing of their pressure
    PetscCall(fluid_.smooth_flow(pore_frame(false), pore_strain_));
    std::copy_n(pore_strain_.begin(), cells, volume_strain_.begin());
  }
  for (int c = 0; c < cells; ++c) particle_volume[c] = 0;
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PointSet &p = points_[b];
    const Body<dim> &body = *bodies_[b];
    double *stress = p.stress, *history = p.history, *volume = p.volume;
    if (trial) {
      trial_stress_[b].resize(p.count * components), trial_history_[b].resize(p.count * body.history_count()),
          trial_volume_[b].resize(p.count);
      stress = trial_stress_[b].data(), history = trial_history_[b].data(), volume = trial_volume_[b].data();
    }
    if (!loading.softening) {
      forgotten_.resize(std::max<size_t>(forgotten_.size(), p.count * body.history_count()));
      history = forgotten_.data();
    }
    update_stress<dim>(body.law(), {p.count, p.stress, seen_history(b), stress, history, p.cell, increment_.data(),
                                    softening_size(b), find_suction(b), t - accepted_time_, accepted_time_});
    if (nonlocal_[b]) nonlocal_[b]->restore(p, history);
    if (!loading.softening && !trial) {
      const auto fields = history_fields(body.law());
      for (size_t k = 0; k < fields.size(); ++k)
        for (int q = 0; fields[k].kept && q < p.count; ++q)
          p.history[q * fields.size() + k] = forgotten_[q * fields.size() + k];
    }
    for (int q = 0; q < p.count; ++q) {
      const int c = p.cell[q];
      volume[q] = std::min(p.volume[q] * exp_small(volume_strain_[c]),
                           body.volume_limit(p.limit[q], history + q * body.history_count()));
      particle_volume[c] += volume[q];
    }
  }
  for (int c = 0; c < cells; ++c) weight[c] = particle_volume[c] + blend_[c] * (shape[c].volume - particle_volume[c]);
  if (!trial && loading.softening)
    for (size_t b = 0; b < bodies_.size(); ++b)
      if (nonlocal_[b]) PetscCall(nonlocal_[b]->follow(grid_, points_[b]));
  if constexpr (Phases::liquid) {
    fluid_.exchange(pore_frame(trial));
    if (trial) PetscCall(fluid_.store(pore_frame(true)));
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::accept(double t, const double *u, const double *v) {
  PetscFunctionBeginUser;
  own_share_ = relaxed(t);
  if (v != velocity_[0].data())
    std::copy_n(reinterpret_cast<const Vec<dim> *>(v), grid_.node_count() * velocity_fields<Phases>, velocity_.begin());
  PetscCall(deform(t, reinterpret_cast<const Vec<dim> *>(u), false));
  accepted_time_ = t;
  add_up_work(reinterpret_cast<const Vec<dim> *>(u));
  moved_ = 0, speed_squared_ = 0;
  for (int i = 0; i < grid_.node_count(); ++i) {
    const Vec<dim> &x = grid_.position[i], &X = mesh_.position[grid_.mesh_node[i]];
    double distance = 0, speed = 0;
    for (int d = 0; d < dim; ++d) distance += (x[d] - X[d]) * (x[d] - X[d]), speed += velocity_[i][d] * velocity_[i][d];
    const double edge = mesh_.mean_edge[grid_.mesh_node[i]];
    moved_ = std::max(moved_, distance / (edge * edge));
    speed_squared_ = speed <= speed_squared_ ? speed_squared_ : speed;  // a NaN passes through
  }
  moved_ = std::sqrt(moved_);
  PetscFunctionReturn(0);
}

/// Work of the forces of the last evaluation in an accepted step, theory (6.6).
template <int dim, class Phases>
void SoilMotion<dim, Phases>::add_up_work(const Vec<dim> *u) {
  conditions_.follow(u);
  Vec<dim> weighted{};
  for (int i = 0; i < grid_.node_count(); ++i) {
    if (!mesh_.owned[grid_.mesh_node[i]]) continue;
    const double m = grid_.mass[i] + (Phases::prescribed ? extra_mass_[i] : 0);
    for (int d = 0; d < dim; ++d) weighted[d] += m * u[i][d];
    if (loading.damping > 0)
      for (int d = 0; d < dim; ++d) work_.damping -= held_back_[i][d] * u[i][d];
  }
  for (int d = 0; d < dim; ++d) work_.gravity += loading.ramp * loading.gravity[d] * weighted[d];
  if (imposes_)
    for (int i = 0; i < grid_.node_count(); ++i)
      for (int d = 0; d < dim; ++d) work_.imposed += imposed_[i][d] * u[i][d];
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::freeze_reactions(double t) {
  PetscFunctionBeginUser;
  PetscCall(begin(t));
  PetscCall(total_force(loading.time, loading.ramp, false));
  conditions_.freeze_reactions(grid_, force_.data());
  PetscFunctionReturn(0);
}

}  // namespace talus
