// Implementation of SoilMotion; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>
#include <cstring>

#include "physics/pores/pore_fluid.inl"
#include "physics/soil_motion.h"
#include "physics/largest_frequency.inl"

namespace talus {

/// Elastic energy per volume of a stress as stored.
template <int dim>
double stored_energy(const Law &law, const double *stress) {
  Stress<dim> s;
  static_assert(sizeof s == stress_size<dim> * sizeof(double));
  std::memcpy(&s, stress, sizeof s);
  return elastic_energy<dim>(law, s);
}

template <int dim, class Phases>
SoilMotion<dim, Phases>::SoilMotion(const BackgroundMesh<dim> &mesh, std::vector<std::unique_ptr<Body<dim>>> &bodies,
                                    Conditions<dim> &conditions, const Scene &scene, double relaxation_time, double total_mass,
                                    long long particles, double gravity)
    : mesh_(mesh), bodies_(bodies), conditions_(conditions), transfer_(scene.transfer), pressure_(scene.water, gravity),
      relaxation_time_(relaxation_time), total_mass_(total_mass),
      smallest_mass_(1e-6 * total_mass / static_cast<double>(particles)), grid_(mesh), next_grid_(mesh),
      points_(bodies.size()), next_points_(bodies.size()), fluid_(mesh, bodies, scene) {
  const int nodes = mesh.node_count(), cells = mesh.cell_count();
  force_.assign(nodes, Vec<dim>{});
  for (auto *field : {&start_velocity_, &velocity_, &mapped_start_, &scratch_}) field->assign(nodes * velocity_fields<Phases>, Vec<dim>{});
  if constexpr (Phases::liquid) pore_strain_.resize(cells), before_.resize(velocity_.size()), point_volume_.resize(bodies.size());
  for (const auto &body : bodies) imposes_ = imposes_ || !body->source().body_acceleration.empty();
  if (imposes_) imposed_.assign(nodes, Vec<dim>{});
  held_back_.assign(nodes, Vec<dim>{});
  update_.velocity.assign(nodes, Quad{}), update_.displacement.assign(nodes, Quad{});
  for (int a = 0; a < fluids; ++a) update_.fluid[a].assign(nodes, Quad{});
  if (Phases::given) extra_mass_.assign(nodes, 0);
  for (auto *field : {&particle_volume_, &weight_, &blend_, &filling_, &volume_strain_, &slenderness_}) field->assign(cells, 0);
  increment_.resize(cells), cell_stress_.resize(cells), impedance_.resize(cells);
  patch_weight_.assign(mesh.patch_count, 0), patch_sum_.assign(mesh.patch_count, 0);
  nodal_.assign(static_cast<size_t>(nodes) * (dim + 2), 0);
  for (const auto &body : bodies) suction_matters_ = suction_matters_ || reads_suction(body->law());
  for (const auto &body : bodies) {
    const double length = body->source().averaging_length;
    nonlocal_.push_back(length > 0 ? std::make_unique<NonlocalStrain<dim>>(mesh, length, plastic_strain_field(body->law()), body->history_count())
                                   : nullptr);
  }
  for (auto *all : {&points_, &next_points_})
    for (size_t b = 0; b < bodies.size(); ++b) {
      PointSet &points = (*all)[b];
      points.of_cell.assign(cells, -1);
      if (!transfer_.average_stress) continue;
      points.own_cell.resize(cells), points.own_volume.resize(cells), points.own_limit.resize(cells), points.start_volume.resize(cells);
      points.own_stress.resize(static_cast<size_t>(cells) * components);
      points.own_history.resize(static_cast<size_t>(cells) * bodies[b]->history_count());
      points.start_history.resize(points.own_history.size());
    }
}

// ---- remap ----

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
    to_nodes<dim, averaged, apic, fluids>(*bodies_[b], grid_, start_velocity_.data(), points, pores, movers_ ? &(*movers_)[b] : nullptr);
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
  points.stress = own ? points.own_stress.data() : p.stress, points.history = own ? points.own_history.data() : p.history;
  points.volume = own ? points.own_volume.data() : p.volume, points.limit = own ? points.own_limit.data() : p.initial_volume;
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
  if constexpr (Phases::liquid) fluid_.given = !loading.pore_flow, fluid_.given_ramp = loading.ramp;
  if (gathered_) PetscFunctionReturn(0);
  if (!movers_) std::fill(start_velocity_.begin(), start_velocity_.end(), Vec<dim>{});
  with_transfer(transfer_, [&]<bool averaged, bool apic>() { gather<averaged, apic>(); });
  grid_.enter_shared_nodes();
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
      for (int l = k + 1; l <= dim; ++l, ++pair) nodal_[node[k] * width] += matrix[pair], nodal_[node[l] * width] += matrix[pair];
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
    PetscCall(fluid_.gather(pore_frame(false), pore_conditions_, filling_, start_velocity_.data(), velocity_.data() + nodes));
    std::copy_n(velocity_.begin() + nodes, nodes * (velocity_fields<Phases> - 1), start_velocity_.begin() + nodes);
    std::copy_n(velocity_.begin(), nodes * velocity_fields<Phases>, before_.begin());
  }
  if (relaxes()) {
    PetscCall(back_and_forth(start_velocity_.data(), mapped_start_.data()));
    for (int i = 0; i < nodes * velocity_fields<Phases>; ++i)
      for (int d = 0; d < dim; ++d) mapped_start_[i][d] = start_velocity_[i][d] - mapped_start_[i][d];
  }
  if constexpr (Phases::given) {
    PetscCall(gather_pore_water());
    sample_time_[1] = -std::numeric_limits<double>::infinity();
  }
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (nonlocal_[b]) PetscCall(nonlocal_[b]->begin(grid_, points_[b]));
  if (transfer_.average_stress)
    for (size_t b = 0; b < bodies_.size(); ++b) {
      if (!strength_varies(bodies_[b]->law())) continue;  // the mean of admissible stresses is admissible where strength is uniform
      const PointSet &p = points_[b];
      admit_stress<dim>(bodies_[b]->law(), {p.count, p.stress, seen_history(b), p.stress, p.history, p.cell, increment_.data(), softening_size(b), find_suction(b)});
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

/// Integration volume: the cell's own where its nodes are well filled, that of its particles at the surface, theory (4.5).
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
      case Integration::blended: blend = std::clamp((filling - ramp_start) / ramp_length, 0., 1.); break;
      case Integration::mixed: blend = filling > 0.5 && volume > transfer_.filling * grid_.shape[c].volume; break;
      case Integration::cell: blend = filling > 0.5; break;
      case Integration::particle: blend = 0; break;
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
double SoilMotion<dim, Phases>::end(double t) {
  conditions_.surface_loads().end(grid_);
  const double flip = transfer_.velocity == Velocity::flip ? relaxed(t) * (1 - transfer_.pic_fraction) : 0;
  for (int i = 0; i < grid_.node_count(); ++i) {
    const Vec<dim> &v = velocity_[i], &v0 = start_velocity_[i], &x = grid_.position[i], &X = mesh_.position[grid_.mesh_node[i]];
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
            g += (velocity_[grid_.shape[c].node[k + 1]][i] - velocity_[grid_.shape[c].node[0]][i]) * mesh_.cells[grid_.mesh_cell[c]].gradient[k][j];
          affine_[(c * dim + i) * dim + j] = g;
        }
  }
  if constexpr (Phases::liquid) fluid_.hand_over(grid_.node_count(), velocity_.data() + grid_.node_count(), start_velocity_.data() + grid_.node_count(), flip, update_);
  return flip;
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
  const double flip = end(t);
  with_transfer(transfer_, [&]<bool averaged, bool apic>() {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      Pores<dim> pores;
      if constexpr (Phases::liquid) pores = fluid_.pores(b);
      to_particles<dim, averaged, apic, fluids>(*bodies_[b], {grid_, update_, flip, affine_.data(), points_[b], pores}, movers[b]);
    }
  });
  forget();
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::release_to_next(double t, std::vector<std::vector<int>> &movers) {
  PetscFunctionBeginUser;
  const double flip = end(t);
  std::fill(start_velocity_.begin(), start_velocity_.end(), Vec<dim>{});
  with_transfer(transfer_, [&]<bool averaged, bool apic>() {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      Pores<dim> pores, next;
      if constexpr (Phases::liquid) pores = fluid_.pores(b), next = fluid_.next_pores(b);
      to_next_nodes<dim, averaged, apic, fluids>(*bodies_[b], {grid_, update_, flip, affine_.data(), points_[b], pores}, next_grid_, start_velocity_.data(),
                                                 next_points_[b], next, movers[b]);
    }
  });
  forget();
  std::swap(grid_, next_grid_), std::swap(points_, next_points_);
  if constexpr (Phases::liquid) fluid_.turn();
  movers_ = &movers;
  PetscFunctionReturn(0);
}

/// Nodes to particles and back at frozen positions, out = M^-1 M^c in, of the velocities of all phases: the operator form of MUSL, theory (4.9).
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
        for (int l = k + 1; l <= dim; ++l, ++pair) sum[k] += quad(matrix[pair]) * v[l], sum[l] += quad(matrix[pair]) * v[k];
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

// ---- Lagrangian part ----

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::smooth_volume_strain(const Shape<dim> *shape) {
  PetscFunctionBeginUser;
  const int cells = grid_.cell_count();
  if (transfer_.locking == Locking::patches) {  // F-bar: one mean per patch, weighted as in the forces, theory (4.7)
    for (int c = 0; c < cells; ++c) patch_weight_[grid_.patch[c]] = patch_sum_[grid_.patch[c]] = 0;
    for (int c = 0; c < cells; ++c) patch_weight_[grid_.patch[c]] += weight_[c], patch_sum_[grid_.patch[c]] += weight_[c] * volume_strain_[c];
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
      trial_stress_[b].resize(p.count * components), trial_history_[b].resize(p.count * body.history_count()), trial_volume_[b].resize(p.count);
      stress = trial_stress_[b].data(), history = trial_history_[b].data(), volume = trial_volume_[b].data();
    }
    if (!loading.softening) {
      forgotten_.resize(std::max<size_t>(forgotten_.size(), p.count * body.history_count()));
      history = forgotten_.data();
    }
    update_stress<dim>(body.law(), {p.count, p.stress, seen_history(b), stress, history, p.cell, increment_.data(), softening_size(b), find_suction(b), t - accepted_time_, accepted_time_});
    if (nonlocal_[b]) nonlocal_[b]->restore(p, history);
    if (!loading.softening && !trial) {
      const auto fields = history_fields(body.law());
      for (size_t k = 0; k < fields.size(); ++k)
        for (int q = 0; fields[k].kept && q < p.count; ++q) p.history[q * fields.size() + k] = forgotten_[q * fields.size() + k];
    }
    for (int q = 0; q < p.count; ++q) {
      const int c = p.cell[q];
      volume[q] = std::min(p.volume[q] * exp_small(volume_strain_[c]), body.volume_limit(p.limit[q], history + q * body.history_count()));
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

/// Forces of the stress of the accepted or the trial state on the nodes of this rank, theory (3.6).
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::internal_force(bool trial) {
  PetscFunctionBeginUser;
  const int cells = grid_.cell_count();
  const Shape<dim> *shape = trial ? trial_shape_.data() : grid_.shape.data();
  const double *particle_volume = trial ? trial_particle_volume_.data() : particle_volume_.data();
  const double *weight = trial ? trial_weight_.data() : weight_.data();
  std::fill_n(cell_stress_.begin(), cells, std::array<double, components>{});
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PointSet &p = points_[b];
    const double *stress = trial ? trial_stress_[b].data() : p.stress, *volume = trial ? trial_volume_[b].data() : p.volume;
    for (int q = 0; q < p.count; ++q) {
      auto &sum = cell_stress_[p.cell[q]];
      const double share = volume[q] / particle_volume[p.cell[q]];
      for (int s = 0; s < components; ++s) sum[s] += share * stress[q * components + s];
    }
  }
  if (transfer_.locking == Locking::patches) {
    for (int c = 0; c < cells; ++c) patch_weight_[grid_.patch[c]] = patch_sum_[grid_.patch[c]] = 0;
    for (int c = 0; c < cells; ++c) {
      const auto &s = cell_stress_[c];
      patch_weight_[grid_.patch[c]] += weight[c], patch_sum_[grid_.patch[c]] += weight[c] * (s[0] + s[1] + s[2]) / 3;
    }
    for (int c = 0; c < cells; ++c) {
      auto &s = cell_stress_[c];
      const double correction = patch_sum_[grid_.patch[c]] / patch_weight_[grid_.patch[c]] - (s[0] + s[1] + s[2]) / 3;
      for (int k = 0; k < 3; ++k) s[k] += correction;
    }
  }
  std::fill_n(force_.begin(), grid_.node_count(), Vec<dim>{});
  for (int c = 0; c < cells; ++c) {
    const auto &s = cell_stress_[c];
    const double w = weight[c];
    Vec<dim> first{};
    for (int k = 0; k < dim; ++k) {
      const Vec<dim> &g = shape[c].gradient[k];
      Vec<dim> f;
      if constexpr (dim == 2)
        f = {w * (s[0] * g[0] + s[3] * g[1]), w * (s[3] * g[0] + s[1] * g[1])};
      else
        f = {w * (s[0] * g[0] + s[3] * g[1] + s[5] * g[2]), w * (s[3] * g[0] + s[1] * g[1] + s[4] * g[2]),
             w * (s[5] * g[0] + s[4] * g[1] + s[2] * g[2])};
      for (int d = 0; d < dim; ++d) force_[shape[c].node[k + 1]][d] -= f[d], first[d] += f[d];
    }
    for (int d = 0; d < dim; ++d) force_[shape[c].node[0]][d] += first[d];
  }
  PetscFunctionReturn(0);
}

/// Accelerations that the scene gives per particle, beside gravity.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::add_body_forces(double t) {
  for (const auto &body : bodies_) {
    const auto &given = body->source().body_acceleration;
    if (given.empty()) continue;
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const auto n = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
      const auto &node = grid_.shape[grid_.find_cell(p.cell[i])].node;
      const Vec<dim> &X = p.reference[i];
      for (int d = 0; d < dim; ++d) {
        const double f = p.mass[i] * given[d](X[0], X[1], dim == 3 ? X[dim - 1] : 0, t);
        for (int k = 0; k <= dim; ++k) force_[node[k]][d] += n[k] * f;
      }
    }
  }
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::total_force(double load_time, double ramp, bool trial) {
  PetscFunctionBeginUser;
  PetscCall(internal_force(trial));
  conditions_.surface_loads().add(load_time, grid_, trial ? trial_position_.data() : grid_.position.data(), force_.data());
  if (imposes_) {
    const int nodes = grid_.node_count();
    std::copy_n(force_.begin(), nodes, imposed_.begin());
    add_body_forces(load_time);
    if constexpr (Phases::given) PetscCall(add_pore_pressure(load_time, ramp, trial));
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) imposed_[i][d] = force_[i][d] - imposed_[i][d];
  }
  PetscCall(grid_.sum(force_[0].data(), dim));
  conditions_.add_reactions(force_.data());
  for (int i = 0; i < grid_.node_count(); ++i) {
    const double m = grid_.mass[i] + (Phases::given ? extra_mass_[i] : 0);
    for (int d = 0; d < dim; ++d) force_[i][d] += m * (ramp * loading.gravity[d]);
  }
  if constexpr (Phases::liquid) fluid_.add_to_mixture(pore_frame(trial), pore_conditions_, force_.data());
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::acceleration(double t, const double *u, const double *v, double *a) {
  PetscFunctionBeginUser;
  if (u) PetscCall(deform(t, reinterpret_cast<const Vec<dim> *>(u), true));
  PetscCall(total_force(loading.time_at(t), loading.ramp_at(t), u != nullptr));
  const Vec<dim> *unbalanced = force_.data();
  if (loading.damping > 0) {  // what supports take up is not out of balance: damping must not change their reactions
    std::copy_n(force_.begin(), grid_.node_count(), scratch_.begin());
    conditions_.project(grid_, reinterpret_cast<const Vec<dim> *>(v), scratch_.data());
    unbalanced = scratch_.data();
  }
  if constexpr (Phases::liquid)
    PetscCall(fluid_.drive(pore_frame(u != nullptr), pore_conditions_, force_.data(), reinterpret_cast<Vec<dim> *>(a) + grid_.node_count()));
  for (int i = 0; i < grid_.node_count(); ++i) {
    const double inverse = grid_.mass[i] > smallest_mass_ ? 1 / grid_.mass[i] : 0;  // a lighter node is carried along
    for (int d = 0; d < dim; ++d) {
      const double rest = unbalanced[i][d], power = rest * v[i * dim + d];
      const double held_back = loading.damping * rest * ((power > 0) - (power < 0));
      a[i * dim + d] = inverse * (force_[i][d] - held_back);
      if (loading.damping > 0) held_back_[i][d] = held_back;
    }
  }
  PetscFunctionReturn(0);
}

/// What supports hold of a node in a step gamma: fluids beside the skeleton, where there are any.
template <int dim, class Phases>
typename Conditions<dim>::Inertia SoilMotion<dim, Phases>::inertia(double gamma) const {
  if constexpr (Phases::liquid) return [this, gamma](int i) { return fluid_.inertia(gamma, grid_, pore_conditions_, i); };
  return {};
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::drag(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v);
  if constexpr (Phases::liquid) fluid_.resist(gamma, pore_frame(false), pore_conditions_, velocity, velocity + grid_.node_count());
  conditions_.resolve(loading.time_at(t), gamma, grid_, velocity, inertia(gamma));
  if constexpr (Phases::liquid) fluid_.follow(gamma, pore_frame(false), pore_conditions_, velocity, velocity + grid_.node_count());
  PetscFunctionReturn(0);
}

/// Fluids follow the skeleton where supports hold it; its own velocity stays free, as in the rates.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::resist(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) {
    const int nodes = grid_.node_count();
    Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v), *held = scratch_.data();
    fluid_.resist(gamma, pore_frame(false), pore_conditions_, velocity, velocity + nodes);
    std::copy_n(velocity, nodes, held);
    conditions_.constrain(loading.time_at(t), grid_, held, true);
    fluid_.follow(gamma, pore_frame(false), pore_conditions_, held, velocity + nodes);
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::hold(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v);
  conditions_.resolve(loading.time_at(t), gamma, grid_, velocity, inertia(gamma));
  if constexpr (Phases::liquid) fluid_.constrain(pore_frame(false), pore_conditions_, velocity, velocity + grid_.node_count());
  PetscFunctionReturn(0);
}

/// Imposes on velocities of places, of all phases, what boundaries prescribe.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::constrain(double t, Vec<dim> *v) {
  conditions_.constrain(loading.time_at(t), grid_, v, true);
  if constexpr (Phases::liquid) fluid_.constrain(pore_frame(false), pore_conditions_, v, v + grid_.node_count());
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::map_back(double t, double gamma, double *v, double *w) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v), *mapped = reinterpret_cast<Vec<dim> *>(w);
  const int nodes = grid_.node_count();
  if constexpr (Phases::liquid) {  // drag and walls act on what particles would map back, as after a remap: that becomes the state
    const int all = nodes * velocity_fields<Phases>;
    const double share = relaxes() ? 1 - std::exp(-gamma / relaxation_time_) : 0;
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) scratch_[i][d] = velocity[i][d] - (1 - share) * before_[i][d];
    PetscCall(back_and_forth(scratch_.data(), mapped));
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) mapped[i][d] += (1 - share) * before_[i][d];
    constrain(t, mapped);
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) {
        start_velocity_[i][d] += mapped[i][d] - velocity[i][d];  // particles take the change that is not mapped
        velocity[i][d] = before_[i][d] = mapped[i][d];
      }
    PetscFunctionReturn(0);
  }
  if (relaxes()) {
    PetscCall(back_and_forth(velocity, mapped));
    const double share = 1 - std::exp(-gamma / relaxation_time_);
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) {
        velocity[i][d] += share * (mapped[i][d] - velocity[i][d]);
        mapped[i][d] += mapped_start_[i][d];
      }
    constrain(t, velocity);
  } else {  // the same sum, mapped once
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) scratch_[i][d] = velocity[i][d] - start_velocity_[i][d];
    PetscCall(back_and_forth(scratch_.data(), mapped));
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) mapped[i][d] += start_velocity_[i][d];
  }
  constrain(t, mapped);
  PetscFunctionReturn(0);
}

/// Supports and bases hold the places in every stage; what they take from the velocity is taken once, by `drag` after the step.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::rates(double t, const double *u, const double *v, double *du, double *dv) {
  PetscFunctionBeginUser;
  PetscCall(acceleration(t, u, v, dv));
  const int nodes = grid_.node_count(), all = nodes * velocity_fields<Phases>;
  Vec<dim> *held = scratch_.data(), *mapped = reinterpret_cast<Vec<dim> *>(du), *change = reinterpret_cast<Vec<dim> *>(dv);
  std::copy_n(reinterpret_cast<const Vec<dim> *>(v), all, held);
  constrain(t, held);
  if (relaxes()) {
    PetscCall(back_and_forth(held, mapped));
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) {
        change[i][d] -= (held[i][d] - mapped[i][d]) / relaxation_time_;
        mapped[i][d] += mapped_start_[i][d];
      }
  } else {  // the same sum, mapped once
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) held[i][d] -= start_velocity_[i][d];
    PetscCall(back_and_forth(held, mapped));
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) mapped[i][d] += start_velocity_[i][d];
  }
  constrain(t, mapped);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
double SoilMotion<dim, Phases>::seen_square(const double *x) const {
  double sum = 0;
  for (int f = 0; f < velocity_fields<Phases>; ++f) {
    const Vec<dim> *field = reinterpret_cast<const Vec<dim> *>(x) + f * grid_.node_count();
    for (int c = 0; c < grid_.cell_count(); ++c) {
      const auto &node = grid_.shape[c].node;
      const auto &matrix = grid_.mass_matrix[c];
      for (int d = 0; d < dim; ++d)
        for (int k = 0, pair = dim + 1; k <= dim; ++k) {
          const double xk = field[node[k]][d];
          sum += matrix[k] * xk * xk;
          for (int l = k + 1; l <= dim; ++l, ++pair) sum += 2 * matrix[pair] * xk * field[node[l]][d];
        }
    }
  }
  return sum;
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::accept(double t, const double *u, const double *v) {
  PetscFunctionBeginUser;
  if (transfer_.velocity == Velocity::flip) own_share_ = relaxed(t);
  if (v != velocity_[0].data()) std::copy_n(reinterpret_cast<const Vec<dim> *>(v), grid_.node_count() * velocity_fields<Phases>, velocity_.begin());
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
    const double m = grid_.mass[i] + (Phases::given ? extra_mass_[i] : 0);
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

template <int dim, class Phases>
bool SoilMotion<dim, Phases>::find_broken(Vec<dim> *where) const {
  for (int i = 0; i < grid_.node_count(); ++i)
    for (int d = 0; d < dim; ++d)
      if (!(std::abs(velocity_[i][d]) < 1e149)) {  // its square has no room
        *where = mesh_.position[grid_.mesh_node[i]];
        return true;
      }
  return false;
}

template <int dim, class Phases>
bool SoilMotion<dim, Phases>::find_trouble(Vec<dim> *where, std::string *cause) const {
  for (const auto &body : bodies_) {
    const auto trouble = law_trouble(body->law());
    if (trouble.text.empty()) continue;
    *cause = trouble.text, *where = {};
    for (int i : grid_.shape[trouble.cell].node)
      for (int d = 0; d < dim; ++d) (*where)[d] += mesh_.position[grid_.mesh_node[i]][d] / (dim + 1);
    return true;
  }
  return false;
}

// ---- given pore pressure ----

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::gather_pore_water()
  requires Phases::given
{
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

/// Suction at the stress points of a body, or null where its law reads none. It is what the given pressure falls below zero; a scene
/// without it takes the pressure as it is, theory (2.10).
template <int dim, class Phases>
const double *SoilMotion<dim, Phases>::find_suction(size_t b) {
  if (!reads_suction(bodies_[b]->law())) return nullptr;
  if constexpr (Phases::given) {
    sample_pressure(loading.time);
    const auto [early, late] = sample_shares(loading.time, loading.ramp);
    const PointSet &p = points_[b];
    suction_.resize(std::max<size_t>(suction_.size(), p.count));
    for (int q = 0; q < p.count; ++q) suction_[q] = early * sample_[0].suction[p.cell[q]] + late * sample_[1].suction[p.cell[q]];
    return suction_.data();
  }
  if constexpr (Phases::suction) return fluid_.suction(static_cast<int>(b));
  return nullptr;  // refused at the door
}

/// Samples the given pressure at the nodes now and a few steps ahead; in between it is linear in time.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::sample_pressure(double t)
  requires Phases::given
{
  constexpr double steps_ahead = 16;
  if (t >= sample_time_[0] && t <= sample_time_[1]) return;
  const double step = last_pressure_time_ < t ? t - last_pressure_time_ : 1e-6 * (1 + std::abs(t));
  sample_time_[0] = t, sample_time_[1] = t + steps_ahead * step;
  water_moved_ = pressure_.moves();
  for (int k = 0; k < 2; ++k) {
    auto &sample = sample_[k];
    sample.gradient.resize(mesh_.cell_count()), sample.value.resize(mesh_.cell_count()), sample.nodal.resize(mesh_.node_count());
    for (int i = 0; i < grid_.node_count(); ++i) sample.nodal[i] = pressure_(mesh_.position[grid_.mesh_node[i]], sample_time_[k]);
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
        for (int d = 0; d < dim; ++d) gradient[d] += (sample.nodal[node[a + 1]] - sample.nodal[node[0]]) * cell.gradient[a][d];
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

/// With open water on submerged faces the pore pressure acts as the body force -grad p, which includes the water's weight on the
/// face without knowing where the face is; without it, as a part of the stress, theory (2.8), (2.9).
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::add_pore_pressure(double load_time, double ramp, bool trial)
  requires Phases::given
{
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
          force_[node[k]][d] -= grid_.nodal_share[c][k] * (early * sample_[0].gradient[c][d] + late * sample_[1].gradient[c][d]);
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

// ---- fluids that move ----

template <int dim, class Phases>
typename PoreFluid<dim, Phases>::Frame SoilMotion<dim, Phases>::pore_frame(bool trial)
  requires Phases::liquid
{
  for (size_t b = 0; b < bodies_.size(); ++b) point_volume_[b] = trial ? trial_volume_[b].data() : points_[b].volume;
  Vec<dim> gravity = loading.gravity;
  for (double &g : gravity) g *= loading.ramp;
  return {grid_,  trial ? trial_shape_.data() : grid_.shape.data(), trial ? trial_position_.data() : grid_.position.data(), trial ? trial_weight_.data() : weight_.data(),
          points_, point_volume_.data(), trial ? trial_particle_volume_.data() : particle_volume_.data(), blend_.data(), gravity, loading.time,
          transfer_.average_stress, trial};
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::setup_pores(bool fill)
  requires Phases::liquid
{
  PetscFunctionBeginUser;
  PetscCall(pore_conditions_.setup(mesh_, conditions_.sources(), Phases::suction));
  if (fill) fluid_.fill(0);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PoreReport SoilMotion<dim, Phases>::pores(const Body<dim> &body, int i) const
  requires Phases::liquid
{
  int b = 0;
  while (bodies_[b].get() != &body) ++b;
  const int cell = body.particles().cell[i];
  PoreReport report = fluid_.report(b, transfer_.average_stress ? points_[b].of_cell[cell] : i, grid_.find_cell(cell));
  const auto &node = grid_.shape[grid_.find_cell(cell)].node;
  report.surface = std::count_if(node.begin(), node.end(), [&](int n) { return pore_conditions_.at_surface(n); }) >= dim;
  return report;
}

// ---- what others read ----

template <int dim, class Phases>
void SoilMotion<dim, Phases>::present(const Body<dim> &body, int i, Vec<dim> *position, Vec<dim> *velocity) const {
  const ParticleArrays<dim> &p = body.particles();
  *position = p.position[i], *velocity = p.velocity[i];
  if (!gathered_) return;
  const auto n = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
  const auto &node = grid_.shape[grid_.find_cell(p.cell[i])].node;
  for (double &component : *velocity) component *= own_share_;  // as a remap would find it now
  for (int k = 0; k <= dim; ++k)
    for (int d = 0; d < dim; ++d) {
      (*position)[d] += n[k] * (grid_.position[node[k]][d] - mesh_.position[grid_.mesh_node[node[k]]][d]);
      (*velocity)[d] += n[k] * (velocity_[node[k]][d] - own_share_ * start_velocity_[node[k]][d]);
    }
}

template <int dim, class Phases>
void SoilMotion<dim, Phases>::state(int b, int i, double *stress, double *history, double *volume) const {
  const Body<dim> &body = *bodies_[b];
  const ParticleArrays<dim> &p = body.particles();
  const int count = body.history_count();
  std::copy_n(&p.stress[i * components], components, stress);
  if (count) std::copy_n(&p.history[i * count], count, history);
  *volume = p.volume[i];
  if (!gathered_ || !transfer_.average_stress) return;
  const PointSet &points = points_[b];
  const int q = points.of_cell[p.cell[i]];
  std::copy_n(&points.stress[q * components], components, stress);
  for (int h = 0; h < count; ++h) history[h] += points.history[q * count + h] - points.start_history[q * count + h];
  *volume = std::min(p.volume[i] * points.volume[q] / points.start_volume[q], body.volume_limit(p.initial_volume[i], history));
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::keep(Archive &archive) {
  PetscFunctionBeginUser;
  grid_.keep(archive);
  archive.keep("nodes", start_velocity_, velocity_, mapped_start_, extra_mass_);
  archive.keep("cells", particle_volume_, weight_, blend_, filling_, slenderness_, impedance_);
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PointSet &p = points_[b];
    archive.keep("points", p.count, p.own_cell, p.own_stress, p.own_history, p.own_volume, p.own_limit, p.start_history, p.start_volume, p.of_cell);
    attach(b);
    if (nonlocal_[b]) nonlocal_[b]->keep(archive);
  }
  archive.keep("motion", work_.gravity, work_.imposed, work_.damping, gathered_, remap_time_, accepted_time_, own_share_, moved_, smallest_ratio_, step_ratio_, speed_squared_, sample_time_, last_pressure_time_, water_moved_);
  if constexpr (Phases::given)
    for (Sample &sample : sample_) archive.keep("pressure", sample.gradient, sample.value, sample.nodal);
  archive.keep("fastest mode", mode_);
  PetscCall(conditions_.keep(archive, grid_, impedance_, filling_));
  if (archive.reading()) conditions_.surface_loads().begin(bodies_, grid_);
  if constexpr (Phases::liquid) {
    fluid_.keep(archive);
    before_ = velocity_;
    if (archive.reading()) PetscCall(pore_conditions_.begin(grid_, filling_, fluid_.surface()));
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::balance(double, Balance *sums) {
  PetscFunctionBeginUser;
  double local[4]{}, total[4];
  PetscCall(total_force(loading.time, loading.ramp, false));
  std::copy_n(force_.begin(), grid_.node_count(), scratch_.begin());
  conditions_.project(grid_, velocity_.data(), scratch_.data());
  const auto magnitude = [](const Vec<dim> &x) {
    double s = 0;
    for (double c : x) s += c * c;
    return std::sqrt(s);
  };
  for (int i = 0; i < grid_.node_count(); ++i) {
    if (!mesh_.owned[grid_.mesh_node[i]]) continue;
    local[0] += magnitude(scratch_[i]);
  }
  std::fill_n(force_.begin(), grid_.node_count(), Vec<dim>{});
  conditions_.surface_loads().add(loading.time, grid_, grid_.position.data(), force_.data());
  add_body_forces(loading.time);
  PetscCall(grid_.sum(force_[0].data(), dim));
  conditions_.add_reactions(force_.data());
  for (int i = 0; i < grid_.node_count(); ++i) {
    if (!mesh_.owned[grid_.mesh_node[i]]) continue;
    for (int d = 0; d < dim; ++d) force_[i][d] += grid_.mass[i] * (loading.ramp * loading.gravity[d]);
    local[1] += magnitude(force_[i]);
  }
  // of the particles: nodes also carry modes that no particle feels
  for (const auto &body : bodies_)
    for (int i = 0; i < body->particles().count; ++i) {
      Vec<dim> x, v;
      present(*body, i, &x, &v);
      for (double c : v) local[2] += body->particles().mass[i] * c * c / 2;
    }
  for (size_t b = 0; b < bodies_.size(); ++b)
    for (int q = 0; q < points_[b].count; ++q)
      local[3] += points_[b].volume[q] * stored_energy<dim>(bodies_[b]->law(), &points_[b].stress[q * components]);
  PetscCallMPI(MPI_Allreduce(local, total, 4, MPI_DOUBLE, MPI_SUM, mesh_.comm()));
  *sums = {total[0], total[1], total[2], total[3]};
  PetscFunctionReturn(0);
}

}  // namespace talus
