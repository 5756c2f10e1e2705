// What a run tells: snapshots, history, notes, and why it ended.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "base/version.h"
#include "simulation/simulation_impl.h"

namespace talus {

template <int dim>
void Simulation<dim>::name_columns() {
  const char axis[] = "xyz";
  history_.names = {"time_s", "step"};
  for (const Followed &point : points_) {
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
  if (flow_stages())
    for (const auto &source : conditions_.sources())
      if (concerns_water(source.kind)) history_.names.push_back(source.name + "_inflow_m3_s");
  // a loaded face shows how far it went, every other boundary the force by which it holds the soil
  for (size_t s = 0; s < conditions_.sources().size(); ++s)
    for (int d = 0; d < dim; ++d)
      history_.names.push_back(conditions_.sources()[s].name +
                               (conditions_.loads(static_cast<int>(s)) ? "_displacement_" : "_force_") + axis[d] +
                               (conditions_.loads(static_cast<int>(s)) ? "_m" : "_N"));
  for (const auto &source : conditions_.sources()) history_.names.push_back("work_" + source.name + "_J");
  for (const char *name : {"work_gravity_J", "work_imposed_J", "work_damping_J", "dissipated_J"})
    history_.names.push_back(name);
}

template <int dim>
void Simulation<dim>::open_results() {
  name_columns();
  if (options_.directory.empty()) return;
  RunHeader header{scene_.title, program, scene_.source, {}};
  for (const auto &body : bodies_) header.bodies.push_back(body->name());
  MeshPicture picture;
  picture.dimension = dim;
  for (const Vec<dim> &x : mesh_.position) picture.position.insert(picture.position.end(), x.begin(), x.end());
  for (const Cell<dim> &cell : mesh_.cells)
    picture.cell_node.insert(picture.cell_node.end(), cell.node.begin(), cell.node.end());
  RunFile file(comm_, options_.directory, header, picture);
  History rows(comm_, options_.directory + "/history.csv", {history_.names.begin() + 2, history_.names.end()});
  results_.reset(new Results{std::move(file), std::move(rows),
                             Progress(comm_, options_.directory + "/run.log", longest_duration())});
}

/// Time at which the run ends at the latest [s].
template <int dim>
double Simulation<dim>::longest_duration() const {
  return std::accumulate(scene_.stage.begin(), scene_.stage.end(), 0.,
                         [](double s, const Stage &stage) { return s + stage.duration; });
}

template <int dim>
Snapshot Simulation<dim>::snapshot() {
  if (options_.gauss_points && in_statics_) return gauss_points();
  if (phases_.liquid) require(motion_->begin(time_));  // pressures follow from what cells hold
  Snapshot s;
  s.time = time_, s.step = steps_, s.stage = stage_name_;
  const StepStatistics &sums = integrator_->statistics();
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
      put(x.data(), dim), put(u.data(), dim), put(v.data(), dim), put(stress, stress_size<dim>), put(&volume, 1),
          put(&p.mass[i], 1);
      if (phases_.prescribed) {
        const double pressure = motion_->pore_pressure(x);
        put(&pressure, 1);
      }
      if (phases_.liquid) {
        const PoreReport pores = motion_->pores(*bodies_[b], i);
        put(&pores.liquid, 1);
        if (phases_.gas) put(&pores.gas, 1);
        if (phases_.suction) put(&pores.suction, 1), put(&pores.saturation, 1);
        const double porosity = 1 - p.mass[i] / (bodies_[b]->source().grain_density * volume);
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
void Simulation<dim>::write_snapshot() {
  if (!results_ || results_->file.last_step() == steps_) return;
  results_->file.write(snapshot());
  last_snapshot_time_ = time_;
}

template <int dim>
void Simulation<dim>::write_history() {
  require(motion_->begin(time_));
  if (last_row_step_ == steps_) return;
  last_row_step_ = steps_, last_row_time_ = time_;
  std::vector<double> mine, row;
  for (Followed &point : points_) {
    const int i = find(point);
    Vec<dim> x{}, v{};
    double displacement = 0, pressure = 0;
    PoreReport pores;
    if (i >= 0) {
      motion_->present(*bodies_[point.body], i, &x, &v);
      displacement = (map<dim>(x) - map<dim>(bodies_[point.body]->particles().reference[i])).norm();
      if (phases_.prescribed) pressure = motion_->pore_pressure(x);
      if (phases_.liquid) pores = motion_->pores(*bodies_[point.body], i), pressure = pores.liquid;
    }
    mine.insert(mine.end(), x.begin(), x.end());
    mine.push_back(displacement), mine.push_back(map<dim>(v).norm());
    if (phases_.pressure) mine.push_back(pressure);
    if (phases_.gas) mine.push_back(pores.gas);
    if (phases_.suction) mine.push_back(pores.suction), mine.push_back(pores.saturation);
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
  if (phases_.liquid) {
    FluidLedger fluids[2];
    require(motion_->fluid_ledger(fluids));
    if (first_ledger_.empty())
      for (int a = 0; a < phases_.fluids(); ++a)
        first_ledger_.push_back(fluids[a].stored + fluids[a].out - fluids[a].prescribed);
    for (int a = 0; a < phases_.fluids(); ++a) {
      const double error = fluids[a].stored + fluids[a].out - fluids[a].prescribed - first_ledger_[a];
      row.insert(row.end(), {fluids[a].stored, fluids[a].out, fluids[a].prescribed, error});
    }
  }
  if (flow_stages()) {
    const std::vector<double> inflow =
        flow_ && in_statics_ ? flow_->inflow() : std::vector<double>(conditions_.sources().size(), 0);
    for (size_t s = 0; s < inflow.size(); ++s)
      if (concerns_water(conditions_.sources()[s].kind)) row.push_back(inflow[s]);
  }
  std::vector<Vec<dim>> impulses, faces(conditions_.sources().size());
  require(conditions_.take_impulses(comm_, impulses));
  require(conditions_.surface_loads().mean_displacements(motion_->grid(), faces));
  if (in_statics_) require(statics_->boundary_forces(load_time_, impulses, faces));
  const double elapsed = in_statics_ ? 1 : time_ - impulse_time_;
  for (size_t s = 0; s < impulses.size(); ++s)
    for (int d = 0; d < dim; ++d)
      row.push_back(conditions_.loads(static_cast<int>(s)) ? faces[s][d] : elapsed > 0 ? impulses[s][d] / elapsed : 0);
  impulse_time_ = time_;
  std::vector<double> work = conditions_.work();
  const WorkDone &done = motion_->work();
  work.insert(work.end(), {done.gravity, done.imposed, done.damping});
  MPI_Allreduce(MPI_IN_PLACE, work.data(), static_cast<int>(work.size()), MPI_DOUBLE, MPI_SUM, comm_);
  const double held = sums.kinetic + sums.strain;
  if (time_ == 0) first_energy_ = held;
  row.insert(row.end(), work.begin(), work.end());
  row.push_back(first_energy_ + std::accumulate(work.begin(), work.end(), 0.) - held);
  row.insert(row.begin(), {time_, static_cast<double>(steps_)});
  history_.rows.push_back(row);
  if (results_)
    results_->history.row(time_, steps_, stage_name_.empty() ? "start" : stage_name_, {row.begin() + 2, row.end()});
}

template <int dim>
int Simulation<dim>::find(Followed &point) {
  const ParticleArrays<dim> &p = bodies_[point.body]->particles();
  if (point.index >= 0 && point.index < p.count && p.id[point.index] == point.id) return point.index;
  point.index = -1;
  for (int i = 0; i < p.count; ++i)
    if (p.id[i] == point.id) point.index = i;
  return point.index;
}

template <int dim>
void Simulation<dim>::note(const std::string &text) {
  events_.push_back({time_, load_time_, stage_name_, text});
  if (results_) results_->progress.note(text);
}

/// "(x, y) m" of the lowest rank that has a place to name, empty if none has. Collective.
template <int dim>
std::string Simulation<dim>::place_of(bool mine, const Vec<dim> &where) const {
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

template <int dim>
std::string Simulation<dim>::text_of(bool mine, std::string text) const {
  int rank, ranks, size = static_cast<int>(text.size());
  MPI_Comm_rank(comm_, &rank), MPI_Comm_size(comm_, &ranks);
  int first = mine ? rank : ranks;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm_);
  if (first == ranks) return "";
  MPI_Bcast(&size, 1, MPI_INT, first, comm_);
  text.resize(size);
  MPI_Bcast(text.data(), size, MPI_CHAR, first, comm_);
  return text;
}

template <int dim>
void Simulation<dim>::fail(const std::string &text) {
  std::ostringstream message;
  message.precision(8);
  message << text << " (t = " << time_ << " s, step " << steps_ << ", stage " << stage_name_ << ")";
  if (results_) message << "; snapshots up to step " << results_->file.last_step() << " are in " << options_.directory;
  if (checkpoint_time_ >= 0) message << ", and --resume goes on from t = " << checkpoint_time_ << " s";
  if (results_) {
    note_steps();
    results_->progress.failure(message.str());
  }
  throw RunError(message.str());
}

}  // namespace talus
