// From the scene to the first state: mesh, bodies, boundaries; and what happens to the bodies as a whole.
#include "simulation/world.h"

#include <petsctime.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/freed_memory.h"
#include "base/sum.h"
#include "scene/reader.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {

template <int dim>
World<dim>::World(MPI_Comm world, const Scene &of, DM plex, const std::string &mesh_file, const Cuts &cuts)
    : scene(of),
      phases(phase_traits(of.phases)),
      comm(world),
      pressure(of),
      rates_(WorkRates::with(of.transfer.average_stress)) {
  read_laws();
  std::vector<Source> sources = read_sources();
  read_mesh(plex, mesh_file, cuts);
  check_bodies();
  find_strengths();
  check_boundaries(sources);
  require(conditions.setup(mesh, std::move(sources)));
  conditions.use_stand_ins(scene.stage.front().hold_loads);
  pressure.set_regions(bodies_of_cells(mesh, scene));
  set_pore_pressure_ratios();
  seed_bodies();
  close_bases();                                 // from now on: soil has to be drawn inside
  set_loading(scene.stage.front(), 0, Clock{});  // under which the first state is gathered
  if (const std::string fault = function_fault(); !fault.empty()) throw SceneError(fault);
  hand_back_freed_memory();
}

template <int dim>
std::string World<dim>::function_fault() const {
  const std::string mine = scene.function_fault();
  return text_of_first(comm, !mine.empty(), mine);
}

template <int dim>
void World<dim>::read_laws() {
  for (const BodySource &body : scene.body) {
    laws.push_back(read_law(body.law));
    const std::string problem = law_problem(laws.back(), dim);
    if (!problem.empty()) scene.complain("body." + body.name, "cannot be used: " + problem);
    if (body.averaging_length > 0 && plastic_strain_field(laws.back()) < 0)
      scene.complain("body." + body.name + ".averaging_length",
                     "needs a law that remembers a plastic_strain, not " + std::string(law_name(laws.back())));
  }
}

/// Least and largest strength of each body over the places where particles and Gauss points may lie; laws that a
/// function of place gives their strength take the largest. Complains where a value is none. Collective.
template <int dim>
void World<dim>::find_strengths() {
  const std::vector<int> body_of = bodies_of_cells(mesh, scene);
  for (size_t b = 0; b < laws.size(); ++b) {
    const BodySource &source = scene.body[b];
    const std::string path = "body." + source.name;
    StrengthRange range = strength_of(laws[b]);
    const StrengthByPlace functions(source.law, laws[b]);
    if (functions.given()) {
      std::vector<Barycentric<dim>> places;
      const auto add = [&](const std::vector<Barycentric<dim>> &more) {
        places.insert(places.end(), more.begin(), more.end());
      };
      for (const int order : {1, 2}) add(stress_quadrature<dim>(order).point);
      add(lattice<dim>(particles_per_cell<dim>(source)));
      for (const DenseBox &box : source.dense) add(lattice<dim>(box.particles_per_cell));
      for (int c = 0; c < mesh.cell_count(); ++c)
        for (size_t k = 0; body_of[c] == static_cast<int>(b) && k < places.size(); ++k) {
          const Vec<dim> where = place_in(mesh, c, places[k]);
          functions.widen(range, where[0], where[1], dim == 3 ? where[dim - 1] : 0);
        }
      if (const std::string fault = function_fault(); !fault.empty()) throw SceneError(fault);
      double ends[4] = {-range.cohesion[0], range.cohesion[1], -range.friction_angle[0], range.friction_angle[1]};
      for (double &end : ends)
        if (std::isnan(end)) end = std::numeric_limits<double>::lowest();  // no cell on this rank
      MPI_Allreduce(MPI_IN_PLACE, ends, 4, MPI_DOUBLE, MPI_MAX, comm);
      range = {{-ends[0], ends[1]}, {-ends[2], ends[3]}};
      const bool empty = ends[0] == std::numeric_limits<double>::lowest();  // which seed_bodies() refuses
      const std::string problem = empty ? "" : take_largest(laws[b], range);
      const size_t key_ends = problem.find(' ');
      if (!problem.empty())
        scene.complain(path + "." + problem.substr(0, key_ends), problem.substr(key_ends + 1) + ", its largest value");
    }
    strength.push_back(range);
  }
}

/// Boundaries of pore water in a drained scene belong to its seepage stages alone: the motion takes the pressure that
/// they find.
template <int dim>
std::vector<typename World<dim>::Source> World<dim>::read_sources() {
  std::vector<Source> sources;
  const bool apart = phases.prescribed && has_flow_stages(scene);
  for (const BoundarySource &b : scene.boundary) {
    const Boundary kind = read_boundary(b.kind);
    const bool seeps = apart && kind.fluids_only() && !kind.needs_gas();
    (seeps ? seepage_sources : sources).push_back({b.name, b.group, kind});
  }
  return sources;
}

template <int dim>
void World<dim>::read_mesh(DM plex, const std::string &mesh_file, const Cuts &cuts) {
  std::vector<std::pair<std::string, double>> weights;
  SeedCounts seeds{{}, id_stride()};
  for (const BodySource &body : scene.body)
    for (const std::string &region : body.region) {
      weights.emplace_back(region, rates_.of_cell(particles_per_cell<dim>(body)));
      seeds.per_cell.emplace_back(region, particles_per_cell<dim>(body));
    }
  if (plex)
    mesh = BackgroundMesh<dim>::adopt(plex);
  else
    try {
      mesh = BackgroundMesh<dim>::read(comm, mesh_file, weights, cuts, scene.mesh.halvings, seeds);
    } catch (const std::invalid_argument &error) {
      scene.complain(!scene.mesh.file.empty()      ? "mesh.file"
                     : !scene.mesh.section.empty() ? "mesh.section"
                                                   : "mesh.terrain",
                     std::string("cannot serve: ") + error.what());
    }
  comm = mesh.comm();
}

template <int dim>
double World<dim>::soil_density(const BodySource &source, const Vec<dim> &x, double t) const {
  if (source.density > 0 && !phases.liquid) return source.density;
  const int soil = static_cast<int>(&source - scene.body.data());
  double density = (1 - source.porosity) *
                   source.grain_density;  // where fluids move on their own, particles' mass is that of the grains
  if (phases.prescribed) density += source.porosity * scene.water.density * pressure.saturation(source, x, t, soil);
  return density;
}

template <int dim>
typename Overburden<dim>::Block World<dim>::block_of(const BodySource &source, int cell, double water,
                                                     double load_time) const {
  typename Overburden<dim>::Block block;
  Vec<dim> centre{};
  for (int a = 0; a <= dim; ++a) {
    block.corner[a] = mesh.position[mesh.cells[cell].node[a]];
    for (int d = 0; d < dim; ++d) centre[d] += block.corner[a][d] / (dim + 1);
  }
  block.unit_weight = -scene.gravity[scene.vertical()] * (soil_density(source, centre, load_time) + water);
  return block;
}

/// In bodies with a pore pressure ratio r_u the pressure is r_u times the weight of the soil above, as it lies at the
/// start (Bishop and Morgenstern 1960), linear in cells.
template <int dim>
void World<dim>::set_pore_pressure_ratios() {
  if (std::none_of(scene.body.begin(), scene.body.end(), [](const BodySource &b) { return b.pore_pressure_ratio > 0; }))
    return;
  const std::vector<int> body_of = bodies_of_cells(mesh, scene);
  const std::vector<char> there = present_at_start();
  std::vector<typename Overburden<dim>::Block> blocks;
  for (int c = 0; c < mesh.cell_count(); ++c)
    if (body_of[c] >= 0 && there[body_of[c]]) blocks.push_back(block_of(scene.body[body_of[c]], c, 0, 0));
  const Overburden<dim> overburden(mesh, blocks, scene.vertical());
  for (int b = 0; b < static_cast<int>(scene.body.size()); ++b) {
    const double ratio = scene.body[b].pore_pressure_ratio;
    if (ratio == 0) continue;
    std::vector<double> cells;
    for (int c = 0; c < mesh.cell_count(); ++c) {
      if (body_of[c] != b) continue;
      Vec<dim> centre{};
      for (const int node : mesh.cells[c].node)
        for (int d = 0; d < dim; ++d) centre[d] += mesh.position[node][d] / (dim + 1);
      for (const int node : mesh.cells[c].node) {
        const Vec<dim> &x = mesh.position[node];
        constexpr double aside = 1e-7;  // into the cell, since soil may end at x
        Vec<dim> near = x;
        for (int d = 0; d < dim; ++d)
          if (d != scene.vertical()) near[d] += aside * (centre[d] - x[d]);
        double top;
        cells.insert(cells.end(), x.begin(), x.end());
        cells.push_back(ratio * overburden.above(near, &top));
      }
    }
    auto field = std::make_shared<CellPressure<dim>>(comm, cells);
    pressure.take_of(b, [field](const double *x) { return (*field)(x); });
  }
}

/// Numbers of particles in a cell are below it, whatever boxes and stages add.
template <int dim>
int World<dim>::id_stride() const {
  int stride = 1;
  for (const BodySource &source : scene.body) {
    stride = std::max(stride, particles_per_cell<dim>(source));
    for (const DenseBox &box : source.dense) stride = std::max(stride, box.particles_per_cell);
  }
  return stride;
}

/// Cells in the regions of some bodies.
template <int dim>
std::vector<char> World<dim>::cells_of_bodies(const std::function<bool(size_t body)> &which) const {
  std::vector<char> cells(mesh.cell_count(), 0);
  for (size_t b = 0; b < scene.body.size(); ++b)
    for (const std::string &region : scene.body[b].region)
      for (int cell : mesh.region(region)) cells[cell] = which(b);
  return cells;
}

/// What bodies need of the mesh as it is divided now.
template <int dim>
void World<dim>::settle_bodies() {
  conditions.surface_loads().share(mesh, cells_of_bodies([](size_t) { return true; }));
  smallest_altitude_ = mesh.report().smallest_altitude;
  critical_.clear();
  for (size_t b = 0; b < scene.body.size(); ++b) {
    const BodySource &source = scene.body[b];
    const double density = soil_density(source, Vec<dim>{}, 0);
    wave_speed_ = std::max(wave_speed_, std::sqrt(constrained_modulus(laws[b]) / density));
    critical_.emplace_back(mesh, laws[b], density, pore_stiffness(scene, source, phases.fluids()));
  }
}

template <int dim>
void World<dim>::close_bases() {
  for (const auto &source : conditions.sources())
    if (source.kind.keeps_soil_inside())
      for (const std::string &group : source.groups) mesh.close(group);
}

template <int dim>
void World<dim>::make_motion() {
  const double relaxation = scene.transfer.relaxation * smallest_altitude_ / wave_speed_;
  motion = make_soil_motion(
      MotionParts<dim>{mesh, bodies, conditions, scene, pressure, relaxation, seeded_mass_, seeded_particles_});
}

/// Ways of a wave while friction adapts, docs/theory (6.2): in units of the altitude, and across elastic soil and back.
template <int dim>
void World<dim>::set_friction_delay() {
  constexpr double shortest_way = 10, across_and_back = 2;
  conditions.bases().set_friction_delay(std::max(shortest_way * smallest_altitude_, across_and_back * depth_on_bases_) /
                                        wave_speed_);
}

template <int dim>
void World<dim>::seed_bodies() {
  const int stride = id_stride();
  SurfaceLoads<dim> &loads = conditions.surface_loads();
  settle_bodies();
  movers_.resize(scene.body.size()), outside_.resize(scene.body.size());
  for (size_t b = 0; b < scene.body.size(); ++b) {
    const BodySource &source = scene.body[b];
    bodies.push_back(std::make_unique<Body<dim>>());
    Body<dim> &body = *bodies.back();
    require(body.create(comm, source, laws[b], phases.fluids(), loads.face_count()));
    seed<dim>(body, mesh, stride, [&](const Vec<dim> &x) { return soil_density(source, x, 0); });
    loads.seed(body, mesh);
    double sums[2] = {static_cast<double>(body.particles().count), 0}, totals[2];
    sums[1] = sum_of(body.particles().mass, body.particles().count);
    MPI_Allreduce(sums, totals, 2, MPI_DOUBLE, MPI_SUM, comm);
    const std::string path = "body." + source.name;
    if (totals[0] == 0) scene.complain(path, "is empty: its regions have no cells");
    check_seeded(body, path);
    particle_count += static_cast<long long>(totals[0]), total_mass += totals[1];
    if (!source.displacement.empty())
      for (int i = 0; i < body.particles().count; ++i) movers_[b].push_back(i);
    require(relocate<dim>(body, mesh, movers_[b], outside_[b]));
    const bool lost = !outside_[b].empty();
    const std::string outside =
        place_of_first<dim>(comm, lost, lost ? body.particles().position[outside_[b][0]] : Vec<dim>{});
    if (!outside.empty()) scene.complain(path + ".displacement", "takes particles out of the mesh near " + outside);
    require(body.sort(mesh.cell_count()));
  }
  const int idle = loads.find_idle(comm, bodies);
  if (idle >= 0)
    scene.complain("boundary." + conditions.sources()[idle].name + ".kind",
                   "is a load on a face without soil behind it at the start; name a group on the surface of a body");
  const int cancelled =  // by soil that is there from the start to the end
      loads.find_cancelled(mesh, cells_of_bodies([&](size_t b) { return !comes_or_goes(scene.body[b]); }));
  if (cancelled >= 0)
    scene.complain("boundary." + conditions.sources()[cancelled].name + ".kind",
                   "is a pressure on a face inside the soil, where it cancels: it pushes with the same force on both "
                   "sides. Draw a crack as a gap in the outline of the section, and name a wall of it");
  require(conditions.bases().find_depth(mesh, cells_of_bodies([&](size_t b) { return never_fails(laws[b]); }),
                                        &depth_on_bases_));
  set_friction_delay();
  seeded_mass_ = total_mass, seeded_particles_ = particle_count;
  make_motion();
  require(motion->setup_pores(true));
}

/// Does a stage add or remove the body?
template <int dim>
bool World<dim>::comes_or_goes(const BodySource &body) const {
  return std::ranges::any_of(scene.stage, [&](const Stage &stage) {
    return std::ranges::count(stage.add, body.name) || std::ranges::count(stage.remove, body.name);
  });
}

template <int dim>
std::vector<char> World<dim>::present_at_start() const {
  std::vector<char> there(scene.body.size(), 1);
  for (const Stage &stage : scene.stage)
    for (size_t b = 0; b < scene.body.size(); ++b)
      if (std::count(stage.add.begin(), stage.add.end(), scene.body[b].name)) there[b] = 0;
  return there;
}

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
    if (std::count(stage.add.begin(), stage.add.end(), name) && !present[b]) {
      present[b] = 1;
      seed<dim>(*bodies[b], mesh, stride,
                [&](const Vec<dim> &x) { return soil_density(scene.body[b], x, clock.load_time); });
      conditions.surface_loads().seed(*bodies[b], mesh);
      require(bodies[b]->sort(mesh.cell_count()));
    }
    if (std::count(stage.remove.begin(), stage.remove.end(), name) && present[b]) {
      present[b] = 0;
      require(bodies[b]->resize(0));
    }
  }
  count_particles();
}

template <int dim>
void World<dim>::set_loading(const Stage &stage, double stage_time, const Clock &clock) {
  const double ramp = stage.gravity_ramp > 0 ? std::min(1., stage_time / stage.gravity_ramp) : 1;
  const std::array<double, 3> acceleration = scene.acceleration_in(stage);
  std::copy_n(acceleration.begin(), dim, motion->loading.gravity.begin());
  motion->loading.ramp = ramp;
  motion->loading.ramp_rate = ramp < 1 ? 1 / stage.gravity_ramp : 0;
  motion->loading.set_at = clock.time;
  motion->loading.time_rate = stage.hold_loads ? 0 : 1;
  motion->loading.time = clock.load_time;
  motion->loading.damping = stage.damping;
  motion->loading.softening = stage.softening;
  conditions.bases().remember_slip(stage.softening);
  motion->loading.pore_flow = stage.pore_flow;
}

/// Changes between dashpots and the supports that stand in for them; what these bore stays on as a dead load.
template <int dim>
PetscErrorCode World<dim>::fix_dashpots(bool fixed, double time) {
  PetscFunctionBeginUser;
  if (fixed == conditions.uses_stand_ins() || !conditions.has_dashpots()) PetscFunctionReturn(0);
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
  ++releases_;
  PetscCall(PetscTime(&end));
  breakdown.release += middle - start, breakdown.relocate += end - middle;
  PetscFunctionReturn(0);
}

/// Particles that left the mesh: out of the bodies and into the ledger, or the end of the run.
template <int dim>
PetscErrorCode World<dim>::take_out(double time) {
  PetscFunctionBeginUser;
  if (scene.mesh.leaving_particles == WhenOutside::stop) {
    size_t b = 0;
    while (b < bodies.size() && outside_[b].empty()) ++b;
    const bool mine = b < bodies.size();
    const std::string place =
        place_of_first<dim>(comm, mine, mine ? bodies[b]->particles().position[outside_[b][0]] : Vec<dim>{});
    throw MotionFailure("a particle left the mesh near " + place +
                        "; add free space there, or a boundary that keeps soil in, or set mesh.leaving_particles = "
                        "\"remove\", which takes out what leaves (also with --resume)");
  }
  for (size_t b = 0; b < bodies.size(); ++b) {
    const std::vector<int> &gone = outside_[b];
    escaped.enter(*bodies[b], static_cast<int>(b), gone, time);
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
    const ParticleArrays<dim> &p = body->particles();
    std::copy_n(p.position, p.count, p.reference);
    std::fill_n(p.velocity, p.count, Vec<dim>{});
    const auto fields = history_fields(body->law());
    for (size_t k = 0; k < fields.size(); ++k)
      for (int i = 0; !fields[k].kept && i < p.count; ++i) p.history[i * fields.size() + k] = 0;
    for (int a = 0; a < phases.fluids(); ++a) std::fill_n(p.fluid_velocity[a], p.count, Vec<dim>{});
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
    int last = -1;
    double of_cell = 0;  // of soil as dense as it was
    for (int q = 0; q < points.count; ++q) {
      if (points.cell[q] != last) of_cell = critical_[b](motion->grid().mesh_cell[last = points.cell[q]]);
      local = std::min(local, of_cell * share_of_step(q));
    }
  }
  MPI_Allreduce(&local, &step, 1, MPI_DOUBLE, MPI_MIN, comm);
  return step;
}

template <int dim>
std::vector<BodyReport> World<dim>::report() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
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
    reports.push_back(report);
  }
  return reports;
}

/// "particle 12 of body.sand" of this rank, the nearest to a place.
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
  for (const auto &body : bodies) PetscCall(body->serialize(archive, mesh));
  PetscCall(motion->serialize(archive));
  if (archive.reading()) count_runs();
  PetscFunctionReturn(0);
}

template <int dim>
double World<dim>::work_of_rank() const {
  double work = rates_.per_cell * motion->grid().cell_count() + rates_.per_run * runs_;
  for (const auto &body : bodies) work += body->particles().count;
  return work;
}

namespace {

/// Calls `use` with the cell of each run (simulation/work.h) of the bodies.
template <int dim, class Use>
void for_each_run(const std::vector<std::unique_ptr<Body<dim>>> &bodies, Use use) {
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i)
      if (i == 0 || p.cell[i] != p.cell[i - 1]) use(p.cell[i]);
  }
}

}  // namespace

template <int dim>
void World<dim>::count_runs() {
  int ranks;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) return;  // which shares its work with nobody
  runs_ = 0;
  for_each_run(bodies, [this](int) { ++runs_; });
}

template <int dim>
std::vector<FilledCell<dim>> World<dim>::work_of_cells(double step) const {
  std::vector<FilledCell<dim>> all(mesh.cell_count()), filled;
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i)
      all[p.cell[i]].weight += 1, map<dim>(all[p.cell[i]].way) += map<dim>(p.velocity[i]);
  }
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (all[c].weight == 0) continue;
    filled.push_back({mesh.global_cell[c], all[c].weight + rates_.per_cell, {}});
    map<dim>(filled.back().way) = step / all[c].weight * map<dim>(all[c].way);
    all[c].number = static_cast<long long>(filled.size()) - 1;
  }
  for_each_run(bodies, [&](int cell) { filled[all[cell].number].weight += rates_.per_run; });
  return filled;
}

template <int dim>
void World<dim>::divide(const Cuts &cuts) {
  for (const auto &body : bodies) require(body->resize(0));
  const Loading<dim> loading = motion->loading;
  std::vector<Source> sources = conditions.sources();
  const bool stand_ins = conditions.uses_stand_ins();
  mesh = mesh.divided(cuts), comm = mesh.comm();
  conditions = Conditions<dim>();
  require(conditions.setup(mesh, std::move(sources)));
  conditions.use_stand_ins(stand_ins), conditions.bases().remember_slip(loading.softening);
  pressure.set_regions(bodies_of_cells(mesh, scene));
  set_pore_pressure_ratios();
  settle_bodies();
  close_bases();
  set_friction_delay();
  make_motion();
  motion->loading = loading;
  require(motion->setup_pores(false));
}

template class World<2>;
template class World<3>;

}  // namespace talus
