// Implementation of Simulation; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "base/version.h"
#include "scene/reader.h"
#include "scene/words.h"
#include "simulation_impl.h"

namespace talus {

/// Turns a PETSc error into an exception, where no PETSc function stands between thrower and catcher.
inline void require(PetscErrorCode error) {
  if (error) throw RunError("PETSc reported error " + std::to_string(error) + " (its message stands above)");
}

/// Four digits, for messages.
inline std::string rounded(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

// ---- setup ----

template <int dim, class Phases>
Simulation<dim, Phases>::Simulation(MPI_Comm comm, Scene &scene, const RunOptions &options, const std::string &mesh_file)
    : comm_(comm), scene_(scene), options_(options), pressure_(scene.water, std::hypot(scene.gravity[0], scene.gravity[1])) {
  for (BodySource &body : scene.body) {
    laws_.push_back(read_law(body.law));
    if (body.particles_per_cell == 0) body.particles_per_cell = dim == 2 ? 3 : 4;
  }
  std::vector<typename Conditions<dim>::Source> sources;
  for (BoundarySource &b : scene.boundary) sources.push_back({b.name, b.group, read_boundary(b.kind)});
  integrator_settings_ = read_integrator(scene.integrator);
  integrator_ = make_integrator(integrator_settings_);

  std::vector<std::pair<std::string, double>> weights;
  for (const BodySource &body : scene.body)
    for (const std::string &region : body.region) weights.emplace_back(region, body.particles_per_cell + 1);
  if (options.plex)
    mesh_ = BackgroundMesh<dim>::adopt(options.plex, scene.transfer.patch_size);
  else
    try {
      mesh_ = BackgroundMesh<dim>::read(comm, mesh_file, scene.transfer.patch_size, weights);
    } catch (const std::invalid_argument &error) {
      scene.complain(scene.mesh.file.empty() ? "mesh.section" : "mesh.file", std::string("cannot serve: ") + error.what());
    }
  comm_ = mesh_.comm();
  check_bodies();
  check_boundaries(sources);
  require(conditions_.setup(mesh_, std::move(sources)));
  seed_bodies();
  follow_points();
  check_step();
}

template <int dim, class Phases>
void Simulation<dim, Phases>::check_bodies() const {
  const auto check_lattice = [&](const std::string &path, int count) {
    if (lattice<dim>(count).empty())
      scene_.complain(path + ".particles_per_cell",
                      std::string("has no lattice of that many points; take ") + (dim == 2 ? "1, 3, 4, 6, 9, 10, 12, 15 or 16" : "1, 4, 8, 10 or 20"));
  };
  std::vector<int> owner(mesh_.cell_count(), -1);
  for (int b = 0; b < static_cast<int>(scene_.body.size()); ++b) {
    const BodySource &body = scene_.body[b];
    const std::string path = "body." + body.name;
    int other = -1;
    for (const std::string &region : body.region) {
      if (!mesh_.has_region(region))
        scene_.complain(path + ".region", "must name groups of cells; the mesh has no \"" + region + "\"; " + suggestion(region, mesh_.region_names()));
      for (int cell : mesh_.region(region)) {
        if (owner[cell] >= 0 && owner[cell] != b) other = owner[cell];
        owner[cell] = b;
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, &other, 1, MPI_INT, MPI_MAX, comm_);
    if (other >= 0) scene_.complain(path + ".region", "fills cells that body." + scene_.body[other].name + " fills too; give each cell to one body");
    check_lattice(path, body.particles_per_cell);
    for (size_t k = 0; k < body.dense.size(); ++k) check_lattice(path + ".dense." + std::to_string(k), body.dense[k].particles_per_cell);
  }
}

template <int dim, class Phases>
void Simulation<dim, Phases>::check_boundaries(const std::vector<typename Conditions<dim>::Source> &sources) const {
  for (const auto &source : sources) {
    const std::string path = "boundary." + source.name;
    for (const std::string &group : source.groups)
      if (!mesh_.has_group(group))
        scene_.complain(path + ".group", "must name groups of facets; the mesh has no \"" + group + "\"; " + suggestion(group, mesh_.group_names()));
    const auto check_vector = [&](const char *key, const std::vector<Function> &value) {
      if (!value.empty() && value.size() != dim) scene_.complain(path + "." + key, "must have " + std::to_string(dim) + " components");
    };
    if (const auto *moved = std::get_if<PrescribedVelocity>(&source.kind)) check_vector("velocity", moved->velocity);
    if (const auto *loaded = std::get_if<Traction>(&source.kind)) check_vector("traction", loaded->traction);
  }
}

/// What the functions of place made of a body's particles. Collective.
template <int dim, class Phases>
void Simulation<dim, Phases>::check_seeded(const Body<dim> &body, const std::string &path) const {
  const ParticleArrays<dim> &p = body.particles();
  const auto check = [&](const char *key, auto &&finite) {
    int bad = 0;
    while (bad < p.count && finite(bad)) ++bad;
    const std::string where = place_of(bad < p.count, bad < p.count ? p.reference[bad] : Vec<dim>{});
    if (!where.empty()) scene_.complain(path + "." + key, "is no number at " + where);
  };
  const auto all_finite = [](const double *x, int count) { return std::all_of(x, x + count, [](double value) { return std::isfinite(value); }); };
  check("velocity", [&](int i) { return all_finite(p.velocity[i].data(), dim); });
  check("stress", [&](int i) { return all_finite(p.stress + i * stress_size<dim>, stress_size<dim>); });
  check("displacement", [&](int i) { return all_finite(p.position[i].data(), dim) && p.volume[i] > 0; });
}

template <int dim, class Phases>
double Simulation<dim, Phases>::seeding_density(const BodySource &source, const Vec<dim> &x) const {
  if (source.density > 0) return source.density;
  double density = (1 - source.porosity) * source.grain_density;
  if constexpr (Phases::given)
    density += source.porosity * scene_.water.density * (pressure_.below_table(x, 0) ? 1 : source.saturation);
  return density;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::seed_bodies() {
  int stride = 1;
  for (const BodySource &source : scene_.body) {
    stride = std::max(stride, source.particles_per_cell);
    for (const DenseBox &box : source.dense) stride = std::max(stride, box.particles_per_cell);
  }
  double wave_speed = 0;
  movers_.resize(scene_.body.size());
  for (size_t b = 0; b < scene_.body.size(); ++b) {
    const BodySource &source = scene_.body[b];
    bodies_.push_back(std::make_unique<Body<dim>>());
    Body<dim> &body = *bodies_.back();
    require(body.create(comm_, source, laws_[b], scene_.transfer.velocity == Velocity::apic));
    seed<dim>(body, mesh_, stride, [&](const Vec<dim> &x) { return seeding_density(source, x); });
    double sums[2] = {static_cast<double>(body.particles().count), 0}, totals[2];
    sums[1] = std::accumulate(body.particles().mass, body.particles().mass + body.particles().count, 0.);
    MPI_Allreduce(sums, totals, 2, MPI_DOUBLE, MPI_SUM, comm_);
    const std::string path = "body." + source.name;
    if (totals[0] == 0) scene_.complain(path, "is empty: its regions have no cells");
    check_seeded(body, path);
    particle_count_ += static_cast<long long>(totals[0]), total_mass_ += totals[1];
    const double density = seeding_density(source, Vec<dim>{});
    wave_speed = std::max(wave_speed, std::sqrt(constrained_modulus(body.law()) / density));
    critical_.emplace_back(mesh_, body.law(), density);
    if (!source.displacement.empty())
      for (int i = 0; i < body.particles().count; ++i) movers_[b].push_back(i);
    bool lost = false;
    Vec<dim> where{};
    require(relocate<dim>(body, mesh_, movers_[b], &lost, &where));
    const std::string outside = place_of(lost, where);
    if (!outside.empty()) scene_.complain(path + ".displacement", "takes particles out of the mesh near " + outside);
    require(body.sort(mesh_.cell_count()));
  }
  const double relaxation = scene_.transfer.relaxation * mesh_.report().smallest_altitude / wave_speed;
  motion_ = std::make_unique<SoilMotion<dim, Phases>>(mesh_, bodies_, conditions_, scene_.transfer, scene_.water, relaxation,
                                                      total_mass_ / static_cast<double>(particle_count_),
                                                      std::hypot(scene_.gravity[0], scene_.gravity[1]));
}

/// A fixed step that the first state already forbids is bad input; one that a later state forbids ends the run.
template <int dim, class Phases>
void Simulation<dim, Phases>::check_step() {
  const double step = std::get<EulerSettings>(integrator_settings_).step;
  if (step == 0) return;
  double critical = std::numeric_limits<double>::infinity();
  for (const BodyReport &body : bodies()) critical = std::min(critical, body.critical_step);
  if (step > critical)
    scene_.complain("integrator.step", "must not exceed the critical step of " + rounded(critical) +
                                           " s (2 / omega_max of the filled cells); take a smaller step, a coarser mesh, or leave step out");
}

template <int dim, class Phases>
void Simulation<dim, Phases>::follow_points() {
  for (const OutputPoint &wanted : scene_.output.point) {
    Followed point{wanted.name};
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t b = 0; b < bodies_.size(); ++b) {
      const ParticleArrays<dim> &p = bodies_[b]->particles();
      for (int i = 0; i < p.count; ++i) {
        double distance = 0;
        for (int d = 0; d < dim; ++d) distance += (p.position[i][d] - wanted.position[d]) * (p.position[i][d] - wanted.position[d]);
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

template <int dim, class Phases>
int Simulation<dim, Phases>::find(Followed &point) {
  const ParticleArrays<dim> &p = bodies_[point.body]->particles();
  if (point.index >= 0 && point.index < p.count && p.id[point.index] == point.id) return point.index;
  point.index = -1;
  for (int i = 0; i < p.count; ++i)
    if (p.id[i] == point.id) point.index = i;
  return point.index;
}

// ---- time loop ----

template <int dim, class Phases>
void Simulation<dim, Phases>::run() {
  open_results();
  try {
    write_history();
    write_snapshot();
    for (const Stage &stage : scene_.stage) run_stage(stage);
  } catch (const RunError &) {
    throw;
  } catch (const std::runtime_error &error) {  // results that cannot be written: say how far the run came
    fail(error.what());
  }
  if (!results_) return;
  results_->progress.finish();
  int rank;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0 && options_.pictures) draw_pictures(options_.directory);
}

template <int dim, class Phases>
void Simulation<dim, Phases>::set_loading(const Stage &stage, double stage_time) {
  const double ramp = stage.gravity_ramp > 0 ? std::min(1., stage_time / stage.gravity_ramp) : 1;
  for (int d = 0; d < dim; ++d) motion_->loading.gravity[d] = ramp * scene_.gravity[d];
  motion_->loading.ramp = ramp;
  motion_->loading.time = load_time_;
  motion_->loading.damping = stage.damping;
  motion_->loading.softening = stage.softening;
  hold_loads_ = stage.hold_loads;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::run_stage(const Stage &stage) {
  stage_name_ = stage.name;
  if (results_) results_->progress.stage(stage.name);
  const double begin = time_, end = time_ + stage.duration;
  double longest = 0;
  for (const Stage &s : scene_.stage) longest = std::max(longest, s.duration);
  const double history_interval = scene_.output.history_interval > 0 ? scene_.output.history_interval : longest / 200;
  long long rows = 1, snapshots = 1;
  quiet_checks_ = 0, failure_time_ = -1, watched_ = stage.until == StopWhen::failure ? stage.failure_point : "";
  bool ended = false;
  while (!ended && time_ < end * (1 - 1e-12)) {
    set_loading(stage, time_ - begin);
    const double next_row = begin + rows * history_interval;
    const double next_snapshot = scene_.output.interval > 0 ? begin + snapshots * scene_.output.interval : end;
    require(motion_->begin(time_));
    require(step(choose_step(std::min({end, next_row, next_snapshot}))));
    const Verdict verdict = agree();
    refuse(verdict);
    if (remap_due_) require(remap());
    if (results_) results_->progress.step(time_, steps_, particle_count_);
    if (time_ >= next_row * (1 - 1e-12)) write_history(), ++rows;
    if (time_ >= next_snapshot * (1 - 1e-12) && time_ < end * (1 - 1e-12)) write_snapshot(), ++snapshots;
    ended = stage_ends(stage, time_ - begin, verdict);
  }
  if (!ended && stage.until != StopWhen::duration) {
    Balance sums;
    require(motion_->begin(time_));
    require(motion_->balance(time_, &sums));
    std::ostringstream text;
    text.precision(3);
    text << "stage " << stage.name << " reached its duration of " << stage.duration << " s before its stop criterion was met: unbalanced force ratio "
         << sums.unbalanced / sums.applied << ", kinetic over strain energy " << sums.kinetic / sums.strain << ", rms speed "
         << std::sqrt(2 * sums.kinetic / total_mass_) << " m/s";
    note(text.str());
  }
  write_history();
  write_snapshot();
  if (stage.reset_displacement) reset_displacement();
}

template <int dim, class Phases>
double Simulation<dim, Phases>::critical_step() {
  require(motion_->begin(time_));
  double local = std::numeric_limits<double>::infinity(), step;
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PointSet &points = motion_->points()[b];
    int last = -1;
    for (int q = 0; q < points.count; ++q)
      if (points.cell[q] != last) local = std::min(local, critical_[b](motion_->grid().mesh_cell[last = points.cell[q]]));
  }
  MPI_Allreduce(&local, &step, 1, MPI_DOUBLE, MPI_MIN, comm_);
  return step;
}

template <int dim, class Phases>
double Simulation<dim, Phases>::choose_step(double until) {
  if (critical_step_ == 0) critical_step_ = critical_step();
  const EulerSettings &settings = std::get<EulerSettings>(integrator_settings_);
  double step = settings.step > 0 ? settings.step : settings.fraction * critical_step_ * shrink_;
  if (settings.step > critical_step_)
    fail("the soil has come to cells with a critical step of " + rounded(critical_step_) + " s, but integrator.step = " + rounded(settings.step) +
         " s; take a smaller step, or leave it out");
  const double left = until - time_;
  const double count = std::ceil(left / step * (1 - 1e-9));
  if ((settings.step > 0 && count > 1) || count > 1e6) return step;
  return left / std::max(1., count);
}

template <int dim, class Phases>
PetscErrorCode Simulation<dim, Phases>::step(double step) {
  PetscFunctionBeginUser;
  PetscLogDouble start, end;
  PetscCall(PetscTime(&start));
  PetscCall(integrator_->advance(*motion_, time_, step));
  PetscCall(PetscTime(&end));
  breakdown_.step += end - start;
  time_ += step, last_step_ = step;
  if (!hold_loads_) load_time_ += step;
  ++steps_;
  remap_due_ = scene_.transfer.remap_interval == 0;
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
typename Simulation<dim, Phases>::Verdict Simulation<dim, Phases>::agree() {
  double mine[7] = {motion_->moved(), 1 / motion_->step_ratio(), motion_->speed_squared(), -1, motion_->smallest_volume_ratio() <= 0.2 ? 1. : 0.,
                    !(motion_->speed_squared() < 1e300) ? 1. : 0., interrupted ? 1. : 0.};
  if (!watched_.empty())
    for (Followed &point : points_)
      if (point.name == watched_) {
        const int i = find(point);
        if (i < 0) continue;
        Vec<dim> x, v;
        motion_->present(*bodies_[point.body], i, &x, &v);
        mine[3] = map<dim>(v).norm();
      }
  if (mine[5]) mine[2] = 0;
  double all[7];
  MPI_Allreduce(mine, all, 7, MPI_DOUBLE, MPI_MAX, comm_);
  const Verdict verdict{all[0], all[1], all[2], all[3], all[4] > 0, all[5] > 0, all[6] > 0};
  shrink_ = 1 / verdict.shrink;
  if (verdict.moved > scene_.transfer.remap_interval || verdict.inverted) remap_due_ = true;
  return verdict;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::refuse(const Verdict &verdict) {
  if (verdict.broken) {
    Vec<dim> where{};
    const bool mine = motion_->find_broken(&where);
    fail("the velocity is not finite near " + place_of(mine, where) +
         "; look at the loads there; a smaller integrator.fraction, a volume_cap or transfer.remap_interval = 0 may help");
  }
  if (verdict.interrupted) {
    write_history();
    write_snapshot();
    fail("interrupted");
  }
}

/// Hands the particles what the nodes learned and walks them to their cells.
template <int dim, class Phases>
PetscErrorCode Simulation<dim, Phases>::release() {
  PetscFunctionBeginUser;
  PetscLogDouble start, middle, end;
  PetscCall(PetscTime(&start));
  for (auto &list : movers_) list.clear();
  PetscCall(motion_->release(time_, movers_));
  PetscCall(PetscTime(&middle));
  bool lost = false;
  Vec<dim> where{};
  for (size_t b = 0; b < bodies_.size(); ++b) PetscCall(relocate<dim>(*bodies_[b], mesh_, movers_[b], &lost, &where));
  critical_step_ = 0, shrink_ = 1;
  PetscCall(PetscTime(&end));
  breakdown_.release += middle - start, breakdown_.relocate += end - middle;
  const std::string outside = place_of(lost, where);
  if (!outside.empty()) fail("a particle left the mesh near " + outside + "; add free space there, or a boundary that keeps soil in");
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode Simulation<dim, Phases>::remap() {
  PetscFunctionBeginUser;
  PetscLogDouble start, end;
  PetscCall(release());
  ++remaps_;
  constexpr int remaps_between_sorts = 20;
  if (++since_sort_ >= remaps_between_sorts) {
    PetscCall(PetscTime(&start));
    for (auto &body : bodies_) PetscCall(body->sort(mesh_.cell_count()));
    PetscCall(PetscTime(&end));
    since_sort_ = 0, breakdown_.relocate += end - start;
  }
  PetscCall(check_conservation());
  PetscCall(PetscTime(&start));
  PetscCall(motion_->begin(time_));
  PetscCall(PetscTime(&end));
  breakdown_.gather += end - start;
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode Simulation<dim, Phases>::check_conservation() {
  PetscFunctionBeginUser;
  double mine[2]{}, all[2];
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    mine[0] += p.count;
    for (int i = 0; i < p.count; ++i) mine[1] += p.mass[i];
  }
  PetscCallMPI(MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, comm_));
  if (all[0] != static_cast<double>(particle_count_) || std::abs(all[1] - total_mass_) > 1e-12 * total_mass_)
    fail("particles were lost or doubled: " + std::to_string(static_cast<long long>(all[0])) + " of " + std::to_string(particle_count_) + " are left");
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
bool Simulation<dim, Phases>::stage_ends(const Stage &stage, double stage_time, const Verdict &verdict) {
  constexpr int steps_between_checks = 25, checks_of_rest = 8;
  switch (stage.until) {
    case StopWhen::duration: return false;
    case StopWhen::equilibrium: {
      if (steps_ % steps_between_checks || stage_time < stage.gravity_ramp) return false;
      Balance sums;
      require(motion_->begin(time_));
      require(motion_->balance(time_, &sums));
      if (sums.unbalanced > stage.force_ratio * sums.applied || sums.kinetic > stage.energy_ratio * sums.strain) return false;
      note("stage " + stage.name + " is in equilibrium: unbalanced force ratio " + std::to_string(sums.unbalanced / sums.applied));
      return true;
    }
    case StopWhen::rest: {
      if (steps_ % steps_between_checks) return false;
      Balance sums;
      require(motion_->begin(time_));
      require(motion_->balance(time_, &sums));
      quiet_checks_ = std::sqrt(2 * sums.kinetic / total_mass_) < stage.rest_speed ? quiet_checks_ + 1 : 0;
      if (quiet_checks_ < checks_of_rest) return false;
      note("stage " + stage.name + " came to rest");
      return true;
    }
    case StopWhen::failure: {
      // the speed must pass the threshold and be larger at each tenth of the watching time
      const double speed = verdict.watched_speed;
      if (failure_time_ < 0) {
        if (speed > stage.failure_speed) failure_time_ = last_rise_time_ = time_, failure_load_time_ = load_time_, last_rise_speed_ = speed;
        return false;
      }
      if (speed < stage.failure_speed) failure_time_ = -1;
      else if (time_ - last_rise_time_ >= stage.failure_time / 10) {
        if (speed <= last_rise_speed_) failure_time_ = -1;
        last_rise_time_ = time_, last_rise_speed_ = speed;
      }
      if (failure_time_ < 0 || time_ - failure_time_ < stage.failure_time) return false;
      std::ostringstream text;
      text.precision(8);
      text << "failure at " << failure_time_ << " s (loads at t = " << failure_load_time_ << " s): point " << stage.failure_point << " passed "
           << stage.failure_speed << " m/s and kept accelerating";
      note(text.str());
      events_.back().time = failure_time_, events_.back().load_time = failure_load_time_;
      return true;
    }
  }
  return false;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::reset_displacement() {
  if (motion_->gathered()) require(release());
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    std::copy_n(p.position, p.count, p.reference);
    std::fill_n(p.velocity, p.count, Vec<dim>{});
    if (p.history) std::fill_n(p.history, p.count * body->history_count(), 0.);
  }
  critical_step_ = 0, shrink_ = 1;
}

template <int dim, class Phases>
double Simulation<dim, Phases>::single_step() {
  if (stage_name_.empty()) stage_name_ = scene_.stage.front().name;
  set_loading(scene_.stage.front(), time_);
  require(motion_->begin(time_));
  require(step(choose_step(std::numeric_limits<double>::max())));
  refuse(agree());
  if (remap_due_) require(remap());
  return last_step_;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::advance_to(double t) {
  while (time_ < t * (1 - 1e-12)) {
    set_loading(scene_.stage.front(), time_);
    require(motion_->begin(time_));
    require(step(choose_step(t)));
    refuse(agree());
    if (remap_due_) require(remap());
  }
}

// ---- output ----

template <int dim, class Phases>
void Simulation<dim, Phases>::open_results() {
  const char axis[] = "xyz";
  history_.names = {"time_s", "step"};
  for (const Followed &point : points_) {
    for (int d = 0; d < dim; ++d) history_.names.push_back(point.name + "_" + axis[d] + "_m");
    history_.names.push_back(point.name + "_displacement_m");
    history_.names.push_back(point.name + "_velocity_m_s");
    if (Phases::given) history_.names.push_back(point.name + "_pore_pressure_Pa");
  }
  for (const char *name : {"kinetic_J", "strain_J", "potential_J", "mass_kg", "particles", "load_time_s"}) history_.names.push_back(name);
  // a loaded face shows how far it went, every other boundary the force by which it holds the soil
  for (size_t s = 0; s < conditions_.sources().size(); ++s)
    for (int d = 0; d < dim; ++d)
      history_.names.push_back(conditions_.sources()[s].name + (conditions_.loads(static_cast<int>(s)) ? "_displacement_" : "_force_") + axis[d] +
                               (conditions_.loads(static_cast<int>(s)) ? "_m" : "_N"));
  if (options_.directory.empty()) return;

  RunHeader header{scene_.title, std::string("Talus ") + version, scene_.source, {}};
  for (const auto &body : bodies_) header.bodies.push_back(body->name());
  MeshPicture picture;
  picture.dimension = dim;
  for (const Vec<dim> &x : mesh_.position) picture.position.insert(picture.position.end(), x.begin(), x.end());
  for (const Cell<dim> &cell : mesh_.cells) picture.cell_node.insert(picture.cell_node.end(), cell.node.begin(), cell.node.end());
  const double total = std::accumulate(scene_.stage.begin(), scene_.stage.end(), 0., [](double s, const Stage &stage) { return s + stage.duration; });
  RunFile file(comm_, options_.directory, header, picture);
  results_.reset(new Results{std::move(file), History(comm_, options_.directory + "/history.csv", {history_.names.begin() + 2, history_.names.end()}),
                             Progress(comm_, options_.directory + "/run.log", total)});
}

template <int dim, class Phases>
Snapshot Simulation<dim, Phases>::snapshot() {
  Snapshot s;
  s.time = time_, s.step = steps_, s.stage = stage_name_;
  const auto column = [&](const char *name, const char *unit, const char *meaning, int components) {
    s.columns.push_back({name, unit, meaning, components, {}});
  };
  column("position", "m", "place of the particle", dim);
  column("displacement", "m", "displacement since the start or the last reset", dim);
  column("velocity", "m/s", "velocity of the soil skeleton", dim);
  column("stress", "Pa", Phases::pressure ? "effective stress, positive in tension" : "stress, positive in tension", stress_size<dim>);
  column("volume", "m3", "volume of the particle", 1);
  column("mass", "kg", "mass of the particle", 1);
  if (Phases::given) column("pore_pressure", "Pa", "pore pressure, positive in compression", 1);
  const size_t first_history = s.columns.size();
  for (const auto &body : bodies_)
    for (const HistoryField &field : history_fields(body->law()))
      if (std::none_of(s.columns.begin(), s.columns.end(), [&](const auto &c) { return c.name == field.name; }))
        column(field.name, field.unit.name, field.meaning, 1);
  std::vector<double> history(16);
  double stress[stress_size<dim>];
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    const auto fields = history_fields(bodies_[b]->law());
    for (int i = 0; i < p.count; ++i) {
      Vec<dim> x, v;
      double volume;
      motion_->present(*bodies_[b], i, &x, &v);
      motion_->state(static_cast<int>(b), i, stress, history.data(), &volume);
      s.id.push_back(p.id[i]), s.body.push_back(static_cast<int>(b));
      size_t k = 0;
      const auto put = [&](const double *values, int count) {
        s.columns[k].values.insert(s.columns[k].values.end(), values, values + count);
        ++k;
      };
      Vec<dim> u;
      for (int d = 0; d < dim; ++d) u[d] = x[d] - p.reference[i][d];
      put(x.data(), dim), put(u.data(), dim), put(v.data(), dim), put(stress, stress_size<dim>), put(&volume, 1), put(&p.mass[i], 1);
      if (Phases::given) {
        const double pressure = motion_->pore_pressure(x);
        put(&pressure, 1);
      }
      for (size_t c = first_history; c < s.columns.size(); ++c) {
        double value = std::numeric_limits<double>::quiet_NaN();
        for (size_t h = 0; h < fields.size(); ++h)
          if (s.columns[c].name == fields[h].name) value = history[h];
        s.columns[c].values.push_back(value);
      }
    }
  }
  return s;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::write_snapshot() {
  if (!results_ || results_->file.last_step() == steps_) return;
  results_->file.write(snapshot());
}

template <int dim, class Phases>
void Simulation<dim, Phases>::write_history() {
  require(motion_->begin(time_));
  if (!history_.rows.empty() && history_.rows.back()[1] == static_cast<double>(steps_)) return;
  std::vector<double> mine, row;
  for (Followed &point : points_) {
    const int i = find(point);
    Vec<dim> x{}, v{};
    double displacement = 0, pressure = 0;
    if (i >= 0) {
      motion_->present(*bodies_[point.body], i, &x, &v);
      displacement = (map<dim>(x) - map<dim>(bodies_[point.body]->particles().reference[i])).norm();
      pressure = motion_->pore_pressure(x);
    }
    mine.insert(mine.end(), x.begin(), x.end());
    mine.push_back(displacement), mine.push_back(map<dim>(v).norm());
    if (Phases::given) mine.push_back(pressure);
  }
  double potential = 0;
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      Vec<dim> x, v;
      motion_->present(*body, i, &x, &v);
      for (int d = 0; d < dim; ++d) potential -= p.mass[i] * scene_.gravity[d] * x[d];
    }
  }
  mine.push_back(potential);
  row.resize(mine.size());
  MPI_Allreduce(mine.data(), row.data(), static_cast<int>(mine.size()), MPI_DOUBLE, MPI_SUM, comm_);
  Balance sums;
  require(motion_->balance(time_, &sums));
  row.insert(row.end() - 1, {sums.kinetic, sums.strain});
  row.push_back(total_mass_), row.push_back(static_cast<double>(particle_count_)), row.push_back(load_time_);
  std::vector<Vec<dim>> impulses, faces;
  require(conditions_.take_impulses(comm_, impulses));
  require(conditions_.face_displacements(comm_, faces));
  const double elapsed = time_ - impulse_time_;
  for (size_t s = 0; s < impulses.size(); ++s)
    for (int d = 0; d < dim; ++d)
      row.push_back(conditions_.loads(static_cast<int>(s)) ? faces[s][d] : elapsed > 0 ? impulses[s][d] / elapsed : 0);
  impulse_time_ = time_;
  row.insert(row.begin(), {time_, static_cast<double>(steps_)});
  history_.rows.push_back(row);
  if (results_) results_->history.row(time_, steps_, stage_name_.empty() ? "start" : stage_name_, {row.begin() + 2, row.end()});
}

template <int dim, class Phases>
void Simulation<dim, Phases>::note(const std::string &text) {
  events_.push_back({time_, load_time_, stage_name_, text});
  if (results_) results_->progress.note(text);
}

/// "(x, y) m" of the lowest rank that has a place to name, empty if none has. Collective.
template <int dim, class Phases>
std::string Simulation<dim, Phases>::place_of(bool mine, const Vec<dim> &where) const {
  int rank, ranks;
  MPI_Comm_rank(comm_, &rank), MPI_Comm_size(comm_, &ranks);
  int first = mine ? rank : ranks;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm_);
  if (first == ranks) return "";
  Vec<dim> place = where;
  MPI_Bcast(place.data(), dim, MPI_DOUBLE, first, comm_);
  std::ostringstream text;
  for (int d = 0; d < dim; ++d) text << (d ? ", " : "(") << place[d];
  return text.str() + ") m";
}

template <int dim, class Phases>
void Simulation<dim, Phases>::fail(const std::string &text) {
  std::ostringstream message;
  message.precision(8);
  message << text << " (t = " << time_ << " s, step " << steps_ << ", stage " << stage_name_ << ")";
  if (results_) message << "; snapshots up to step " << results_->file.last_step() << " are in " << options_.directory;
  if (results_) results_->progress.failure(message.str());
  throw RunError(message.str());
}

template <int dim, class Phases>
std::vector<Vec<dim>> Simulation<dim, Phases>::nodal_displacement() {
  // up to the last remap the mean of the particles around a node, weighted as their velocity is; since then the node's own way
  std::vector<Vec<dim>> u(mesh_.node_count(), Vec<dim>{});
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const Cell<dim> &cell = mesh_.cells[p.cell[i]];
      const auto n = barycentric(cell, p.position[i]);
      for (int k = 0; k <= dim; ++k)
        for (int d = 0; d < dim; ++d) u[cell.node[k]][d] += n[k] * p.mass[i] * (p.position[i][d] - p.reference[i][d]);
    }
  }
  require(mesh_.halo.sum(u.empty() ? nullptr : u[0].data(), dim));
  const FilledGrid<dim> &grid = motion_->grid();
  for (int i = 0; i < grid.node_count(); ++i)
    for (int d = 0; d < dim; ++d) {
      double &value = u[grid.mesh_node[i]][d];
      value = value / grid.mass[i] + grid.position[i][d] - mesh_.position[grid.mesh_node[i]][d];
    }
  return u;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::nodal_field(const std::string &name, const std::function<void(PetscInt, const double *)> &put) {
  const bool displacement = name == "displacement";
  if (!displacement && name != "velocity") throw std::invalid_argument("no nodal field " + name + "; there are velocity and displacement");
  require(motion_->begin(time_));
  std::vector<Vec<dim>> u;
  if (displacement) u = nodal_displacement();
  const FilledGrid<dim> &grid = motion_->grid();
  for (int i = 0; i < grid.node_count(); ++i)
    put(mesh_.plex_vertex[grid.mesh_node[i]], displacement ? u[grid.mesh_node[i]].data() : motion_->velocity() + i * dim);
}

}  // namespace talus
