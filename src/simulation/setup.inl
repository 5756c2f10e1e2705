// From the scene to the first state: mesh, bodies, boundaries, followed points.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "scene/reader.h"
#include "simulation/simulation_impl.h"

namespace talus {

template <int dim>
Simulation<dim>::Simulation(MPI_Comm comm, Scene &scene, const RunOptions &options, const std::string &mesh_file)
    : comm_(comm),
      scene_(scene),
      phases_(phase_traits(scene.phases)),
      options_(options),
      pressure_(scene.water, std::hypot(scene.gravity[0], scene.gravity[1])) {
  for (BodySource &body : scene.body) {
    laws_.push_back(read_law(body.law));
    const std::string problem = law_problem(laws_.back(), dim);
    if (!problem.empty()) scene.complain("body." + body.name, "cannot be used: " + problem);
    if (body.averaging_length > 0 && plastic_strain_field(laws_.back()) < 0)
      scene.complain("body." + body.name + ".averaging_length",
                     "needs a law that remembers a plastic_strain, not " + std::string(law_name(laws_.back())));
    if (body.particles_per_cell == 0) body.particles_per_cell = dim == 2 ? 3 : 4;
    if (phases_.liquid && body.volume_cap < 0)
      body.volume_cap = 0;  // pressure follows volume: a cap would pump it up, pores.md section 4
  }
  std::vector<typename Conditions<dim>::Source> sources;
  for (BoundarySource &b : scene.boundary) sources.push_back({b.name, b.group, read_boundary(b.kind)});
  integrator_settings_ = read_integrator(scene.integrator, phases_.liquid);
  integrator_ = make_integrator(integrator_settings_);
  const bool by_euler = std::holds_alternative<EulerSettings>(integrator_settings_);
  if (explicit_drag() && !(phases_.liquid && by_euler))
    scene.complain("water.drag",
                   std::string("can be \"explicit\" only ") +
                       (phases_.liquid ? "with integrator.kind = \"euler\": the others take drag over a step"
                                       : "where pore fluids move") +
                       "; leave it out");
  if (scene.water.storage == PoreStorage::rate && !(phases_.suction && !phases_.gas && by_euler))
    scene.complain("water.storage",
                   "can be \"rate\" only with phases = \"unsaturated\" and integrator.kind = \"euler\"; leave it out");
  if (phases_.liquid) {
    if (const std::string problem = drag_problem(integrator_settings_); !problem.empty())
      scene.complain("integrator.kind", "must be \"euler\", or \"arkode\" of order 3, where pore fluids move: " +
                                            problem + "; or take phases = \"dry\" or \"drained\"");
    if (step_rule(integrator_settings_).bound == FrequencyBound::mesh)
      scene.complain(
          "integrator.omega_max",
          "must be \"cells\" where pore fluids move: power iteration knows the elastic waves of the skeleton alone");
    for (size_t k = 0; k < scene.stage.size() && phases_.gas; ++k)
      if (is_static(scene.stage[k].kind))
        scene.complain("stage." + std::to_string(k) + ".kind",
                       "must be \"dynamic\" where gas moves; quasi-static stages take any other phases");
  }

  std::vector<std::pair<std::string, double>> weights;
  for (const BodySource &body : scene.body)
    for (const std::string &region : body.region) weights.emplace_back(region, body.particles_per_cell + 1);
  if (options.plex)
    mesh_ = BackgroundMesh<dim>::adopt(options.plex, scene.transfer.patch_size);
  else
    try {
      mesh_ = BackgroundMesh<dim>::read(comm, mesh_file, scene.transfer.patch_size, weights);
    } catch (const std::invalid_argument &error) {
      scene.complain(scene.mesh.file.empty() ? "mesh.section" : "mesh.file",
                     std::string("cannot serve: ") + error.what());
    }
  comm_ = mesh_.comm();
  check_bodies();
  check_boundaries(sources);
  require(conditions_.setup(mesh_, std::move(sources)));
  conditions_.hold(scene.stage.front().hold_loads);
  seed_bodies();
  set_loading(scene_.stage.front(), 0);  // under which the first state is gathered
  follow_points();
  present_.assign(scene.body.size(), 1);
  for (const Stage &stage : scene.stage)
    for (size_t b = 0; b < scene.body.size(); ++b)
      if (std::count(stage.add.begin(), stage.add.end(), scene.body[b].name)) present_[b] = 0;
  if (std::count(present_.begin(), present_.end(), 0)) {
    for (size_t b = 0; b < scene.body.size(); ++b)
      if (!present_[b]) require(bodies_[b]->resize(0));
    count_particles();
  }
  check_step();
  check_pictures();
}

template <int dim>
double Simulation<dim>::soil_density(const BodySource &source, const Vec<dim> &x, double t) const {
  if (source.density > 0 && !phases_.liquid) return source.density;
  double density = (1 - source.porosity) *
                   source.grain_density;  // where fluids move on their own, particles' mass is that of the grains
  if (phases_.prescribed)
    density += source.porosity * scene_.water.density * (pressure_.below_table(x, t) ? 1 : source.saturation);
  return density;
}

template <int dim>
void Simulation<dim>::seed_bodies() {
  int stride = 1;
  for (const BodySource &source : scene_.body) {
    stride = std::max(stride, source.particles_per_cell);
    for (const DenseBox &box : source.dense) stride = std::max(stride, box.particles_per_cell);
  }
  double wave_speed = 0;
  std::vector<char> filled(mesh_.cell_count(), 0);
  for (const BodySource &source : scene_.body)
    for (const std::string &region : source.region)
      for (int cell : mesh_.region(region)) filled[cell] = 1;
  SurfaceLoads<dim> &loads = conditions_.surface_loads();
  require(loads.share(mesh_, filled));
  movers_.resize(scene_.body.size());
  for (size_t b = 0; b < scene_.body.size(); ++b) {
    const BodySource &source = scene_.body[b];
    bodies_.push_back(std::make_unique<Body<dim>>());
    Body<dim> &body = *bodies_.back();
    require(body.create(comm_, source, laws_[b], scene_.transfer.velocity == Velocity::apic, phases_.fluids(),
                        loads.face_count()));
    seed<dim>(body, mesh_, stride, [&](const Vec<dim> &x) { return soil_density(source, x, 0); });
    loads.seed(body, mesh_);
    double sums[2] = {static_cast<double>(body.particles().count), 0}, totals[2];
    sums[1] = std::accumulate(body.particles().mass, body.particles().mass + body.particles().count, 0.);
    MPI_Allreduce(sums, totals, 2, MPI_DOUBLE, MPI_SUM, comm_);
    const std::string path = "body." + source.name;
    if (totals[0] == 0) scene_.complain(path, "is empty: its regions have no cells");
    check_seeded(body, path);
    particle_count_ += static_cast<long long>(totals[0]), total_mass_ += totals[1];
    const double density = soil_density(source, Vec<dim>{}, 0);
    wave_speed = std::max(wave_speed, std::sqrt(constrained_modulus(body.law()) / density));
    PoreStiffness pores{source.porosity, {}};
    if (phases_.liquid) pores.fluids.push_back({scene_.water.density, scene_.water.bulk_modulus});
    if (phases_.gas) pores.fluids.push_back({scene_.gas.density, scene_.gas.bulk_modulus});
    critical_.emplace_back(mesh_, body.law(), density, pores);
    if (!source.displacement.empty())
      for (int i = 0; i < body.particles().count; ++i) movers_[b].push_back(i);
    bool lost = false;
    Vec<dim> where{};
    require(relocate<dim>(body, mesh_, movers_[b], &lost, &where));
    const std::string outside = place_of(lost, where);
    if (!outside.empty()) scene_.complain(path + ".displacement", "takes particles out of the mesh near " + outside);
    require(body.sort(mesh_.cell_count()));
  }
  const int idle = loads.find_idle(comm_, bodies_);
  if (idle >= 0)
    scene_.complain("boundary." + conditions_.sources()[idle].name + ".kind",
                    "is a load on a face without soil behind it at the start; name a group on the surface of a body");
  const double relaxation = scene_.transfer.relaxation * mesh_.report().smallest_altitude / wave_speed;
  constexpr double friction_delay = 10;  // in units of altitude over wave speed, docs/theory (6.2)
  conditions_.set_friction_delay(friction_delay * mesh_.report().smallest_altitude / wave_speed);
  motion_ = make_soil_motion(MotionParts<dim>{mesh_, bodies_, conditions_, scene_, relaxation, total_mass_,
                                              particle_count_, std::hypot(scene_.gravity[0], scene_.gravity[1])});
  require(motion_->setup_pores(true));
}

template <int dim>
void Simulation<dim>::follow_points() {
  for (const OutputPoint &wanted : scene_.output.point) {
    Followed point{wanted.name};
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t b = 0; b < bodies_.size(); ++b) {
      const ParticleArrays<dim> &p = bodies_[b]->particles();
      for (int i = 0; i < p.count; ++i) {
        double distance = 0;
        for (int d = 0; d < dim; ++d)
          distance += (p.position[i][d] - wanted.position[d]) * (p.position[i][d] - wanted.position[d]);
        if (distance < nearest * (1 - 1e-9) || (distance <= nearest * (1 + 1e-9) && p.id[i] < point.id))
          nearest = distance, point.body = static_cast<int>(b), point.id = p.id[i];
      }
    }
    // the same particle whatever the partition: nearest, then smallest number
    double best;
    MPI_Allreduce(&nearest, &best, 1, MPI_DOUBLE, MPI_MIN, comm_);
    const bool candidate = nearest <= best * (1 + 1e-9);
    long long id = candidate ? point.id : std::numeric_limits<long long>::max(), winner;
    MPI_Allreduce(&id, &winner, 1, MPI_LONG_LONG, MPI_MIN, comm_);
    int body = candidate && point.id == winner ? point.body : -1;
    MPI_Allreduce(MPI_IN_PLACE, &body, 1, MPI_INT, MPI_MAX, comm_);
    point.id = static_cast<PetscInt>(winner), point.body = body;
    points_.push_back(point);
  }
}

}  // namespace talus
