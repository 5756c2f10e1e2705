// Particles to nodes and back: theory, section 4; included only where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"

namespace talus {

/// Calls f<averaged, apic>() as the scene's transfer asks for.
template <class F>
void with_transfer(const Transfer &transfer, F &&f) {
  const bool apic = transfer.velocity == Velocity::apic;
  if (transfer.average_stress)
    apic ? f.template operator()<true, true>() : f.template operator()<true, false>();
  else
    apic ? f.template operator()<false, true>() : f.template operator()<false, false>();
}

/// Adds the particles, or those that are still missing, to the grid.
template <int dim, class Phases>
template <bool averaged, bool apic>
void SoilMotion<dim, Phases>::gather() {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PointSet &points = points_[b];
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    if (!averaged) points.own_cell.resize(std::max<size_t>(points.own_cell.size(), p.count));
    Pores<dim> pores;
    if constexpr (Phases::liquid) pores = fluid_.pores(b);
    to_nodes<dim, averaged, apic, fluids>(*bodies_[b], grid_, start_velocity_.data(), points, pores,
                                          movers_ ? &(*movers_)[b] : nullptr);
    if (!averaged) points.count = p.count;
    attach(b);
  }
  movers_ = nullptr;
}

/// Shows the kernel where stress is: at points of their own or at the particles.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::attach(size_t b) {
  PointSet &points = points_[b];
  const ParticleArrays<dim> &p = bodies_[b]->particles();
  const bool own = transfer_.average_stress;
  points.cell = points.own_cell.data();
  points.stress = own ? points.own_stress.data() : p.stress,
  points.history = own ? points.own_history.data() : p.history;
  points.volume = own ? points.own_volume.data() : p.volume,
  points.limit = own ? points.own_limit.data() : p.initial_volume;
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::settle() {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) PetscCall(fluid_.store(pore_frame(false)));
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::begin(double t) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) fluid_.prescribed = !loading.pore_flow, fluid_.prescribed_ramp = loading.ramp;
  if (gathered_) PetscFunctionReturn(0);
  if (!movers_) std::fill(start_velocity_.begin(), start_velocity_.end(), Vec<dim>{});
  with_transfer(transfer_, [&]<bool averaged, bool apic>() { gather<averaged, apic>(); });
  grid_.complete();
  PetscCall(finish_gather(t));
  gathered_ = true, remap_time_ = accepted_time_ = t, own_share_ = 1, moved_ = 0, smallest_ratio_ = 1, step_ratio_ = 1;
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::finish_gather(double) {
  PetscFunctionBeginUser;
  constexpr int width = dim + 2;  // mass, momentum, volume
  const int nodes = grid_.node_count(), cells = grid_.cell_count();
  std::fill_n(nodal_.begin(), nodes * width, 0.);
  for (int c = 0; c < cells; ++c) {
    const auto &matrix = grid_.mass_matrix[c];
    const auto &node = grid_.shape[c].node;
    for (int k = 0, pair = dim + 1; k <= dim; ++k) {
      nodal_[node[k] * width] += matrix[k];
      for (int l = k + 1; l <= dim; ++l, ++pair)
        nodal_[node[k] * width] += matrix[pair], nodal_[node[l] * width] += matrix[pair];
      nodal_[node[k] * width + dim + 1] += grid_.nodal_share[c][k];
    }
  }
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < dim; ++d) nodal_[i * width + 1 + d] = start_velocity_[i][d];
  PetscCall(grid_.sum(nodal_.data(), width));
  for (int i = 0; i < nodes; ++i) {
    const double m = grid_.mass[i] = nodal_[i * width];
    for (int d = 0; d < dim; ++d) start_velocity_[i][d] = m > 0 ? nodal_[i * width + 1 + d] / m : 0;
    if (!(m > 0)) grid_.mass[i] = std::numeric_limits<double>::min();  // no particle sees this node
  }
  set_weights(nodal_);
  if (conditions_.has_dashpots()) measure_impedance();
  for (int c = 0; c < cells; ++c) filling_[c] = weight_[c] / grid_.shape[c].volume;
  PetscCall(conditions_.begin(grid_, impedance_, filling_));
  conditions_.surface_loads().begin(bodies_, grid_);
  conditions_.constrain(loading.time, grid_, start_velocity_.data(), false);
  std::copy_n(start_velocity_.begin(), nodes, velocity_.begin());
  if constexpr (Phases::liquid) {
    PetscCall(
        fluid_.gather(pore_frame(false), pore_conditions_, filling_, start_velocity_.data(), velocity_.data() + nodes));
    std::copy_n(velocity_.begin() + nodes, nodes * (velocity_fields<Phases> - 1), start_velocity_.begin() + nodes);
    std::copy_n(velocity_.begin(), nodes * velocity_fields<Phases>, before_.begin());
  }
  if (relaxes()) {
    PetscCall(back_and_forth(start_velocity_.data(), mapped_start_.data()));
    for (int i = 0; i < nodes * velocity_fields<Phases>; ++i)
      for (int d = 0; d < dim; ++d) mapped_start_[i][d] = start_velocity_[i][d] - mapped_start_[i][d];
  }
  if constexpr (Phases::prescribed) {
    PetscCall(gather_pore_water());
    sample_time_[1] = -std::numeric_limits<double>::infinity();
  }
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (nonlocal_[b]) PetscCall(nonlocal_[b]->begin(grid_, points_[b]));
  if (transfer_.average_stress)
    for (size_t b = 0; b < bodies_.size(); ++b) {
      if (!strength_varies(bodies_[b]->law()))
        continue;  // the mean of admissible stresses is admissible where strength is uniform
      const PointSet &p = points_[b];
      admit_stress<dim>(bodies_[b]->law(), {p.count, p.stress, seen_history(b), p.stress, p.history, p.cell,
                                            increment_.data(), softening_size(b), find_suction(b)});
      if (nonlocal_[b]) nonlocal_[b]->restore(p, p.history);
    }
  PetscFunctionReturn(0);
}

/// What the cells are made of: rho c_p and rho c_s, weighted by volume.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::measure_impedance() {
  for (int c = 0; c < grid_.cell_count(); ++c) impedance_[c] = {0, 0};
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const double wave = constrained_modulus(bodies_[b]->law()), shear = shear_modulus(bodies_[b]->law());
    for (int q = 0; q < points_[b].count; ++q) {
      const int c = points_[b].cell[q];
      double m = 0;
      for (int k = 0; k < simplex_pairs<dim>; ++k) m += (k <= dim ? 1 : 2) * grid_.mass_matrix[c][k];
      const double density = m / particle_volume_[c], share = points_[b].volume[q] / particle_volume_[c];
      impedance_[c][0] += share * std::sqrt(density * wave), impedance_[c][1] += share * std::sqrt(density * shear);
    }
  }
}

/// Integration volume: the cell's own where its nodes are well filled, that of its particles at the surface, theory
/// (4.5).
template <int dim, class Phases>
void SoilMotion<dim, Phases>::set_weights(const std::vector<double> &nodal) {
  constexpr int width = dim + 2;
  constexpr double ramp_start = dim == 2 ? 0.7 : 0.6, ramp_length = 0.2;
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const auto &node = grid_.shape[c].node;
    double volume = 0, filling = 1e300;
    for (double share : grid_.nodal_share[c]) volume += share;
    for (int i : node) filling = std::min(filling, nodal[i * width + dim + 1] / mesh_.nodal_volume[grid_.mesh_node[i]]);
    double &blend = blend_[c];
    switch (transfer_.integration) {
      case Integration::blended:
        blend = std::clamp((filling - ramp_start) / ramp_length, 0., 1.);
        break;
      case Integration::mixed:
        blend = filling > 0.5 && volume > transfer_.filling * grid_.shape[c].volume;
        break;
      case Integration::cell:
        blend = filling > 0.5;
        break;
      case Integration::particle:
        blend = 0;
        break;
    }
    particle_volume_[c] = volume;
    weight_[c] = volume + blend * (grid_.shape[c].volume - volume);
    slenderness_[c] = 0;
    for (const auto &g : grid_.shape[c].gradient)
      for (double x : g) slenderness_[c] += x * x;
  }
}

/// Share of its own velocity, which no node needs to feel, that a particle has kept since the remap, theory (4.11).
template <int dim, class Phases>
double SoilMotion<dim, Phases>::relaxed(double t) const {
  return relaxation_time_ > 0 ? std::exp(-(t - remap_time_) / relaxation_time_) : 1;
}

/// What the nodes learned, as particles read it; the share of their own velocity that particles keep.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::end(double t, double *share) {
  PetscFunctionBeginUser;
  PetscCall(conditions_.surface_loads().end(grid_, weight_));
  const double flip = *share = transfer_.velocity == Velocity::flip ? relaxed(t) * (1 - transfer_.pic_fraction) : 0;
  for (int i = 0; i < grid_.node_count(); ++i) {
    const Vec<dim> &v = velocity_[i], &v0 = start_velocity_[i], &x = grid_.position[i],
                   &X = mesh_.position[grid_.mesh_node[i]];
    for (int d = 0; d < dim; ++d) {
      update_.velocity[i][d] = v[d] - flip * v0[d];
      update_.displacement[i][d] = x[d] - X[d];
    }
  }
  if (transfer_.velocity == Velocity::apic) {
    affine_.resize(static_cast<size_t>(mesh_.cell_count()) * dim * dim);
    for (int c = 0; c < grid_.cell_count(); ++c)
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) {
          double g = 0;
          for (int k = 0; k < dim; ++k)
            g += (velocity_[grid_.shape[c].node[k + 1]][i] - velocity_[grid_.shape[c].node[0]][i]) *
                 mesh_.cells[grid_.mesh_cell[c]].gradient[k][j];
          affine_[(c * dim + i) * dim + j] = g;
        }
  }
  if constexpr (Phases::liquid)
    fluid_.hand_over(grid_.node_count(), velocity_.data() + grid_.node_count(),
                     start_velocity_.data() + grid_.node_count(), flip, update_);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
void SoilMotion<dim, Phases>::forget() {
  for (PointSet &points : points_) {
    for (int c = 0; c < grid_.cell_count(); ++c) points.of_cell[grid_.mesh_cell[c]] = -1;
    points.count = 0;
  }
  grid_.clear();
  gathered_ = false;
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::release(double t, std::vector<std::vector<int>> &movers) {
  PetscFunctionBeginUser;
  double flip;
  PetscCall(end(t, &flip));
  with_transfer(transfer_, [&]<bool averaged, bool apic>() {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      Pores<dim> pores;
      if constexpr (Phases::liquid) pores = fluid_.pores(b);
      to_particles<dim, averaged, apic, fluids>(
          *bodies_[b], {grid_, update_, flip, affine_.data(), points_[b], pores, change_.data()}, movers[b]);
    }
  });
  forget();
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::release_to_next(double t, std::vector<std::vector<int>> &movers) {
  PetscFunctionBeginUser;
  double flip;
  PetscCall(end(t, &flip));
  std::fill(start_velocity_.begin(), start_velocity_.end(), Vec<dim>{});
  with_transfer(transfer_, [&]<bool averaged, bool apic>() {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      Pores<dim> pores, next;
      if constexpr (Phases::liquid) pores = fluid_.pores(b), next = fluid_.next_pores(b);
      to_next_nodes<dim, averaged, apic, fluids>(
          *bodies_[b], {grid_, update_, flip, affine_.data(), points_[b], pores, change_.data()}, next_grid_,
          start_velocity_.data(), next_points_[b], next, movers[b]);
    }
  });
  forget();
  std::swap(grid_, next_grid_), std::swap(points_, next_points_);
  if constexpr (Phases::liquid) fluid_.turn();
  movers_ = &movers;
  PetscFunctionReturn(0);
}

/// Nodes to particles and back at frozen positions, out = M^-1 M^c in, of the velocities of all phases: the operator
/// form of MUSL, theory (4.9).
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::back_and_forth(const Vec<dim> *in, Vec<dim> *out) {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count(), cells = grid_.cell_count();
  std::fill_n(out, nodes * velocity_fields<Phases>, Vec<dim>{});
  for (int c = 0; c < cells; ++c) {
    const auto &node = grid_.shape[c].node;
    const auto &matrix = grid_.mass_matrix[c];
    for (int first = 0; first < nodes * velocity_fields<Phases>; first += nodes) {
      Quad v[dim + 1], sum[dim + 1];
#pragma GCC unroll 8
      for (int k = 0; k <= dim; ++k) v[k] = load<dim>(in[first + node[k]].data()), sum[k] = quad(matrix[k]) * v[k];
#pragma GCC unroll 8
      for (int k = 0, pair = dim + 1; k <= dim; ++k)
#pragma GCC unroll 8
        for (int l = k + 1; l <= dim; ++l, ++pair)
          sum[k] += quad(matrix[pair]) * v[l], sum[l] += quad(matrix[pair]) * v[k];
#pragma GCC unroll 8
      for (int k = 0; k <= dim; ++k) {
        double *x = out[first + node[k]].data();
        store<dim>(x, load<dim>(x) + sum[k]);
      }
    }
  }
  for (int f = 0; f < velocity_fields<Phases>; ++f) {
    PetscCall(grid_.sum(out[f * nodes].data(), dim));
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) out[f * nodes + i][d] /= grid_.mass[i];
  }
  PetscFunctionReturn(0);
}

}  // namespace talus
