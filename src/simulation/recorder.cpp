#include "simulation/recorder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "base/version.h"
#include "output/pictures.h"
#include "output/together.h"
#include "scene/changes.h"
#include "scene/reader.h"
#include "scene/words.h"
#include "solvers/quasi_static/seeped_pressure.h"

namespace talus {

template <int dim>
Recorder<dim>::Recorder(const Sources<dim> &of, const RunOptions &options)
    : of_(of), scene_(of.world.scene), phases_(of.world.phases), options_(options) {
  check_pictures();
}

// ---- files ----

template <int dim>
void Recorder<dim>::open() {
  name_columns();
  if (options_.directory.empty()) return;
  int rank;
  MPI_Comm_rank(of_.world.comm, &rank);
  if (rank == 0 && has_flow_stages(scene_) && phases_.prescribed)
    std::filesystem::remove(seeped_file(options_.directory));  // of a run that was here before
  RunHeader header{scene_.title, program, scene_.source, {}};
  for (const auto &body : of_.world.bodies) header.bodies.push_back(body->name());
  MeshPicture picture;
  picture.dimension = dim;
  for (const Vec<dim> &x : of_.world.mesh.position) picture.position.insert(picture.position.end(), x.begin(), x.end());
  for (const Cell<dim> &cell : of_.world.mesh.cells)
    picture.cell_node.insert(picture.cell_node.end(), cell.node.begin(), cell.node.end());
  RunFile file(of_.world.comm, options_.directory, header, picture);
  History rows(of_.world.comm, options_.directory + "/history.csv", {history_.names.begin() + 2, history_.names.end()});
  results_.reset(new Files{std::move(file), std::move(rows),
                           Progress(of_.world.comm, options_.directory + "/run.log", longest_duration())});
}

template <int dim>
void Recorder<dim>::append() {
  name_columns();
  RunFile file = RunFile::append(of_.world.comm, options_.directory, last_snapshot_time_);
  History rows = History::append(of_.world.comm, options_.directory + "/history.csv",
                                 {history_.names.begin() + 2, history_.names.end()}, last_row_time_);
  results_.reset(new Files{std::move(file), std::move(rows),
                           Progress(of_.world.comm, options_.directory + "/run.log", longest_duration(), true)});
  results_->progress.note("resumed at t = " + rounded(of_.clock.time) + " s, step " + std::to_string(of_.clock.steps));
}

template <int dim>
void Recorder<dim>::close() {
  if (!results_) return;
  note_steps();
  results_->progress.finish();
  int rank;
  MPI_Comm_rank(of_.world.comm, &rank);
  if (rank == 0 && options_.pictures) draw_pictures(options_.directory, {.fields = scene_.output.picture, .times = {}});
}

/// Time at which the run ends at the latest [s].
template <int dim>
double Recorder<dim>::longest_duration() const {
  return std::accumulate(scene_.stage.begin(), scene_.stage.end(), 0.,
                         [](double s, const Stage &stage) { return s + stage.duration; });
}

/// A picture that nobody can draw is refused before the run, not missed after it.
template <int dim>
void Recorder<dim>::check_pictures() {
  if (scene_.output.picture.empty()) return;
  const Snapshot state = snapshot();
  std::vector<std::string> known;
  for (const Column &column : state.columns)
    if (column.name != "position") known.push_back(column.name);
  for (const std::string &field : scene_.output.picture) {
    const bool drawn = std::any_of(state.columns.begin(), state.columns.end(), [&](const Column &column) {
      return field == column.name || (column.components > 1 && field.rfind(column.name + "_", 0) == 0);
    });
    if (!drawn)
      scene_.complain("output.picture",
                      "names \"" + field + "\", which this run does not have; " + suggestion(field, known));
  }
}

// ---- what happens ----

template <int dim>
void Recorder<dim>::begin_stage(const std::string &name) {
  if (results_) results_->progress.stage(name);
}

template <int dim>
void Recorder<dim>::progress() {
  if (results_) results_->progress.step(of_.clock.time, of_.clock.steps, of_.world.particle_count);
}

template <int dim>
void Recorder<dim>::note(const std::string &text) {
  note(text, of_.clock.time, of_.clock.load_time);
}

template <int dim>
void Recorder<dim>::note(const std::string &text, double time, double load_time) {
  events_.push_back({time, load_time, of_.clock.stage, text});
  if (results_) results_->progress.note(text);
}

/// What the integrator did, for the log.
template <int dim>
void Recorder<dim>::note_steps() {
  const StepStatistics &s = of_.dynamics.statistics();
  if (s.steps == 0) return;  // nothing but equilibria
  const std::pair<long long, const char *> bounds[] = {
      {s.by_error, "the error"}, {s.by_stability, "stability"}, {s.by_schedule, "outputs"}};
  std::ostringstream text;
  text.precision(3);
  text << s.steps << " steps from " << s.shortest << " to " << s.longest << " s, " << s.evaluations
       << " evaluations of the forces, " << s.rejections << " attempts rejected by the error test, " << s.inversions
       << " because a cell turned inside out; steps bounded by";
  for (const auto &[count, what] : bounds)
    text << " " << what << ": " << count << (what == bounds[2].second ? "" : ",");
  note(text.str());
}

template <int dim>
void Recorder<dim>::fail(const std::string &cause) {
  std::ostringstream message;
  message.precision(8);
  message << cause << " (t = " << of_.clock.time << " s, step " << of_.clock.steps << ", stage " << of_.clock.stage
          << ")";
  if (results_) message << "; snapshots up to step " << results_->file.last_step() << " are in " << options_.directory;
  if (checkpoint_time_ >= 0) message << ", and --resume goes on from t = " << checkpoint_time_ << " s";
  if (results_) {
    note_steps();
    results_->progress.failure(message.str());
  }
  throw RunError(message.str());
}

// ---- history ----

template <int dim>
void Recorder<dim>::name_columns() {
  const char axis[] = "xyz";
  history_.names = {"time_s", "step"};
  for (const auto &point : of_.points.all()) {
    for (int d = 0; d < dim; ++d) history_.names.push_back(point.name + "_" + axis[d] + "_m");
    history_.names.push_back(point.name + "_displacement_m");
    history_.names.push_back(point.name + "_velocity_m_s");
    if (phases_.pressure) history_.names.push_back(point.name + "_pore_pressure_Pa");
    if (phases_.gas) history_.names.push_back(point.name + "_gas_pressure_Pa");
    if (phases_.suction)
      history_.names.push_back(point.name + "_suction_Pa"), history_.names.push_back(point.name + "_saturation");
  }
  for (const char *name : {"kinetic_J", "strain_J", "potential_J", "mass_kg", "particles", "load_time_s"})
    history_.names.push_back(name);
  for (int a = 0; a < phases_.fluids(); ++a)
    for (const char *name : {"_kg", "_out_kg", "_given_kg", "_error_kg"})
      history_.names.push_back(std::string(a ? "gas" : "water") + name);
  if (has_flow_stages(scene_))
    for (const auto &source : of_.world.conditions.sources())
      if (concerns_water(source.kind)) history_.names.push_back(source.name + "_inflow_m3_s");
  // a loaded face shows how far it went, every other boundary the force by which it holds the soil
  for (size_t s = 0; s < of_.world.conditions.sources().size(); ++s)
    for (int d = 0; d < dim; ++d)
      history_.names.push_back(of_.world.conditions.sources()[s].name +
                               (of_.world.conditions.loads(static_cast<int>(s)) ? "_displacement_" : "_force_") +
                               axis[d] + (of_.world.conditions.loads(static_cast<int>(s)) ? "_m" : "_N"));
  for (const auto &source : of_.world.conditions.sources()) history_.names.push_back("work_" + source.name + "_J");
  for (const char *name : {"work_gravity_J", "work_imposed_J", "work_damping_J", "dissipated_J"})
    history_.names.push_back(name);
}

template <int dim>
void Recorder<dim>::write_history() {
  require(of_.world.motion->begin(of_.clock.time));
  if (last_row_step_ == of_.clock.steps) return;
  last_row_step_ = of_.clock.steps, last_row_time_ = of_.clock.time;
  std::vector<double> mine, row;
  for (auto &point : of_.points.all()) {
    const int i = of_.points.find(point);
    Vec<dim> x{}, v{};
    double displacement = 0, pressure = 0;
    PoreReport pores;
    if (i >= 0) {
      of_.world.motion->present(*of_.world.bodies[point.body], i, &x, &v);
      displacement = (map<dim>(x) - map<dim>(of_.world.bodies[point.body]->particles().reference[i])).norm();
      if (phases_.prescribed) pressure = of_.world.motion->pore_pressure(x);
      if (phases_.liquid) pores = of_.world.motion->pores(*of_.world.bodies[point.body], i), pressure = pores.liquid;
    }
    mine.insert(mine.end(), x.begin(), x.end());
    mine.push_back(displacement), mine.push_back(map<dim>(v).norm());
    if (phases_.pressure) mine.push_back(pressure);
    if (phases_.gas) mine.push_back(pores.gas);
    if (phases_.suction) mine.push_back(pores.suction), mine.push_back(pores.saturation);
  }
  double potential = 0;
  for (const auto &body : of_.world.bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      Vec<dim> x, v;
      of_.world.motion->present(*body, i, &x, &v);
      for (int d = 0; d < dim; ++d) potential -= p.mass[i] * scene_.gravity[d] * x[d];
    }
  }
  mine.push_back(potential);
  row.resize(mine.size());
  MPI_Allreduce(mine.data(), row.data(), static_cast<int>(mine.size()), MPI_DOUBLE, MPI_SUM, of_.world.comm);
  Balance sums;
  require(of_.world.motion->balance(of_.clock.time, &sums));
  row.insert(row.end() - 1, {sums.kinetic, sums.strain});
  row.push_back(of_.world.total_mass), row.push_back(static_cast<double>(of_.world.particle_count)),
      row.push_back(of_.clock.load_time);
  if (phases_.liquid) {
    FluidLedger fluids[2];
    require(of_.world.motion->fluid_ledger(fluids));
    if (first_ledger_.empty())
      for (int a = 0; a < phases_.fluids(); ++a)
        first_ledger_.push_back(fluids[a].stored + fluids[a].out - fluids[a].prescribed);
    for (int a = 0; a < phases_.fluids(); ++a) {
      const double error = fluids[a].stored + fluids[a].out - fluids[a].prescribed - first_ledger_[a];
      row.insert(row.end(), {fluids[a].stored, fluids[a].out, fluids[a].prescribed, error});
    }
  }
  if (has_flow_stages(scene_)) {
    const std::vector<double> inflow = of_.statics.inflow();
    for (size_t s = 0; s < inflow.size(); ++s)
      if (concerns_water(of_.world.conditions.sources()[s].kind)) row.push_back(inflow[s]);
  }
  std::vector<Vec<dim>> impulses, faces(of_.world.conditions.sources().size());
  require(of_.world.conditions.take_impulses(of_.world.comm, impulses));
  require(of_.world.conditions.surface_loads().mean_displacements(of_.world.motion->grid(), faces));
  if (of_.statics.current()) require(of_.statics.problem().boundary_forces(of_.clock.load_time, impulses, faces));
  const double elapsed = of_.statics.current() ? 1 : of_.clock.time - impulse_time_;
  for (size_t s = 0; s < impulses.size(); ++s)
    for (int d = 0; d < dim; ++d)
      row.push_back(of_.world.conditions.loads(static_cast<int>(s)) ? faces[s][d]
                    : elapsed > 0                                   ? impulses[s][d] / elapsed
                                                                    : 0);
  impulse_time_ = of_.clock.time;
  std::vector<double> work = of_.world.conditions.work();
  const WorkDone &done = of_.world.motion->work();
  work.insert(work.end(), {done.gravity, done.imposed, done.damping});
  MPI_Allreduce(MPI_IN_PLACE, work.data(), static_cast<int>(work.size()), MPI_DOUBLE, MPI_SUM, of_.world.comm);
  const double held = sums.kinetic + sums.strain;
  if (of_.clock.time == 0) first_energy_ = held;
  row.insert(row.end(), work.begin(), work.end());
  row.push_back(first_energy_ + std::accumulate(work.begin(), work.end(), 0.) - held);
  row.insert(row.begin(), {of_.clock.time, static_cast<double>(of_.clock.steps)});
  history_.rows.push_back(row);
  if (results_)
    results_->history.row(of_.clock.time, of_.clock.steps, of_.clock.stage.empty() ? "start" : of_.clock.stage,
                          {row.begin() + 2, row.end()});
}

// ---- snapshots ----

template <int dim>
Snapshot Recorder<dim>::snapshot() {
  return options_.gauss_points && of_.statics.current() ? of_.statics.gauss_points() : particles();
}

template <int dim>
Snapshot Recorder<dim>::particles() {
  if (phases_.liquid) require(of_.world.motion->begin(of_.clock.time));  // pressures follow from what cells hold
  Snapshot s;
  s.time = of_.clock.time, s.step = of_.clock.steps, s.stage = of_.clock.stage;
  const StepStatistics &sums = of_.dynamics.statistics();
  for (const auto &[name, value] : {std::pair{"evaluations", sums.evaluations},
                                    {"rejections", sums.rejections},
                                    {"inversions", sums.inversions},
                                    {"steps_bounded_by_error", sums.by_error},
                                    {"steps_bounded_by_stability", sums.by_stability},
                                    {"steps_bounded_by_outputs", sums.by_schedule}})
    s.numbers.emplace_back(name, static_cast<double>(value));
  s.numbers.emplace_back("shortest_step_s", sums.steps ? sums.shortest : 0);
  s.numbers.emplace_back("longest_step_s", sums.longest);
  const auto column = [&](const char *name, const char *unit, const char *meaning, int components) {
    s.columns.push_back({name, unit, meaning, components, {}});
  };
  column("position", "m", "place of the particle", dim);
  column("displacement", "m", "displacement since the start or the last reset", dim);
  column("velocity", "m/s", "velocity of the soil skeleton", dim);
  column("stress", "Pa", phases_.pressure ? "effective stress, positive in tension" : "stress, positive in tension",
         stress_size<dim>);
  column("volume", "m3", "volume of the particle", 1);
  column("mass", "kg", "mass of the particle", 1);
  if (phases_.pressure) column("pore_pressure", "Pa", "pore pressure, positive in compression", 1);
  if (phases_.gas) column("gas_pressure", "Pa", "gauge pressure of the pore gas", 1);
  if (phases_.suction)
    column("suction", "Pa", "gas less liquid pressure, where positive", 1),
        column("saturation", "-", "degree of saturation", 1);
  if (phases_.liquid)
    column("porosity", "-", "porosity", 1), column("surface", "-",
                                                   "1 in cells with a side through which fluids may pass, named or the "
                                                   "soil's surface where it is now; 0 elsewhere",
                                                   1);
  const size_t first_history = s.columns.size();
  for (const auto &body : of_.world.bodies)
    for (const HistoryField &field : history_fields(body->law()))
      if (std::none_of(s.columns.begin(), s.columns.end(), [&](const auto &c) { return c.name == field.name; }))
        column(field.name, field.unit.name, field.meaning, 1);
  std::vector<double> history(16);
  double stress[stress_size<dim>];
  for (size_t b = 0; b < of_.world.bodies.size(); ++b) {
    const ParticleArrays<dim> &p = of_.world.bodies[b]->particles();
    const auto fields = history_fields(of_.world.bodies[b]->law());
    for (int i = 0; i < p.count; ++i) {
      Vec<dim> x, v;
      double volume;
      of_.world.motion->present(*of_.world.bodies[b], i, &x, &v);
      of_.world.motion->state(static_cast<int>(b), i, stress, history.data(), &volume);
      s.id.push_back(p.id[i]), s.body.push_back(static_cast<int>(b));
      size_t k = 0;
      const auto put = [&](const double *values, int count) {
        s.columns[k].values.insert(s.columns[k].values.end(), values, values + count);
        ++k;
      };
      Vec<dim> u;
      for (int d = 0; d < dim; ++d) u[d] = x[d] - p.reference[i][d];
      put(x.data(), dim), put(u.data(), dim), put(v.data(), dim), put(stress, stress_size<dim>), put(&volume, 1),
          put(&p.mass[i], 1);
      if (phases_.prescribed) {
        const double pressure = of_.world.motion->pore_pressure(x);
        put(&pressure, 1);
      }
      if (phases_.liquid) {
        const PoreReport pores = of_.world.motion->pores(*of_.world.bodies[b], i);
        put(&pores.liquid, 1);
        if (phases_.gas) put(&pores.gas, 1);
        if (phases_.suction) put(&pores.suction, 1), put(&pores.saturation, 1);
        const double porosity = 1 - p.mass[i] / (of_.world.bodies[b]->source().grain_density * volume);
        put(&porosity, 1);
        const double surface = pores.surface;
        put(&surface, 1);
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

template <int dim>
void Recorder<dim>::write_snapshot() {
  if (!results_ || results_->file.last_step() == of_.clock.steps) return;
  results_->file.write(snapshot());
  last_snapshot_time_ = of_.clock.time;
}

// ---- checkpoints ----

template <int dim>
CheckpointHeader Recorder<dim>::checkpoint_header(int stage) const {
  CheckpointHeader header{
      program, scene_.root ? scene_.root->values() : "", of_.clock.time, of_.clock.steps, checkpoints_ + 1, stage, 0};
  MPI_Comm_size(of_.world.comm, &header.ranks);
  return header;
}

template <int dim>
void Recorder<dim>::write_checkpoint(int stage, const Archive &state) {
  talus::write_checkpoint(of_.world.comm, options_.directory, checkpoint_header(stage), state);
  ++checkpoints_, checkpoint_time_ = of_.clock.time;
}

/// Only what the state does not depend on may differ: results, and how long stages last that have not ended.
template <int dim>
CheckpointHeader Recorder<dim>::check_checkpoint() const {
  const CheckpointHeader found = read_checkpoint_header(of_.world.comm, options_.directory),
                         mine = checkpoint_header(-1);
  const std::string refusal = "the run in " + options_.directory + " cannot be resumed: ";
  if (found.program != mine.program)
    throw SceneError(refusal + "it is one of " + found.program + ", this is " + mine.program);
  for (const std::string &path : changed_keys(found.scene, mine.scene)) {
    const std::vector<std::string> words = split(path);
    const bool listed = words.size() > 1 && words[0] == "stage";
    const int stage = listed ? std::stoi(words[1]) : 0;
    const bool result = words[0] == "title" || (words[0] == "output" && words.size() > 1 && words[1] != "point");
    const bool to_come = listed && (stage > found.stage || (stage == found.stage && words.back() == "duration"));
    if (!result && !to_come)
      scene_.complain(path, "is not what it was when the run in " + options_.directory +
                                " began; with --resume only [output] without its points, the duration of the present "
                                "stage and the stages after it may change");
  }
  if (found.ranks != mine.ranks)
    throw SceneError(refusal + "it ran on " + std::to_string(found.ranks) + " ranks, not " +
                     std::to_string(mine.ranks) + "; give -n " + std::to_string(found.ranks));
  return found;
}

template <int dim>
void Recorder<dim>::serialize(Archive &archive) {
  archive.serialize("results", last_row_step_, last_row_time_, last_snapshot_time_, impulse_time_, first_ledger_,
                    first_energy_);
}

template class Recorder<2>;
template class Recorder<3>;

}  // namespace talus
