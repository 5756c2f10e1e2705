// What happens to the bodies as a whole while a run goes on.
#include "simulation/world.h"

#include <petsctime.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/sum.h"
#include "physics/boundary/rigid_bodies.h"
#include "scene/body_source.h"
#include "scene/mesh_source.h"
#include "scene/rayleigh.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "solvers/quasi_static/pore_flow.h"
#include "solvers/quasi_static/thin_bodies.h"

namespace talus {

template <int dim>
void World<dim>::take_out_later_bodies() {
  present = present_at_start();
  if (!std::count(present.begin(), present.end(), 0)) return;
  for (size_t b = 0; b < scene.body.size(); ++b)
    if (!present[b]) require(bodies[b]->resize(0));
  count_particles();
}

template <int dim>
void World<dim>::count_particles() {
  double mine[2]{}, all[2];
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    mine[0] += p.count, mine[1] += sum_of(p.mass, p.count);
  }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, comm);
  particle_count = static_cast<long long>(all[0]), total_mass = all[1];
  count_runs();
}

/// Bodies that come and go: their particles do too.
template <int dim>
void World<dim>::choose_bodies(const Stage &stage, const Clock &clock) {
  if (motion->gathered()) require(release(clock.time));
  const int stride = id_stride();
  for (size_t b = 0; b < bodies.size(); ++b) {
    const std::string &name = scene.body[b].name;
    if (stage.adds(name) && !present[b]) {
      present[b] = 1;
      seed<dim>(*bodies[b], mesh, stride,
                [&](const Vec<dim> &x) { return soil_density(scene.body[b], x, clock.load_time); });
      conditions.surface_loads().seed(*bodies[b], mesh);
      require(bodies[b]->sort(mesh.cell_count()));
    }
    if (stage.removes(name) && present[b]) {
      present[b] = 0;
      require(bodies[b]->resize(0));
    }
  }
  count_particles();
}

template <int dim>
void World<dim>::set_loading(const Stage &stage, double stage_time, const Clock &clock) {
  const double whole_at = stage.gravity_ramp(), ramp = whole_at > 0 ? std::min(1., stage_time / whole_at) : 1;
  const std::array<double, 3> acceleration = scene.acceleration_in(stage);
  std::copy_n(acceleration.begin(), dim, motion->loading.gravity.begin());
  motion->loading.ramp = ramp;
  motion->loading.ramp_rate = ramp < 1 ? 1 / whole_at : 0;
  motion->loading.set_at = clock.time;
  motion->loading.time_rate = stage.hold_loads ? 0 : 1;
  motion->loading.time = clock.load_time;
  motion->loading.damping = stage.damping();
  motion->loading.damping_frequencies = stage.damping_frequencies();
  motion->loading.shaking = stage.shakes() ? &shaking : nullptr;
  motion->loading.shaken_since = clock.time - stage_time;
  motion->loading.in_frame_of_base =
      std::ranges::none_of(conditions.sources(), [](const Source &source) { return source.kind.incoming_wave; });
  motion->loading.softening = stage.softening;
  if (RigidBodies<dim> *rigid = conditions.rigid_bodies()) rigid->set_gravity(motion->loading.gravity_at(clock.time));
  conditions.bases().remember_slip(stage.softening);
  motion->loading.pore_flow = stage.pore_flow;
}

/// Changes between boundaries and the supports that stand in for them; what these bore stays on as a dead load.
template <int dim>
PetscErrorCode World<dim>::fix_dashpots(bool fixed, double time) {
  PetscFunctionBeginUser;
  if (fixed == conditions.uses_stand_ins() || !conditions.has_stand_ins()) PetscFunctionReturn(0);
  if (motion->gathered()) PetscCall(release(time));
  if (!fixed) {
    PetscCall(motion->freeze_reactions(time));
    PetscCall(release(time));
  }
  conditions.use_stand_ins(fixed);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode World<dim>::release(double time, bool to_next) {
  PetscFunctionBeginUser;
  PetscLogDouble start, middle, end;
  PetscCall(PetscTime(&start));
  for (auto &list : movers_) list.clear();
  PetscCall(to_next ? motion->update_particles_and_gather(time, movers_) : motion->update_particles(time, movers_));
  PetscCall(PetscTime(&middle));
  int lost = 0;
  for (size_t b = 0; b < bodies.size(); ++b) {
    PetscCall(relocate<dim>(*bodies[b], mesh, movers_[b], outside_[b]));
    lost |= !outside_[b].empty();
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &lost, 1, MPI_INT, MPI_MAX, comm));
  if (lost) PetscCall(take_out(time));
  count_runs();
  count_movers();
  ++releases_;
  PetscCall(PetscTime(&end));
  breakdown.release += middle - start, breakdown.relocate += end - middle;
  PetscFunctionReturn(0);
}

/// What is said of a particle that leaves faster than soil that falls through all of the mesh could be.
template <int dim>
std::string World<dim>::thrown(double speed) const {
  constexpr double surely = 3;
  if (fastest_fall_ == 0 || !(speed > surely * fastest_fall_)) return "";
  std::ostringstream text;
  text << " at " << rounded(speed) << " m/s, and soil that falls through all of the mesh has " << rounded(fastest_fall_)
       << " m/s: it was thrown, by motion that is not to be trusted. Look at what the soil did before; a smaller "
          "integrator.fraction may help (also with --resume). Otherwise";
  return text.str();
}

template <int dim>
int World<dim>::group_of(int cell, int face) {
  if (face_groups_.empty()) {
    const std::vector<std::string> &names = mesh.group_names();
    for (std::size_t g = 0; g < names.size(); ++g)
      for (const Facet<dim> &facet : mesh.facets(names[g]))
        face_groups_.insert({{facet.cell, facet.face}, static_cast<int>(g)});
  }
  const auto found = face_groups_.find({cell, face});
  return found == face_groups_.end() ? -1 : found->second;
}

/// Particles that left the mesh: out of the bodies and into the ledger, or the end of the run.
template <int dim>
PetscErrorCode World<dim>::take_out(double time) {
  PetscFunctionBeginUser;
  if (scene.mesh->leaving_particles == WhenOutside::stop) {
    size_t b = 0;
    while (b < bodies.size() && outside_[b].empty()) ++b;
    const bool mine = b < bodies.size();
    const std::string place =
        place_of_first<dim>(comm, mine, mine ? bodies[b]->particles().position[outside_[b][0].particle] : Vec<dim>{});
    const double speed = mine ? map<dim>(bodies[b]->particles().velocity[outside_[b][0].particle]).norm() : 0;
    throw MotionFailure("a particle left the mesh near " + place + text_of_first(comm, mine, thrown(speed)) +
                        "; add free space there, or a boundary that keeps soil in, or set mesh.leaving_particles = "
                        "\"remove\", which takes out what leaves (also with --resume)");
  }
  for (size_t b = 0; b < bodies.size(); ++b) {
    std::vector<int> gone;
    for (const auto &[particle, cell, face] : outside_[b]) {
      escaped.enter(*bodies[b], static_cast<int>(b), particle, group_of(cell, face), time);
      gone.push_back(particle);
    }
    size_t before = 0;  // of those that are gone
    for (int &i : movers_[b]) {
      while (before < gone.size() && gone[before] < i) ++before;
      i -= static_cast<int>(before);
    }
    if (!gone.empty()) PetscCall(bodies[b]->remove(gone));
  }
  const EscapedSums now = escaped.settle(comm);
  particle_count -= static_cast<long long>(now.particles), total_mass -= now.mass;
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode World<dim>::sort() {
  PetscFunctionBeginUser;
  PetscLogDouble start, end;
  PetscCall(PetscTime(&start));
  for (auto &body : bodies) PetscCall(body->sort(mesh.cell_count()));
  count_runs();
  PetscCall(PetscTime(&end));
  breakdown.relocate += end - start;
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode World<dim>::check_conservation(double mine_too, double *sum) const {
  PetscFunctionBeginUser;
  double mine[3]{0, 0, mine_too}, all[3];
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    mine[0] += p.count, mine[1] += sum_of(p.mass, p.count);
  }
  PetscCallMPI(MPI_Allreduce(mine, all, 3, MPI_DOUBLE, MPI_SUM, comm));
  *sum = all[2];
  const double round_off = round_off_of_sum(particle_count + static_cast<long long>(escaped.sums().particles),
                                            total_mass + escaped.sums().mass);
  if (all[0] != static_cast<double>(particle_count) || std::abs(all[1] - total_mass) > round_off)
    throw RunFailure("particles were lost or doubled: " + std::to_string(static_cast<long long>(all[0])) +
                     " are there, and there should be " + std::to_string(particle_count));
  PetscFunctionReturn(0);
}

template <int dim>
void World<dim>::reset_displacement(double time) {
  if (motion->gathered()) require(release(time));
  conditions.bases().forget_slip();
  for (const auto &body : bodies) {
    ParticleArrays<dim> &p = body->particles();
    std::copy_n(p.position.data(), p.count, p.reference.data());
    std::fill_n(p.velocity.data(), p.count, Vec<dim>{});
    const auto fields = history_fields(body->law());
    for (size_t k = 0; k < fields.size(); ++k)
      for (int i = 0; !fields[k].kept && i < p.count; ++i) p.history[i * fields.size() + k] = 0;
    for (int a = 0; a < phases.fluids(); ++a) std::fill_n(p.fluid_velocity[a].data(), p.count, Vec<dim>{});
  }
}

template <int dim>
double World<dim>::critical_step_of_cells(double time) {
  require(motion->begin(time));
  double local = std::numeric_limits<double>::infinity(), step;
  for (size_t b = 0; b < bodies.size(); ++b) {
    const PointSet &points = motion->points()[b];
    const Body<dim> &body = *bodies[b];
    const int memory = body.history_count(), field = body.dilation_field();
    // soil is lighter by what it has dilated, and without a cap by its gaps too
    const auto share_of_step = [&](int q) {
      if (!body.capped()) return 1 / std::sqrt(std::max(1., points.volume[q] / points.limit[q]));
      const double dilation = field < 0 ? 0 : points.history[q * memory + field];
      return dilation > 0 ? std::exp(-dilation / 2) : 1;
    };
    const Rayleigh damping = rayleigh(scene.body[b].damping_ratio, motion->loading.damping_frequencies);
    int last = -1;
    double of_cell = 0, of_skeleton = 0;  // of soil as dense as it was
    for (int q = 0; q < points.count; ++q) {
      if (points.cell[q] != last) {
        const int cell = motion->grid().mesh_cell[last = points.cell[q]];
        of_cell = critical_[b](cell), of_skeleton = critical_[b].skeleton(cell);
      }
      const double share = share_of_step(q), omega = 2 / (of_skeleton * share);
      const double rate = damping.mass + damping.stiffness * omega * omega;
      local = std::min(local, rate > 0 ? with_explicit_drag(of_cell * share, rate) : of_cell * share);
    }
  }
  MPI_Allreduce(&local, &step, 1, MPI_DOUBLE, MPI_MIN, comm);
  return step;
}

template <int dim>
double World<dim>::damping_rate(double omega) const {
  double rate = 0;
  for (const BodySource &body : scene.body) {
    const Rayleigh damping = rayleigh(body.damping_ratio, motion->loading.damping_frequencies);
    rate = std::max(rate, damping.mass + damping.stiffness * omega * omega);
  }
  return rate;
}

template <int dim>
std::vector<BodyReport> World<dim>::report() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<int> body_of = bodies_of_cells(mesh, scene);
  const std::vector<char> there = present_at_start();
  for (int &body : body_of)
    if (body >= 0 && !there[body]) body = -1;
  const std::vector<char> thin = find_thin_bodies(mesh, body_of, bodies.size());
  const bool slice = mesh.report().one_element_slice;
  std::vector<BodyReport> reports;
  for (size_t b = 0; b < bodies.size(); ++b) {
    const ParticleArrays<dim> &p = bodies[b]->particles();
    BodyReport report;
    report.name = bodies[b]->name();
    double sums[6]{};             // particles, cells, mass, volume, steps and sizes of cells
    std::array<double, 7> least;  // particles in a cell, lowest and highest corner
    least.fill(infinity);
    struct {
      double step;
      int rank;
    } mine{infinity, 0}, slowest;
    std::array<double, 3> place{};
    for (int i = 0; i < p.count;) {
      const Cell<dim> &cell = mesh.cells[p.cell[i]];
      const int first = i;
      for (; i < p.count && p.cell[i] == p.cell[first]; ++i) sums[2] += p.mass[i], sums[3] += p.volume[i];
      const double step = critical_[b](p.cell[first]), volume = mesh.volume[p.cell[first]];
      sums[0] += i - first, sums[1] += 1, sums[4] += step, sums[5] += std::pow(volume, 1. / dim);
      least[0] = std::min<double>(least[0], i - first);
      Vec<dim> centre{};
      for (int node : cell.node)
        for (int d = 0; d < dim; ++d) {
          const double x = mesh.position[node][d];
          least[1 + d] = std::min(least[1 + d], x), least[4 + d] = std::min(least[4 + d], -x),
                    centre[d] += x / (dim + 1);
        }
      if (step < mine.step) mine.step = step, std::copy_n(centre.begin(), dim, place.begin());
    }
    MPI_Comm_rank(comm, &mine.rank);
    MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_DOUBLE, MPI_SUM, comm);
    MPI_Allreduce(MPI_IN_PLACE, least.data(), 7, MPI_DOUBLE, MPI_MIN, comm);
    MPI_Allreduce(&mine, &slowest, 1, MPI_DOUBLE_INT, MPI_MINLOC, comm);
    MPI_Bcast(place.data(), 3, MPI_DOUBLE, slowest.rank, comm);
    report.particles = static_cast<long long>(sums[0]), report.cells = static_cast<long long>(sums[1]);
    report.mass = sums[2], report.volume = sums[3];
    report.fewest_per_cell = sums[1] > 0 ? static_cast<int>(least[0]) : 0;
    for (int d = 0; d < dim; ++d) report.low[d] = least[1 + d], report.high[d] = -least[4 + d];
    report.critical_step = slowest.step, report.slowest_cell = place;
    report.mean_critical_step = sums[4] / sums[1];
    // the side of a regular simplex of the mean size: sqrt(4 A / sqrt 3), (6 sqrt 2 V)^(1/3), as softening takes it
    report.cell_size = sums[5] / sums[1] * (dim == 2 ? std::sqrt(4 / std::sqrt(3.)) : std::cbrt(6 * std::sqrt(2.)));
    report.strength = strength[b];
    report.one_element_across = thin[b] && !slice;
    reports.push_back(report);
  }
  return reports;
}

/// "particle 12 of body.sand" of this rank, the nearest to a place.
template <int dim>
double World<dim>::largest_displacement() const {
  double square = 0;
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      Vec<dim> x, v;
      motion->present(*body, i, &x, &v);
      square = std::max(square, (map<dim>(x) - map<dim>(p.reference[i])).squaredNorm());
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, &square, 1, MPI_DOUBLE, MPI_MAX, comm);
  return std::sqrt(square);
}

template <int dim>
std::string World<dim>::nearest_particle(const Vec<dim> &where) const {
  double nearest = std::numeric_limits<double>::infinity();
  std::string found = "no particle";
  for (const auto &body : bodies)
    for (int i = 0; i < body->particles().count; ++i) {
      Vec<dim> x, v;
      motion->present(*body, i, &x, &v);
      const double distance = (map<dim>(x) - map<dim>(where)).norm();
      if (distance < nearest)
        nearest = distance, found = "particle " + std::to_string(body->particles().id[i]) + " of body." + body->name();
    }
  return found;
}

template <int dim>
std::vector<Vec<dim>> World<dim>::nodal_displacement() {
  // up to the last remap the mean of the particles around a node, weighted as their velocity is; since then the node's
  // own way
  std::vector<Vec<dim>> u(mesh.node_count(), Vec<dim>{});
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const Cell<dim> &cell = mesh.cells[p.cell[i]];
      const auto n = barycentric(cell, p.position[i]);
      for (int k = 0; k <= dim; ++k)
        for (int d = 0; d < dim; ++d) u[cell.node[k]][d] += n[k] * p.mass[i] * (p.position[i][d] - p.reference[i][d]);
    }
  }
  require(mesh.halo.sum(u.empty() ? nullptr : u[0].data(), dim));
  require(mesh.ties.sum(u.empty() ? nullptr : u[0].data(), dim));
  const FilledGrid<dim> &grid = motion->grid();
  for (int i = 0; i < grid.node_count(); ++i)
    for (int d = 0; d < dim; ++d) {
      double &value = u[grid.mesh_node[i]][d];
      value = value / grid.mass[i] + grid.position[i][d] - mesh.position[grid.mesh_node[i]][d];
    }
  return u;
}

template <int dim>
std::vector<char> World<dim>::strength_varies() const {
  std::vector<char> varies(bodies.size(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const ParticleArrays<dim> &p = bodies[b]->particles();
    for (const double *share : {p.cohesion_share, p.friction_share})
      if (share && std::any_of(share, share + p.count, [](double s) { return s != 1; })) varies[b] = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, varies.data(), static_cast<int>(varies.size()), MPI_CHAR, MPI_MAX, comm);
  return varies;
}

template <int dim>
PetscErrorCode World<dim>::serialize(Archive &archive) {
  PetscFunctionBeginUser;
  double mass = seeded_mass_;
  archive.serialize("world", present, particle_count, total_mass, mass, seeded_particles_, depth_on_bases_);
  if (archive.reading() && mass != seeded_mass_) {  // by round-off, where the mesh was divided in another way then
    const Loading<dim> loading = motion->loading;
    seeded_mass_ = mass;
    make_motion();
    motion->loading = loading;
    PetscCall(motion->setup_pores(false));
  }
  set_friction_delay();
  escaped.serialize(archive);
  if (structures) structures->serialize(archive);
  for (const auto &body : bodies) PetscCall(body->serialize(archive, mesh));
  PetscCall(motion->serialize(archive));
  archive.sums("movers", counts_.movers);
  if (archive.reading()) count_runs();
  PetscFunctionReturn(0);
}

bool has_flow_stages(const Scene &scene) {
  return std::any_of(scene.stage.begin(), scene.stage.end(), [](const Stage &s) { return s.water_flows(); });
}

template class World<2>;
template class World<3>;

}  // namespace talus
