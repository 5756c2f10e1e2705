// Given pore pressure, sampled now and then and linear in between; included only where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"

namespace talus {

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::gather_pore_water() requires Phases::prescribed {
  PetscFunctionBeginUser;
  water_moved_ = false;
  std::fill_n(extra_mass_.begin(), grid_.node_count(), 0.);
  for (const auto &body : bodies_) {
    const BodySource &source = body->source();
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const double dry = source.grain_density * (1 - source.porosity);
      const double saturation = pressure_.below_table(p.position[i], loading.time) ? 1 : source.saturation;
      const double extra = (dry + source.porosity * saturation * pressure_.density()) * p.initial_volume[i] - p.mass[i];
      if (std::abs(extra) <= 1e-12 * p.mass[i]) continue;
      const auto n = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
      const auto &node = grid_.shape[grid_.find_cell(p.cell[i])].node;
      for (int k = 0; k <= dim; ++k) extra_mass_[node[k]] += n[k] * extra;
    }
  }
  PetscCall(grid_.sum(extra_mass_.data(), 1));
  PetscFunctionReturn(0);
}

/// Suction at the stress points of a body, or null where its law reads none. It is what the given pressure falls below
/// zero; a scene without it takes the pressure as it is, theory (2.10).
template <int dim, class Phases>
const double *SoilMotion<dim, Phases>::find_suction(size_t b) {
  if (!reads_suction(bodies_[b]->law())) return nullptr;
  if constexpr (Phases::prescribed) {
    sample_pressure(loading.time);
    const auto [early, late] = sample_shares(loading.time, loading.ramp);
    const PointSet &p = points_[b];
    suction_.resize(std::max<size_t>(suction_.size(), p.count));
    for (int q = 0; q < p.count; ++q)
      suction_[q] = early * sample_[0].suction[p.cell[q]] + late * sample_[1].suction[p.cell[q]];
    return suction_.data();
  }
  if constexpr (Phases::suction) return fluid_.suction(static_cast<int>(b));
  return nullptr;  // refused at the door
}

/// Samples the given pressure at the nodes now and a few steps ahead; in between it is linear in time.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::sample_pressure(double t) requires Phases::prescribed {
  constexpr double steps_ahead = 16;
  if (t >= sample_time_[0] && t <= sample_time_[1]) return;
  const double step = last_pressure_time_ < t ? t - last_pressure_time_ : 1e-6 * (1 + std::abs(t));
  sample_time_[0] = t, sample_time_[1] = t + steps_ahead * step;
  water_moved_ = pressure_.moves();
  for (int k = 0; k < 2; ++k) {
    auto &sample = sample_[k];
    sample.gradient.resize(mesh_.cell_count()), sample.value.resize(mesh_.cell_count()),
        sample.nodal.resize(mesh_.node_count());
    for (int i = 0; i < grid_.node_count(); ++i)
      sample.nodal[i] = pressure_(mesh_.position[grid_.mesh_node[i]], sample_time_[k]);
    if (suction_matters_) {
      sample.suction.resize(mesh_.cell_count());
      for (int c = 0; c < grid_.cell_count(); ++c) {
        sample.suction[c] = 0;
        for (int i : grid_.shape[c].node) sample.suction[c] += std::max(0., -sample.nodal[i]) / (dim + 1);
      }
      for (int i = 0; i < grid_.node_count(); ++i) sample.nodal[i] = std::max(0., sample.nodal[i]);
    }
    for (int c = 0; c < grid_.cell_count(); ++c) {
      const auto &node = grid_.shape[c].node;
      const Cell<dim> &cell = mesh_.cells[grid_.mesh_cell[c]];
      Vec<dim> gradient{};
      double value = 0;
      for (int a = 0; a < dim; ++a)
        for (int d = 0; d < dim; ++d)
          gradient[d] += (sample.nodal[node[a + 1]] - sample.nodal[node[0]]) * cell.gradient[a][d];
      double volume = 0;
      for (int a = 0; a <= dim; ++a) volume += grid_.nodal_share[c][a];
      for (int a = 0; a <= dim; ++a)
        value += sample.nodal[node[a]] * (blend_[c] / (dim + 1) + (1 - blend_[c]) * grid_.nodal_share[c][a] / volume);
      sample.gradient[c] = gradient, sample.value[c] = value;
    }
  }
}

/// Of the two samples at time t, times the ramp.
template <int dim, class Phases>
std::array<double, 2> SoilMotion<dim, Phases>::sample_shares(double t, double ramp) const {
  const double late = ramp * (t - sample_time_[0]) / (sample_time_[1] - sample_time_[0]);
  return {ramp - late, late};
}

/// With open water on submerged faces the pore pressure acts as the body force -grad p, which includes the water's
/// weight on the face without knowing where the face is; without it, as a part of the stress, theory (2.8), (2.9).
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::add_pore_pressure(double load_time, double ramp,
                                                          bool trial) requires Phases::prescribed {
  PetscFunctionBeginUser;
  if (!trial) {  // a step that looks ahead sees the line go on
    sample_pressure(load_time), last_pressure_time_ = load_time;
    if (water_moved_) PetscCall(gather_pore_water());
  }
  const auto [early, late] = sample_shares(load_time, ramp);
  const Shape<dim> *shape = trial ? trial_shape_.data() : grid_.shape.data();
  const double *weight = trial ? trial_weight_.data() : weight_.data();
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const auto &node = shape[c].node;
    if (pressure_.open_water_load()) {
      for (int k = 0; k <= dim; ++k)
        for (int d = 0; d < dim; ++d)
          force_[node[k]][d] -=
              grid_.nodal_share[c][k] * (early * sample_[0].gradient[c][d] + late * sample_[1].gradient[c][d]);
    } else {
      const double push = weight[c] * (early * sample_[0].value[c] + late * sample_[1].value[c]);
      for (int k = 0; k < dim; ++k)
        for (int d = 0; d < dim; ++d) {
          force_[node[k + 1]][d] += push * shape[c].gradient[k][d];
          force_[node[0]][d] -= push * shape[c].gradient[k][d];
        }
    }
  }
  PetscFunctionReturn(0);
}

}  // namespace talus
