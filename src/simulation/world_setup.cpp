// From the scene to the first state: mesh, bodies, boundaries and motion.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/freed_memory.h"
#include "base/sum.h"
#include "meshes/side_columns.h"
#include "physics/boundary/rigid_bodies.h"
#include "physics/boundary/soil_contact.h"
#include "physics/laws/drainage.h"
#include "physics/structures/structures_in_motion.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/contact_source.h"
#include "scene/mesh_source.h"
#include "scene/place_grid.h"
#include "scene/reader.h"
#include "scene/rigid_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/structure_source.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"
#include "scene/words.h"
#include "simulation/contact_groups.h"
#include "simulation/dynamics.h"
#include "simulation/gap_walls.h"
#include "simulation/rigid_checks.h"
#include "simulation/shaken_supports.h"
#include "simulation/world.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {

template <int dim>
World<dim>::World(MPI_Comm world, const Scene &of, DM plex, const std::string &mesh_file, const Cuts &cuts)
    : scene(of),
      phases(phase_traits(of.phases)),
      comm(world),
      pressure(of),
      shaking(of.earthquake),
      rates_(*of.transfer) {
  read_laws();
  std::vector<Source> sources = read_sources();
  read_mesh(plex, mesh_file, cuts, sources);
  check_contacts(scene, plex != nullptr);
  separate_groups();
  check_bodies();
  find_strengths();
  check_boundaries(sources);
  check_earthquake();
  check_rigid_bodies(scene);
  check_shaken_supports(*this, sources);
  tie_sides(sources, true);
  require(conditions.setup(mesh, std::move(sources)));
  take_rigid_bodies();
  take_soil_contact();
  take_structures();
  check_gap_walls(*this);
  conditions.use_stand_ins(scene.stage.front().hold_loads);
  pressure.set_regions(bodies_of_cells(mesh, scene));
  set_pore_pressure_ratios();
  seed_bodies();
  check_rigid_overlap(*this);
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

namespace {

/// Refuses undrained soil where pore fluids move, and stages that drainage names and the scene lacks.
void check_drainage(const Scene &scene, const BodySource &body) {
  const Drainage drainage = read_drainage(body.law);
  const std::string path = "body." + body.name;
  if (drainage.undrained() && fluids_move(scene.phases))
    scene.complain(path + ".drainage",
                   "must be \"drained\" where pore fluids move: there permeability and time decide what drains; take "
                   "phases = \"drained\", or give the soil a low permeability");
  if (drainage.skempton_b > 0 && drainage.undrained_poisson_ratio != Drainage().undrained_poisson_ratio)
    scene.complain(path + ".skempton_b", "must be left out beside undrained_poisson_ratio, or that beside it");
  std::vector<std::string> static_stages;
  for (const Stage &stage : scene.stage)
    if (stage.settles_soil() && !stage.finds_factor()) static_stages.push_back(stage.name);
  const auto check = [&](const std::string &key, const std::vector<std::string> &names) {
    for (const std::string &name : names)
      if (std::ranges::find(static_stages, name) == static_stages.end())
        scene.complain(path + key, "must name quasi-static or consolidation stages; there is no \"" + name + "\"; " +
                                       suggestion(name, static_stages));
  };
  check(".drained_in", drainage.drained_in), check(".shansep.stage", drainage.shansep.stage);
}

}  // namespace

template <int dim>
void World<dim>::read_laws() {
  for (const BodySource &body : scene.body) {
    laws.push_back(read_law(body.law));
    check_drainage(scene, body);
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
    NamedBoundary source{b.name, b.group, kind};
    if (kind.has_column)
      for (const std::string &side : b.group) source.columns.push_back(column_of(side));
    source.groups.insert(source.groups.end(), source.columns.begin(), source.columns.end());
    (seeps ? seepage_sources : sources).push_back(std::move(source));
  }
  return sources;
}

template <int dim>
void World<dim>::read_mesh(DM plex, const std::string &mesh_file, const Cuts &cuts,
                           const std::vector<Source> &sources) {
  std::vector<std::string> sides;
  for (const Source &source : sources)
    for (std::size_t k = 0; k < source.columns.size(); ++k) sides.push_back(source.groups[k]);
  std::vector<std::pair<std::string, double>> weights;
  SeedCounts seeds{{}, id_stride()};
  for (const BodySource &body : scene.body)
    for (const std::string &region : body.region) {
      const WorkCounts sorted{.particles = double(particles_per_cell<dim>(body)), .runs = 1, .cells = 1};
      weights.emplace_back(region, WorkRates::without_round_off(rates_.of(sorted)));
      seeds.per_cell.emplace_back(region, particles_per_cell<dim>(body));
    }
  if (plex)
    mesh = BackgroundMesh<dim>::adopt(plex);
  else
    try {
      mesh = BackgroundMesh<dim>::read(comm, mesh_file, weights, cuts, scene.mesh->halvings, seeds, sides);
    } catch (const std::invalid_argument &error) {
      scene.complain(!scene.mesh->file.empty()      ? "mesh.file"
                     : !scene.mesh->section.empty() ? "mesh.section"
                                                    : "mesh.terrain",
                     std::string("cannot serve: ") + error.what());
    }
  comm = mesh.comm();
  find_mesh_box();
}

/// Joins the nodes of sides that move alike. Collective.
template <int dim>
void World<dim>::tie_sides(const std::vector<Source> &sources, bool complains) {
  const Ties ties = find_ties<dim>(mesh, sources);
  if (complains && !ties.fault.empty()) scene.complain("boundary." + sources[ties.source].name + ".group", ties.fault);
  mesh.tie(ties.groups);
}

template <int dim>
void World<dim>::take_structures() {
  if (scene.structure.empty()) return;
  const bool moves = std::ranges::any_of(scene.stage, [](const Stage &stage) { return stage.motion(); });
  if (moves && !std::holds_alternative<EulerSettings>(choose_integrator(scene)))
    scene.complain("integrator.kind", "must be \"euler\" beside structure." + scene.structure[0].name +
                                          ", whose force acts once in a step");
  if (!structures) structures = std::make_unique<Structures<dim>>(mesh, scene, laws);
  conditions.take_structures(std::make_unique<StructuresInMotion<dim>>(mesh, *structures));
}

template <int dim>
void World<dim>::take_rigid_bodies() {
  if (!scene.rigid.empty()) conditions.take_rigid_bodies(std::make_unique<RigidBodies<dim>>(mesh, bodies, scene.rigid));
}

/// Groups of bodies that meet in contact have sheets of the mesh of their own. Collective.
template <int dim>
void World<dim>::separate_groups() {
  const std::vector<std::vector<std::string>> regions = contact_groups(scene).regions(scene);
  if (regions.size() > 1) require(mesh.divide_into_sheets(regions));
}

template <int dim>
void World<dim>::take_soil_contact() {
  if (mesh.sheet_count() > 1)
    conditions.take_soil_contact(
        std::make_unique<SoilContact<dim>>(mesh, scene.contact, contact_groups(scene).pairs(scene)));
}

/// Grids of the scene are told of it.
template <int dim>
void World<dim>::find_mesh_box() {
  auto &[low, high] = mesh_box;
  std::fill_n(low.begin(), dim, std::numeric_limits<double>::max()), std::fill_n(high.begin(), dim, -low[0]);
  for (const Vec<dim> &x : mesh.position)
    for (int d = 0; d < dim; ++d) low[d] = std::min(low[d], x[d]), high[d] = std::max(high[d], x[d]);
  MPI_Allreduce(MPI_IN_PLACE, low.data(), dim, MPI_DOUBLE, MPI_MIN, comm);
  MPI_Allreduce(MPI_IN_PLACE, high.data(), dim, MPI_DOUBLE, MPI_MAX, comm);
  if (!scene.root) return;
  for (const auto &[name, grid] : scene.root->grids()) grid->mesh = mesh_box;
}

template <int dim>
double World<dim>::soil_density(const BodySource &source, const Vec<dim> &x, double t) const {
  if (source.density > 0 && !phases.liquid) return source.density;
  const int soil = static_cast<int>(&source - scene.body.data());
  double density = (1 - source.porosity) *
                   source.grain_density;  // where fluids move on their own, particles' mass is that of the grains
  if (phases.prescribed) density += source.porosity * scene.water->density * pressure.saturation(source, x, t, soil);
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
  critical_.clear(), face_groups_.clear();
  for (size_t b = 0; b < scene.body.size(); ++b) {
    const BodySource &source = scene.body[b];
    double density = 0;  // where its soil is heaviest
    for (const std::string &region : source.region)
      for (const int cell : mesh.region(region)) {
        Vec<dim> centre{};
        for (const int node : mesh.cells[cell].node)
          for (int d = 0; d < dim; ++d) centre[d] += mesh.position[node][d] / (dim + 1);
        density = std::max(density, soil_density(source, centre, 0));
      }
    MPI_Allreduce(MPI_IN_PLACE, &density, 1, MPI_DOUBLE, MPI_MAX, comm);
    wave_speed_ = std::max(wave_speed_, std::sqrt(constrained_modulus(laws[b]) / density));
    critical_.emplace_back(mesh, laws[b], density,
                           pore_stiffness(scene, source, phases.fluids(), pore_integration.implicit));
  }
}

/// Explicit or implicit in time. Collective.
template <int dim>
void World<dim>::choose_pore_pressure() {
  const PoreIntegration asked = scene.water->pressure;
  if (asked == PoreIntegration::at_end)
    if (const auto refused = implicit_pressure_refused(conditions.sources()))
      scene.complain(refused->key, refused->text);
  pore_integration.implicit = asked == PoreIntegration::at_end;
  if (asked == PoreIntegration::automatic && phases.liquid) {
    double steps[] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    for (size_t b = 0; b < scene.body.size(); ++b)
      for (const std::string &region : scene.body[b].region)
        for (const int cell : mesh.region(region))
          steps[0] = std::min(steps[0], critical_[b](cell)), steps[1] = std::min(steps[1], critical_[b].skeleton(cell));
    MPI_Allreduce(MPI_IN_PLACE, steps, 2, MPI_DOUBLE, MPI_MIN, comm);
    pore_integration = choose_pore_integration(scene, conditions.sources(), steps[0], steps[1]);
  }
  if (pore_integration.implicit) settle_bodies();
}

template <int dim>
void World<dim>::close_bases() {
  for (const auto &source : conditions.sources())
    if (source.kind.keeps_soil_inside())
      for (const std::string &group : source.groups) mesh.close(group);
}

template <int dim>
void World<dim>::make_motion() {
  const double relaxation = scene.transfer->relaxation * smallest_altitude_ / wave_speed_;
  motion = make_soil_motion(MotionParts<dim>{mesh, bodies, conditions, scene, pressure, relaxation, seeded_mass_,
                                             seeded_particles_, pore_integration.implicit});
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
  choose_pore_pressure();
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
        place_of_first<dim>(comm, lost, lost ? body.particles().position[outside_[b][0].particle] : Vec<dim>{});
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
  find_fastest_fall();
  make_motion();
  require(motion->setup_pores(true));
}

/// Of soil that falls through all of the mesh with the largest speed at the start. Collective.
template <int dim>
void World<dim>::find_fastest_fall() {
  constexpr double lowest = std::numeric_limits<double>::lowest();
  double ends[3] = {lowest, lowest, 0};  // of elevations, the lower one with its sign changed; square of the speed
  for (const Vec<dim> &x : mesh.position)
    ends[0] = std::max(ends[0], x[scene.vertical()]), ends[1] = std::max(ends[1], -x[scene.vertical()]);
  for (const auto &body : bodies)
    for (int i = 0; i < body->particles().count; ++i)
      ends[2] = std::max(ends[2], map<dim>(body->particles().velocity[i]).squaredNorm());
  MPI_Allreduce(MPI_IN_PLACE, ends, 3, MPI_DOUBLE, MPI_MAX, comm);
  fastest_fall_ = std::sqrt(2 * scene.gravity_size() * (ends[0] + ends[1]) + ends[2]);
}

/// Does a stage add or remove the body?
template <int dim>
bool World<dim>::comes_or_goes(const BodySource &body) const {
  return std::ranges::any_of(scene.stage,
                             [&](const Stage &stage) { return stage.adds(body.name) || stage.removes(body.name); });
}

template <int dim>
std::vector<char> World<dim>::present_at_start() const {
  std::vector<char> there(scene.body.size(), 1);
  for (const Stage &stage : scene.stage)
    for (size_t b = 0; b < scene.body.size(); ++b)
      if (stage.adds(scene.body[b].name)) there[b] = 0;
  return there;
}

template World<2>::World(MPI_Comm, const Scene &, DM, const std::string &, const Cuts &);
template World<3>::World(MPI_Comm, const Scene &, DM, const std::string &, const Cuts &);
template std::string World<2>::function_fault() const;
template std::string World<3>::function_fault() const;
template double World<2>::soil_density(const BodySource &, const Vec<2> &, double) const;
template double World<3>::soil_density(const BodySource &, const Vec<3> &, double) const;
template Overburden<2>::Block World<2>::block_of(const BodySource &, int, double, double) const;
template Overburden<3>::Block World<3>::block_of(const BodySource &, int, double, double) const;
template void World<2>::set_pore_pressure_ratios();
template void World<3>::set_pore_pressure_ratios();
template int World<2>::id_stride() const;
template int World<3>::id_stride() const;
template void World<2>::settle_bodies();
template void World<3>::settle_bodies();
template void World<2>::take_structures();
template void World<3>::take_structures();
template void World<2>::take_rigid_bodies();
template void World<3>::take_rigid_bodies();
template void World<2>::separate_groups();
template void World<3>::separate_groups();
template void World<2>::take_soil_contact();
template void World<3>::take_soil_contact();
template void World<2>::tie_sides(const std::vector<Source> &, bool);
template void World<3>::tie_sides(const std::vector<Source> &, bool);
template void World<2>::close_bases();
template void World<3>::close_bases();
template void World<2>::make_motion();
template void World<3>::make_motion();
template void World<2>::set_friction_delay();
template void World<3>::set_friction_delay();
template std::vector<char> World<2>::present_at_start() const;
template std::vector<char> World<3>::present_at_start() const;

}  // namespace talus
