// What others read: particles within the Lagrangian part, checkpoints, balances, trouble; included only where
// SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "base/local_numbers.h"
#include "physics/soil_motion.h"
#include "scene/transfer_source.h"

namespace talus {

template <int dim, class Phases>
bool SoilMotion<dim, Phases>::find_broken(Vec<dim> *where) const {
  for (int i = 0; i < grid_.node_count(); ++i)
    for (int d = 0; d < dim; ++d)
      if (!(std::abs(velocities_.now[i][d]) < 1e149)) {  // its square has no room
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
  const SoilContact<dim> *contact = conditions_.soil_contact();
  if (!contact || !contact->find_crowded(where)) return false;
  *cause =
      "three contact groups meet in one cell, and contact acts between two; give two of them one contact_group, or "
      "keep them a cell apart, by finer cells";
  return true;
}

/// Where the fluids find a state of the soil at time t.
template <int dim, class Phases>
typename PoreFluid<dim, Phases>::Frame SoilMotion<dim, Phases>::pore_frame(double t,
                                                                           const State &state) requires Phases::liquid {
  return {.grid = grid_,
          .shape = state.shape,
          .position = state.position,
          .weight = state.weight.data(),
          .points = points_,
          .volume = state.volume.data(),
          .particle_volume = state.particle_volume.data(),
          .blend = filling_.blend.data(),
          .gravity = loading.gravity_at(t),
          .filling_gravity = pore_conditions_.filling_gravity(loading.gravity_at(t)),
          .time = loading.time_at(t),
          .averaged = transfer_.average_stress,
          .trial = is_trial(state)};
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::start_pores(bool fill) requires Phases::liquid {
  PetscFunctionBeginUser;
  PetscCall(pore_conditions_.setup(mesh_, conditions_.sources(), Phases::suction, fluid_.vertical(), fluid_.upward()));
  if (fill) fluid_.fill(0);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PoreReport SoilMotion<dim, Phases>::pore_report(const Body<dim> &body, int i) const requires Phases::liquid {
  int b = 0;
  while (bodies_[b].get() != &body) ++b;
  const int mesh_cell = body.particles().cell[i], cell = grid_.find_cell(mesh_cell);
  const auto &node = grid_.shape[cell].node;
  const bool surface =
      std::count_if(node.begin(), node.end(), [&](int n) { return pore_conditions_.at_surface(n); }) >= dim;
  return fluid_.report(b, transfer_.average_stress ? points_[b].find(mesh_cell) : i, cell, surface);
}

template <int dim, class Phases>
CellMotion<dim> SoilMotion<dim, Phases>::cell_motion(int mesh_cell) const {
  CellMotion<dim> motion;
  if (!gathered_) return motion;
  motion.own_share = velocities_.own_share;  // as a remap would find it now
  const auto &node = grid_.shape[grid_.find_cell(mesh_cell)].node;
  for (int k = 0; k <= dim; ++k)
    for (int d = 0; d < dim; ++d) {
      motion.way[k][d] = grid_.position[node[k]][d] - mesh_.position[grid_.mesh_node[node[k]]][d];
      motion.gain[k][d] = velocities_.now[node[k]][d] - velocities_.own_share * velocities_.start[node[k]][d];
    }
  return motion;
}

template <int dim, class Phases>
void SoilMotion<dim, Phases>::present(const Body<dim> &body, int i, Vec<dim> *position, Vec<dim> *velocity) const {
  const ParticleArrays<dim> &p = body.particles();
  const auto n = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
  const CellMotion<dim> motion = cell_motion(p.cell[i]);
  *position = motion.position(n, p.position[i]), *velocity = motion.velocity(n, p.velocity[i]);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::begin_results(double t) {
  PetscFunctionBeginUser;
  PetscCall(begin(t));
  PetscCall(find_moving(t, velocities_.now.data(), velocities_.own_share, Phases::liquid));
  PetscFunctionReturn(0);
}

/// Velocity, into `velocities_.moving`, at which nodes move that have the velocity `v` at time t, docs/theory (4.9);
/// `mapped`: it is mapped back already. `own` is the share of the start that is not mapped.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::find_moving(double t, const Vec<dim> *v, double own, bool mapped) {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count();
  std::vector<Vec<dim>> &moving = velocities_.moving;
  std::copy_n(v, nodes, moving.begin());
  if (!mapped) {
    for (int i = 0; i < nodes; ++i) add_scaled<dim>(moving[i], -own, velocities_.start[i]);
    std::copy_n(moving.begin(), nodes, scratch_.begin());
    PetscCall((talus::to_particles_and_back<dim, 1>(grid_, scratch_.data(), moving.data())));
    for (int i = 0; i < nodes; ++i) add_scaled<dim>(moving[i], own, velocities_.start[i]);
  }
  conditions_.constrain(loading.time_at(t), grid_, moving.data(), true);
  conditions_.follow_contacts(moving.data());
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
Vec<dim> SoilMotion<dim, Phases>::moving_velocity(const Body<dim> &body, int i) const {
  const ParticleArrays<dim> &p = body.particles();
  const auto n = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
  const auto &node = grid_.shape[grid_.find_cell(p.cell[i])].node;
  Vec<dim> v{};
  for (int k = 0; k <= dim; ++k) add_scaled<dim>(v, n[k], velocities_.moving[node[k]]);
  return v;
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
  const int q = points.find(p.cell[i]);
  std::copy_n(&points.stress[q * components], components, stress);
  for (int h = 0; h < count; ++h) history[h] += points.history[q * count + h] - points.start_history[q * count + h];
  *volume = body.admissible_volume(p.volume[i] * points.volume[q] / points.start_volume[q], p.rest_volume[i], history);
}

template <int dim, class Phases>
SofteningInput SoilMotion<dim, Phases>::softened_by(int b, int i) const {
  const Body<dim> &body = *bodies_[b];
  const ParticleArrays<dim> &p = body.particles();
  const int count = body.history_count(), field = plastic_strain_field(body.law());
  SofteningInput found{0, element_size<dim>(mesh_.volume[p.cell[i]])};
  if (field < 0) return found;
  found.plastic_strain = p.history[i * count + field];
  if (!gathered_) return found;
  const PointSet &points = points_[b];
  const int q = transfer_.average_stress ? points.find(p.cell[i]) : i;
  found.plastic_strain = points.history[q * count + field];
  if (softening_.averages(b)) found.plastic_strain += softening_.excess(b)[q], found.size = 2 * body.averaging_length();
  return found;
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::serialize(Archive &archive) {
  PetscFunctionBeginUser;
  const typename FilledGrid<dim>::Rows grid = grid_.serialize(archive);
  for (int field = 0; field < fields; ++field) {
    const int first = field * grid_.node_count();
    archive.column(grid.nodes, "velocity at the remap", velocities_.start.data() + first, sizeof(Vec<dim>));
    archive.column(grid.nodes, "velocity", velocities_.now.data() + first, sizeof(Vec<dim>));
    archive.column(grid.nodes, "unmapped velocity", velocities_.unmapped_start.data() + first, sizeof(Vec<dim>));
    if constexpr (fields > 1)
      archive.column(grid.nodes, "velocity before", velocities_.before_step.data() + first, sizeof(Vec<dim>));
  }
  archive.serialize("velocities", velocities_.remap_time, velocities_.own_share);
  archive.column(grid.cells, "particle volume", accepted_.particle_volume);
  archive.column(grid.cells, "weight", accepted_.weight);
  filling_.serialize(archive, grid.cells);
  if (archive.reading()) filling_.find_divided(grid_);
  std::vector<Archive::Rows> points(bodies_.size());
  for (size_t b = 0; b < bodies_.size(); ++b) {
    points[b] = serialize_points(archive, b);
    softening_.serialize(b, archive, grid_, grid, points[b]);
  }
  accepted_.refer_to(grid_);
  archive.serialize("motion", gathered_, accepted_time_);
  measures_.serialize(archive);
  work_.serialize(archive);
  if constexpr (Phases::prescribed) water_.serialize(archive, grid_, grid);
  fastest_mode_.serialize(archive);
  PetscCall(conditions_.serialize(archive, grid_, filling_.impedance, filling_.share));
  if (archive.reading()) conditions_.surface_loads().begin(bodies_, grid_);
  if constexpr (Phases::liquid) {
    fluid_.serialize(archive, grid, points);
    PressureSolves &done = implicit_.done;
    archive.serialize("pressure solves", done.steps, done.iterations, done.most_iterations, done.unsolved, done.worst);
    if (implicit_.acts) archive.column(grid.nodes, "change of pore pressure", implicit_.before);
    if (archive.reading() && implicit_.acts) implicit_.number_nodes(grid_), implicit_.matrices.begin(grid_);
    if (archive.reading())
      PetscCall(pore_conditions_.begin(grid_, filling_.share, fluid_.surface(), fluid_.surface_moment()));
  }
  PetscFunctionReturn(0);
}

/// Stress points of a body, as rows of their cells.
template <int dim, class Phases>
Archive::Rows SoilMotion<dim, Phases>::serialize_points(Archive &archive, size_t b) {
  PointSet &p = points_[b];
  std::vector<long long> cells;
  for (int q = 0; q < p.count; ++q) cells.push_back(mesh_.global_cell[grid_.mesh_cell[p.own_cell[q]]]);
  const Archive::Rows rows = archive.rows("stress points", Belongs::to_cells, cells);
  if (archive.reading()) {
    p.own_cell.resize(std::max(p.own_cell.size(), cells.size()));
    p.make_room_in(mesh_.cell_count()), p.count = 0;
    const LocalNumbers cell_of(mesh_.global_cell);
    for (const long long number : cells) {
      const int cell = cell_of(number), compact = grid_.find_cell(cell);
      if (transfer_.average_stress)
        p.enter(cell, compact);
      else
        p.own_cell[p.count++] = compact;
    }
  }
  if (transfer_.average_stress) {
    const int history = bodies_[b]->history_count();
    archive.column(rows, "stress", p.own_stress, components);
    archive.column(rows, "history", p.own_history, history);
    archive.column(rows, "history at the remap", p.start_history, history);
    archive.column(rows, "volume", p.own_volume);
    archive.column(rows, "volume at the remap", p.start_volume);
    archive.column(rows, "rest volume", p.own_limit);
    if (reads_shares(bodies_[b]->law())) {
      archive.column(rows, "share of cohesion", p.own_cohesion_share);
      archive.column(rows, "share of friction", p.own_friction_share);
    }
  }
  refer_to_points(b);
  return rows;
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::balance(double t, Balance *sums) {
  PetscFunctionBeginUser;
  double local[5 + dim]{}, total[5 + dim];
  PetscCall(total_force(loading.set_at, accepted_));
  std::copy_n(force_.begin(), grid_.node_count(), scratch_.begin());
  conditions_.project(velocities_.now.data(), scratch_.data());
  const auto magnitude = [](const Vec<dim> &x) {
    double s = 0;
    for (double c : x) s += c * c;
    return std::sqrt(s);
  };
  for (int i = 0; i < grid_.node_count(); ++i) {
    if (!mesh_.counted[grid_.mesh_node[i]]) continue;
    local[0] += magnitude(scratch_[i]);
  }
  std::fill_n(force_.begin(), grid_.node_count(), Vec<dim>{});
  conditions_.surface_loads().add(loading.time, grid_, grid_.position.data(), force_.data());
  add_body_forces(loading.time);
  PetscCall(grid_.sum(force_[0].data(), dim));
  conditions_.add_reactions(force_.data());
  const Vec<dim> gravity = loading.gravity_at(loading.set_at);
  for (int i = 0; i < grid_.node_count(); ++i) {
    if (!mesh_.counted[grid_.mesh_node[i]]) continue;
    for (int d = 0; d < dim; ++d) force_[i][d] += grid_.mass[i] * gravity[d];
    local[1] += magnitude(force_[i]);
  }
  // of the particles: nodes also carry modes that no particle feels
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    CellMotion<dim> motion;
    for (int i = 0; i < p.count; ++i) {
      if (i == 0 || p.cell[i] != p.cell[i - 1]) motion = cell_motion(p.cell[i]);
      const auto n = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
      const Vec<dim> x = motion.position(n, p.position[i]), v = motion.velocity(n, p.velocity[i]);
      local[2] += p.mass[i] * dot<dim>(v, v) / 2;
      for (int d = 0; d < dim; ++d) local[5 + d] += p.mass[i] * x[d];
    }
  }
  // over the volumes that the forces have: work and what it stores would else differ
  for (size_t b = 0; b < bodies_.size(); ++b)
    for (int q = 0; q < points_[b].count; ++q) {
      const int c = points_[b].cell[q];
      const double volume = points_[b].volume[q] * (accepted_.weight[c] / accepted_.particle_volume[c]);
      local[3] += volume * stored_energy<dim>(bodies_[b]->law(), &points_[b].stress[q * components]);
    }
  PetscCall(find_moving(t, velocities_.now.data(), velocities_.own_share, Phases::liquid));
  local[4] = talus::seen_square<dim, 1>(grid_, velocities_.moving.data());
  PetscCallMPI(MPI_Allreduce(local, total, 5 + dim, MPI_DOUBLE, MPI_SUM, mesh_.comm()));
  *sums = {total[0], total[1], total[2], total[3], {}, total[4]};
  std::copy_n(total + 5, dim, sums->moment.begin());
  PetscFunctionReturn(0);
}

}  // namespace talus
