// Quasi-static stages: finite elements on the scene's mesh, laws and boundaries, and what they hand to the particles;
// included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <sstream>

#include "scene/reader.h"
#include "scene/words.h"
#include "simulation/simulation_impl.h"
#include "solvers/quasi_static/seeped_pressure.h"

namespace talus {

template <int dim>
void Simulation<dim>::make_statics() {
  SoilData<dim> data;
  data.density = [this](const BodySource &source, const Vec<dim> &x, double t) { return soil_density(source, x, t); };
  data.open_water_load = scene_.water.open_water_load;
  if (phases_.prescribed) {
    data.pressure = [this](const Vec<dim> &x, double t) { return pressure_(x, t); };
    if (flow_stages()) {
      const bool dries =
          std::any_of(scene_.body.begin(), scene_.body.end(), [](const BodySource &b) { return b.retention.reader; });
      std::vector<typename Conditions<dim>::Source> water;
      for (BoundarySource &b : scene_.seepage_boundary) {
        water.push_back({b.name, b.group, read_boundary(b.kind)});
        for (const std::string &group : b.group)
          if (!mesh_.has_group(group) && group != free_surface)
            scene_.complain("boundary." + b.name + ".group", "must name groups of facets; the mesh has no \"" + group +
                                                                 "\"; " + suggestion(group, mesh_.group_names()));
      }
      scene_.water.seeped = nullptr;
      flow_ = std::make_unique<PoreFlow<dim>>(mesh_, scene_, conditions_.sources(), dries, water);
    }
  }
  if (phases_.liquid) {
    flow_ = std::make_unique<PoreFlow<dim>>(mesh_, scene_, conditions_.sources(), phases_.suction);
    data.flow = flow_.get();
  }
  statics_ = std::make_unique<QuasiStatic<dim>>(mesh_, scene_, laws_, conditions_.sources(), data);
  for (size_t b = 0; b < bodies_.size(); ++b) {
    GaussPoints<dim> &p = statics_->soil().points()[b];
    const std::vector<Function> &given = scene_.body[b].stress;
    for (int q = 0; q < p.count() && !given.empty(); ++q)
      for (int k = 0; k < stress_size<dim>; ++k)
        p.stress[q * stress_size<dim> + k] =
            given[k](p.position[q][0], p.position[q][1], dim == 3 ? p.position[q][dim - 1] : 0, 0);
  }
}

template <int dim>
PetscErrorCode Simulation<dim>::activate() {
  PetscFunctionBeginUser;
  PetscCall(statics_->activate(present_));
  if (phases_.liquid)
    PetscCall(flow_->activate(statics_->soil().active(),
                              [this](const Vec<dim> &x) { return motion_->initial_pressure(x, load_time_); }));
  if (phases_.prescribed)
    if (flow_)
      PetscCall(flow_->activate(statics_->soil().active(), [this](const Vec<dim> &x) {
        const Function &suction = scene_.water.suction;
        const double above = suction.given() ? suction(x[0], x[1], dim == 3 ? x[dim - 1] : 0, load_time_)
                                             : pressure_.above_table(x, load_time_);
        return pressure_(x, load_time_) - (pressure_.below_table(x, load_time_) ? 0 : above);
      }));
  PetscFunctionReturn(0);
}

/// From now on the pressure of a drained scene is what the flow has found. Laws that read suction see it, others take
/// it for none.
template <int dim>
std::shared_ptr<SeepedPressure<dim>> take_seeped(const PoreFlow<dim> &flow, const std::vector<Law> &laws,
                                                 Water &water) {
  const bool suction = std::any_of(laws.begin(), laws.end(), [](const Law &law) { return reads_suction(law); });
  const auto found = std::make_shared<SeepedPressure<dim>>(flow, suction);
  water.seeped = [found](const double *x) { return (*found)(x); };
  return found;
}

template <int dim>
void Simulation<dim>::count_particles() {
  double mine[2]{}, all[2];
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    mine[0] += p.count, mine[1] += std::accumulate(p.mass, p.mass + p.count, 0.);
  }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, comm_);
  particle_count_ = static_cast<long long>(all[0]), total_mass_ = all[1];
}

/// Bodies that come and go: their particles do too.
template <int dim>
void Simulation<dim>::choose_bodies(const Stage &stage) {
  if (motion_->gathered()) require(release(false));
  int stride = 1;
  for (const BodySource &source : scene_.body) {
    stride = std::max(stride, source.particles_per_cell);
    for (const DenseBox &box : source.dense) stride = std::max(stride, box.particles_per_cell);
  }
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const std::string &name = scene_.body[b].name;
    if (std::count(stage.add.begin(), stage.add.end(), name) && !present_[b]) {
      present_[b] = 1;
      seed<dim>(*bodies_[b], mesh_, stride,
                [&](const Vec<dim> &x) { return soil_density(scene_.body[b], x, load_time_); });
      conditions_.surface_loads().seed(*bodies_[b], mesh_);
      require(bodies_[b]->sort(mesh_.cell_count()));
    }
    if (std::count(stage.remove.begin(), stage.remove.end(), name) && present_[b]) {
      present_[b] = 0;
      require(bodies_[b]->resize(0));
    }
  }
  count_particles();
}

template <int dim>
void Simulation<dim>::run_quasi_static(const Stage &stage) {
  if (stage_.met) {  // a resumed run has it behind it
    if (stage.reset_displacement) reset_displacement();
    return;
  }
  if (options_.resume && !statics_ && stage_.number > 0)
    throw SceneError("the run in " + options_.directory +
                     " cannot be resumed before a quasi-static stage; start it anew");
  stage_name_ = stage.name, hold_loads_ = stage.hold_loads, watched_ = "";
  if (results_) results_->progress.stage(stage.name);
  if (!statics_)
    make_statics();
  else if (moved_since_statics_)
    to_gauss_points();
  choose_bodies(stage);
  for (size_t b = 0; b < laws_.size(); ++b) {
    GaussPoints<dim> &points = statics_->soil().points()[b];
    points.law = with_reduced_strength(laws_[b], strength_factor_);
    // steps are large here: strength would fall within one, though it is not remembered
    int sheared = std::any_of(points.history.begin(), points.history.end(), [](double h) { return h != 0; });
    MPI_Allreduce(MPI_IN_PLACE, &sheared, 1, MPI_INT, MPI_MAX, comm_);
    if (!stage.softening && !sheared) points.law = without_softening(points.law);
  }
  require(activate());
  require(hold_supports(true));
  in_statics_ = true, moved_since_statics_ = false;
  std::string freedom;
  require(statics_->find_freedom(&freedom));
  if (!freedom.empty() && stage.kind != StageKind::seepage)
    fail("the supports leave soil free to move as a whole: " + freedom + "; hold it by fixed or roller boundaries");
  if (scene_.quasi_static.elements != Elements::quadratic && !mesh_.report().one_element_slice) {
    std::vector<char> thin;
    require(statics_->find_thin_bodies(&thin));
    for (size_t b = 0; b < thin.size(); ++b)
      if (thin[b])
        fail("body." + scene_.body[b].name +
             " is one element across, which elements of first order cannot resolve; refine the mesh there, or set "
             "quasi_static.elements = \"quadratic\"");
  }
  if (stage.initial_stress == InitialStress::k0) start_stress();

  const double begin = time_, begin_load = load_time_;
  require(statics_->begin_path(load_time_));
  double share = 0, snapshots = 1;
  StepOutcome outcome;
  int iterations = 0;
  const auto load_at = [&](double s) { return hold_loads_ ? begin_load : begin_load + s * stage.duration; };
  const auto done = [&](double s) {
    time_ = begin + s * stage.duration, load_time_ = load_at(s), ++steps_;
    if (phases_.prescribed && water_flows(stage.kind)) take_seeped<dim>(*flow_, laws_, scene_.water);
    to_particles();
    if (results_) results_->progress.step(time_, steps_, particle_count_);
    write_history();
    if (scene_.output.interval > 0 && s < 1 && s * stage.duration >= snapshots * scene_.output.interval * (1 - 1e-9))
      write_snapshot(), snapshots = std::floor(s * stage.duration / scene_.output.interval * (1 + 1e-9)) + 1;
    int stop = interrupted;
    MPI_Allreduce(MPI_IN_PLACE, &stop, 1, MPI_INT, MPI_MAX, comm_);
    if (stop) write_snapshot(), fail("interrupted");
  };
  if (water_flows(stage.kind))
    follow_water(stage, load_at, done, &share, &outcome, &iterations);
  else
    require(follow_path(
        1. / stage.load_steps, scene_.quasi_static.smallest_step,
        [&](double from, double to, StepOutcome *o) {
          return statics_->advance(to, load_at(to), load_at(from), load_at(to) - load_at(from), stage.softening, o);
        },
        [&](double s, const StepOutcome &) { done(s); }, &share, &outcome, &iterations));
  write_snapshot();
  std::ostringstream text;
  text.precision(3);
  if (share < 1) {
    text << "no equilibrium beyond " << 100 * share << " % of the loads of stage " << stage.name << ": "
         << (outcome.singular ? "the stiffness became singular" : "Newton's iterations did not converge") << " ("
         << outcome.iterations << " iterations, out-of-balance force " << outcome.residual
         << " of the forces, largest step of a node " << outcome.largest << " m)";
    if (stage.when_lost == WhenLost::stop) fail(text.str());
  } else if (stage.kind == StageKind::seepage) {
    text << "stage " << stage.name << (stage.steady ? " has found the flow that lasts: " : " has followed the water: ")
         << iterations << " iterations";
    for (const auto &[name, inflow] : flow_->own_inflow()) text << "; " << inflow << " m3/s enter at " << name;
  } else {
    text << "stage " << stage.name << " is in equilibrium: " << statics_->unknowns() << " unknowns, " << iterations
         << " iterations (" << (statics_->direct() ? "LU" : "GMRES and multigrid") << "), largest displacement "
         << statics_->soil().largest_displacement() << " m";
  }
  Balance sums;
  set_loading(stage, 0);
  require(motion_->begin(time_));
  require(motion_->balance(time_, &sums));
  if (sums.applied > 0)
    text << "; unbalanced force ratio of the particles that take it over " << sums.unbalanced / sums.applied;
  note(text.str());
  stage_.met = true;
  if (phases_.prescribed && water_flows(stage.kind) && results_)  // for a run that is resumed behind this stage
    take_seeped<dim>(*flow_, laws_, scene_.water)->save(comm_, seeped_file(options_.directory));
  write_checkpoint();
  if (stage.reset_displacement) statics_->soil().reset_displacement(), reset_displacement();
}

// ---- hand-over ----

/// Particles stay where they are and take stress and history; the displacement moves the place it is counted from.
/// Stress is linear between the Gauss points of a cell.
template <int dim>
void Simulation<dim>::to_particles() {
  if (motion_->gathered()) require(release(false));
  const int per_cell = statics_->soil().points_per_cell();
  const double near = per_cell > 1 ? statics_->soil().rule().point[0][0] : 1,
               far = per_cell > 1 ? statics_->soil().rule().point[0][1] : 0;
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    const GaussPoints<dim> &points = statics_->soil().points()[b];
    const int memory = bodies_[b]->history_count();
    for (int i = 0; i < p.count; ++i) {
      const int cell = p.cell[i], first = statics_->soil().first_point(cell);
      const Barycentric<dim> l = barycentric(mesh_.cells[cell], p.position[i]);
      std::array<double, dim + 1> weight{};
      for (int a = 0; a < per_cell; ++a) weight[a] = per_cell > 1 ? (l[a] - far) / (near - far) : 1;
      const auto value = [&](const std::vector<double> &field, int width, int k) {
        double sum = 0;
        for (int a = 0; a < per_cell; ++a) sum += weight[a] * field[(first + a) * width + k];
        return sum;
      };
      for (int k = 0; k < stress_size<dim>; ++k)
        p.stress[i * stress_size<dim> + k] = value(points.stress, stress_size<dim>, k);
      for (int k = 0; k < memory; ++k) {  // not beyond what the points have: strength must not grow
        double low = points.history[first * memory + k], high = low;
        for (int a = 1; a < per_cell; ++a)
          low = std::min(low, points.history[(first + a) * memory + k]),
          high = std::max(high, points.history[(first + a) * memory + k]);
        p.history[i * memory + k] = std::clamp(value(points.history, memory, k), low, high);
      }
      const Vec<dim> u = statics_->soil().displacement(cell, l);
      for (int d = 0; d < dim; ++d) p.reference[i][d] = p.position[i][d] - u[d], p.velocity[i][d] = 0;
    }
  }
  fill_pores();
}

/// The other way after a dynamic stage: Gauss points take the mean of the particles in their cell, weighted by volume;
/// cells that have none keep what they had.
template <int dim>
void Simulation<dim>::to_gauss_points() {
  pressure_from_particles();
  if (motion_->gathered()) require(release(false));
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    GaussPoints<dim> &points = statics_->soil().points()[b];
    const int memory = bodies_[b]->history_count(), width = stress_size<dim> + memory;
    std::vector<double> sums(static_cast<size_t>(mesh_.cell_count()) * width, 0), volume(mesh_.cell_count(), 0);
    for (int i = 0; i < p.count; ++i) {
      double *s = &sums[static_cast<size_t>(p.cell[i]) * width];
      volume[p.cell[i]] += p.volume[i];
      for (int k = 0; k < stress_size<dim>; ++k) s[k] += p.volume[i] * p.stress[i * stress_size<dim> + k];
      for (int k = 0; k < memory; ++k) s[stress_size<dim> + k] += p.volume[i] * p.history[i * memory + k];
    }
    for (int q = 0; q < points.count(); ++q) {
      const int cell = points.cell[q];
      if (volume[cell] == 0) continue;
      const double *s = &sums[static_cast<size_t>(cell) * width];
      for (int k = 0; k < stress_size<dim>; ++k) points.stress[q * stress_size<dim> + k] = s[k] / volume[cell];
      for (int k = 0; k < memory; ++k) points.history[q * memory + k] = s[stress_size<dim> + k] / volume[cell];
    }
  }
}

template <int dim>
Snapshot Simulation<dim>::gauss_points() const {
  Snapshot s;
  s.time = time_, s.step = steps_, s.stage = stage_name_;
  const auto column = [&](const char *name, const char *unit, const char *meaning, int components) {
    s.columns.push_back({name, unit, meaning, components, {}});
  };
  column("position", "m", "place of the Gauss point", dim);
  column("displacement", "m", "displacement since the start or the last reset", dim);
  column("stress", "Pa", phases_.pressure ? "effective stress, positive in tension" : "stress, positive in tension",
         stress_size<dim>);
  column("volume", "m3", "volume of the Gauss point", 1);
  column("mass", "kg", "mass of the Gauss point", 1);
  column("shear_strain", "-", "sqrt(2/3 e : e) of the deviator e of strain, since displacement was last reset", 1);
  if (phases_.pressure) column("pore_pressure", "Pa", "pore pressure, positive in compression", 1);
  if (phases_.suction) column("saturation", "-", "degree of saturation", 1);
  const size_t first_history = s.columns.size();
  for (const auto &body : bodies_)
    for (const HistoryField &field : history_fields(body->law()))
      if (std::none_of(s.columns.begin(), s.columns.end(), [&](const auto &c) { return c.name == field.name; }))
        column(field.name, field.unit.name, field.meaning, 1);
  const int per_cell = statics_->soil().points_per_cell();
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const GaussPoints<dim> &p = statics_->soil().points()[b];
    if (!p.present) continue;
    const auto fields = history_fields(bodies_[b]->law());
    const int memory = static_cast<int>(fields.size());
    for (int q = 0; q < p.count(); ++q) {
      const int place = (q - statics_->soil().first_point(p.cell[q]));
      s.id.push_back(mesh_.global_cell[p.cell[q]] * per_cell + place), s.body.push_back(static_cast<int>(b));
      size_t k = 0;
      const auto put = [&](const double *values, int count) {
        s.columns[k].values.insert(s.columns[k].values.end(), values, values + count);
        ++k;
      };
      const Vec<dim> u = statics_->soil().displacement(p.cell[q], statics_->soil().rule().point[place]);
      Stress<dim> strain;
      std::copy_n(&p.total_strain[q * stress_size<dim>], stress_size<dim>, &strain.xx);
      const Barycentric<dim> &l = statics_->soil().rule().point[place];
      const double mass = p.volume[q] * (soil_density(scene_.body[b], p.position[q], load_time_) +
                                         (phases_.liquid ? flow_->water_density(p.cell[q], l) : 0));
      const double shear = Invariants<dim>(strain).q * std::sqrt(4. / 3);
      put(p.position[q].data(), dim), put(u.data(), dim), put(&p.stress[q * stress_size<dim>], stress_size<dim>);
      put(&p.volume[q], 1), put(&mass, 1), put(&shear, 1);
      if (phases_.prescribed) {
        const double pressure = pressure_(p.position[q], load_time_);
        put(&pressure, 1);
      }
      if (phases_.liquid) {
        const double pressure = flow_->pressure_at(p.cell[q], l), saturation = flow_->saturation(p.cell[q], l);
        put(&pressure, 1);
        if (phases_.suction) put(&saturation, 1);
      }
      for (size_t c = first_history; c < s.columns.size(); ++c) {
        double value = std::numeric_limits<double>::quiet_NaN();
        for (int h = 0; h < memory; ++h)
          if (s.columns[c].name == fields[h].name) value = p.history[q * memory + h];
        s.columns[c].values.push_back(value);
      }
    }
  }
  return s;
}

// ---- initial stress ----

/// k0 of a body: its own, else Jaky's 1 - sin(phi) of the friction angle, else that of elastic soil held at its sides.
inline double earth_pressure_at_rest(const BodySource &source, const Law &law) {
  if (source.k0 > 0) return source.k0;
  return std::visit(
      [](const auto &one) {
        if constexpr (requires { one.friction_angle; })
          return 1 - std::sin(one.friction_angle);
        else
          return (3 * one.bulk_modulus() - 2 * one.shear_modulus()) /
                 (3 * one.bulk_modulus() + 4 * one.shear_modulus());
      },
      law);
}

/// Vertical stress by the weight of soil and open water above, lateral stress k0 times its effective part. Every rank
/// sees all cells.
template <int dim>
void Simulation<dim>::start_stress() {
  struct Block {
    std::array<Vec<dim>, dim + 1> corner;
    double density, low, high;  // extent along x
  };
  std::vector<Block> mine, all;
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    const int b = statics_->soil().body_of(c);
    if (b < 0 || !present_[b]) continue;
    Block block{{}, 0, 1e300, -1e300};
    Vec<dim> centre{};
    for (int a = 0; a <= dim; ++a) {
      block.corner[a] = mesh_.position[mesh_.cells[c].node[a]];
      block.low = std::min(block.low, block.corner[a][0]), block.high = std::max(block.high, block.corner[a][0]);
      for (int d = 0; d < dim; ++d) centre[d] += block.corner[a][d] / (dim + 1);
    }
    block.density = soil_density(scene_.body[b], centre, load_time_);
    Barycentric<dim> middle;
    middle.fill(1. / (dim + 1));
    if (phases_.liquid) block.density += flow_->water_density(c, middle);
    mine.push_back(block);
  }
  int ranks;
  MPI_Comm_size(comm_, &ranks);
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  const int bytes = static_cast<int>(mine.size() * sizeof(Block));
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm_);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  all.resize(starts[ranks] / sizeof(Block));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), counts.data(), starts.data(), MPI_BYTE, comm_);
  double low = 1e300, high = -1e300;
  for (const Block &block : all) low = std::min(low, block.low), high = std::max(high, block.high);
  const int strips = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(all.size()))));
  const auto strip_of = [&](double x) {
    return std::clamp(static_cast<int>((x - low) / (high - low) * strips), 0, strips - 1);
  };
  std::vector<std::vector<int>> in_strip(strips);
  for (size_t k = 0; k < all.size(); ++k)
    for (int s = strip_of(all[k].low); s <= strip_of(all[k].high); ++s) in_strip[s].push_back(static_cast<int>(k));

  for (size_t b = 0; b < bodies_.size(); ++b) {
    GaussPoints<dim> &points = statics_->soil().points()[b];
    if (!present_[b]) continue;
    const double k0 = earth_pressure_at_rest(scene_.body[b], laws_[b]);
    for (int q = 0; q < points.count(); ++q) {
      const Vec<dim> &x = points.position[q];
      double weight = 0, top = x[1];
      for (int k : in_strip[strip_of(x[0])]) {
        // the part of the vertical through x that lies in the simplex and above x: barycentric coordinates are linear
        // along it
        const Block &block = all[k];
        if (x[0] < block.low || x[0] > block.high) continue;
        Square<dim> edges;
        for (int a = 0; a < dim; ++a) edges.col(a) = map<dim>(block.corner[a + 1]) - map<dim>(block.corner[0]);
        const Square<dim> inverse = edges.inverse();
        const ColumnVector<dim> at = inverse * (map<dim>(x) - map<dim>(block.corner[0])), slope = inverse.col(1);
        double from = 0, to = 1e300;  // height above x
        const auto cut = [&](double value, double rise) {
          if (rise > 0)
            from = std::max(from, -value / rise);
          else if (rise < 0)
            to = std::min(to, -value / rise);
          else if (value < 0)
            to = 0;
        };
        cut(1 - at.sum(), -slope.sum());
        for (int a = 0; a < dim; ++a) cut(at[a], slope[a]);
        if (to > from) weight -= block.density * scene_.gravity[1] * (to - from), top = std::max(top, x[1] + to);
      }
      double pressure = 0;
      if (phases_.prescribed) {
        Vec<dim> surface = x;
        surface[1] = top;
        pressure = pressure_(x, load_time_);
        if (scene_.water.open_water_load) weight += pressure_(surface, load_time_);
      }
      if (phases_.liquid)
        pressure = flow_->stress_pressure(points.cell[q],
                                          statics_->soil().rule().point[q % statics_->soil().points_per_cell()]);
      double *stress = &points.stress[q * stress_size<dim>];
      std::fill_n(stress, stress_size<dim>, 0.);
      stress[1] = pressure - weight, stress[0] = stress[2] = k0 * stress[1];
    }
  }
}

// ---- strength reduction ----

template <int dim>
FactorOfSafety Simulation<dim>::factor_of_safety() {
  constexpr double least_factor = 0.1;
  for (size_t k = 0; k < scene_.stage.size(); ++k)
    if (!is_static(scene_.stage[k].kind))
      scene_.complain("stage." + std::to_string(k) + ".kind", "must be \"quasi_static\" for a factor of safety");
  for (;; strength_factor_ /= 2) {
    try {
      if (steps_ == 0) run();
      break;
    } catch (const RunError &) {  // no equilibrium with this strength: come from a larger one
      if (interrupted || !in_statics_ || strength_factor_ / 2 < least_factor) throw;
      note("strength divided by " + rounded(strength_factor_) +
           " is too little for the stages; they start again with twice of it");
      time_ = load_time_ = 0, steps_ = 0, last_row_step_ = -1, stage_ = StageState{}, in_statics_ = false,
      statics_.reset();
    }
  }
  double low[dim], high[dim], extent = 0;
  for (int d = 0; d < dim; ++d) low[d] = 1e300, high[d] = -1e300;
  for (const BodyReport &body : bodies())
    for (int d = 0; d < dim; ++d) low[d] = std::min(low[d], body.low[d]), high[d] = std::max(high[d], body.high[d]);
  for (int d = 0; d < dim; ++d) extent = std::max(extent, high[d] - low[d]);
  FactorOfSafety result;
  std::FILE *table = nullptr;
  int rank;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0 && !options_.directory.empty()) {
    table = std::fopen((options_.directory + "/factor_of_safety.csv").c_str(), "w");
    if (table) std::fprintf(table, "factor,stable,iterations,residual,displacement_m,reason\n");
  }
  stage_name_ = "strength reduction";
  require(reduce_strength<dim>(
      *statics_, laws_, strength_factor_, load_time_, time_, 0.1 * extent, 0.01,
      [&](const StrengthTrial &t) {
        note("strength divided by " + rounded(t.factor) + ": " + (t.stable ? "stable" : t.reason) + ", " +
             std::to_string(t.iterations) + " iterations, largest displacement " + rounded(t.displacement) + " m");
        if (table)
          std::fprintf(table, "%.6g,%d,%d,%.3g,%.6g,%s\n", t.factor, t.stable, t.iterations, t.residual, t.displacement,
                       t.reason.c_str()),
              std::fflush(table);
      },
      &result));
  if (table) std::fclose(table);
  if (result.upper == 0)
    fail("strength divided by " + rounded(result.lower) + " still has an equilibrium: there is nothing to fail");
  ++steps_;
  to_particles();
  write_history();
  write_snapshot();
  return result;
}

}  // namespace talus
