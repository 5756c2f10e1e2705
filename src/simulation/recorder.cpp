#include "simulation/recorder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>

#include "base/version.h"
#include "output/escaped_table.h"
#include "output/pictures.h"
#include "output/replace_file.h"
#include "output/together.h"
#include "scene/changes.h"
#include "scene/reader.h"
#include "scene/words.h"
#include "simulation/base_clearance.h"
#include "simulation/model.h"
#include "simulation/output_fields.h"
#include "simulation/ways_out.h"

namespace talus {

template <int dim>
Recorder<dim>::Recorder(const Sources<dim> &of, const RunOptions &options)
    : of_(of),
      scene_(of.world.scene),
      phases_(of.world.phases),
      options_(options),
      point_rows_(of.world, of.points),
      ends_(of.world) {
  check_pictures();
  check_intervals();
}

// ---- files ----

template <int dim>
void Recorder<dim>::open() {
  name_columns();
  if (options_.directory.empty()) return;
  auto folder = std::make_unique<ResultsFolder>(of_.world.comm, options_.directory,
                                                options_.replace ? FolderUse::replace : FolderUse::start);
  of_.statics.save_seeped_pressure(options_.directory);  // in place of that of a run that was here before
  RunFile file(of_.world.comm, options_.directory, header(), mesh_picture());
  History rows(of_.world.comm, options_.directory + "/history.csv", {history_.names.begin() + 2, history_.names.end()});
  results_.reset(new Files{std::move(folder), std::move(file), std::move(rows),
                           Progress(of_.world.comm, options_.directory + "/run.log", longest_duration())});
  write_model();
  of_.lines.open(options_.directory);
  for (const std::string &sentence : of_.lines.left_out()) results_->progress.note(sentence);
  for (const std::string &sentence : of_.points.far_off()) results_->progress.note("warning: " + sentence);
  write_escaped();  // in place of that of a run that was here before
}

template <int dim>
RunHeader Recorder<dim>::header() const {
  RunHeader header{scene_.title, program, scene_.source, scene_.root ? scene_.root->values() : scene_.source, {}};
  for (const auto &body : of_.world.bodies) header.bodies.push_back(body->name());
  return header;
}

template <int dim>
MeshPicture Recorder<dim>::mesh_picture() const {
  MeshPicture picture;
  picture.dimension = dim;
  picture.position.reserve(of_.world.mesh.position.size() * dim);
  picture.cell_node.reserve(of_.world.mesh.cells.size() * (dim + 1));
  for (const Vec<dim> &x : of_.world.mesh.position) picture.position.insert(picture.position.end(), x.begin(), x.end());
  for (const Cell<dim> &cell : of_.world.mesh.cells)
    picture.cell_node.insert(picture.cell_node.end(), cell.node.begin(), cell.node.end());
  return picture;
}

/// What the first picture of the report shows. Collective.
template <int dim>
void Recorder<dim>::write_model() const {
  const std::string model = model_of(of_.world);
  on_first_rank(of_.world.comm, [&] { replace_file(options_.directory + "/run/model.json", model); });
  on_first_rank(of_.world.comm, [&] {  // of terrain, also of a mesh file that was made of it
    if (!options_.mesh.origin.empty()) replace_file(options_.directory + "/origin.json", options_.mesh.origin);
  });
}

template <int dim>
void Recorder<dim>::append(std::unique_ptr<ResultsFolder> folder) {
  name_columns();
  const std::string table = options_.directory + "/history.csv";
  const bool has_table = std::filesystem::exists(table);
  RunFile file = RunFile::append(of_.world.comm, options_.directory, header(), mesh_picture(), snapshots_);
  const std::vector<std::string> damaged = file.damaged();
  History rows =
      History::append(of_.world.comm, table, {history_.names.begin() + 2, history_.names.end()}, last_row_time_);
  results_.reset(new Files{std::move(folder), std::move(file), std::move(rows),
                           Progress(of_.world.comm, options_.directory + "/run.log", longest_duration(), true)});
  write_model();
  of_.lines.append(options_.directory, last_row_time_);
  results_->progress.resume(of_.clock.time, of_.clock.steps);
  results_->progress.note("resumed at t = " + rounded(of_.clock.time) + " s, step " + std::to_string(of_.clock.steps));
  if (!passed_over_.empty())
    results_->progress.note("warning: " + passed_over_ + "; the run goes on from the checkpoint before it");
  if (written_ranks_ > 0)
    results_->progress.note("before it ran on " + std::to_string(written_ranks_) +
                            (written_ranks_ == 1 ? " rank" : " ranks") +
                            ": the answer differs by round-off from that of a run on the same number");
  for (const std::string &key : changed_) results_->progress.note("since then the scene has another " + key);
  if (!has_table)
    results_->progress.note("warning: history.csv was missing; it begins here");
  else if (results_->history.has_gap())
    results_->progress.note("warning: history.csv was damaged; rows before this time are missing");
  for (const std::string &line : of_.lines.with_gaps())
    results_->progress.note("warning: line_" + line + ".csv was missing or damaged; rows before this time are missing");
  for (const std::string &one : damaged) results_->progress.note("warning: " + one);
  write_escaped();
  of_.statics.save_seeped_pressure(options_.directory);
}

template <int dim>
void Recorder<dim>::close(const std::string &last_words) {
  if (!results_) return;
  note_steps();
  note_sharing();
  if (!last_words.empty()) note(last_words);
  results_->progress.finish();
  if (!options_.pictures) return;
  int rank, drawn = 1;
  MPI_Comm_rank(of_.world.comm, &rank);
  if (rank == 0) drawn = draw_pictures(options_.directory, {.fields = scene_.output.picture, .times = {}});
  MPI_Bcast(&drawn, 1, MPI_INT, 0, of_.world.comm);
  if (!drawn) throw RunError(without_pictures(options_.directory));
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
  const auto fields = output_fields<ParticleState<dim>>(phases_, of_.world.bodies);
  std::vector<std::string> known;
  for (const auto &field : fields.list())
    if (field.name != "position") known.push_back(field.name);
  for (const std::string &field : scene_.output.picture) {
    const bool drawn = std::ranges::any_of(fields.list(), [&](const auto &one) {
      return field == one.name || (one.components > 1 && field.rfind(one.name + "_", 0) == 0);
    });
    if (!drawn && dim == 3 && field == "thickness")
      continue;  // not in the file: the pictures take it from displacement
    if (!drawn)
      scene_.complain("output.picture",
                      "names \"" + field + "\", which this run does not have; " + suggestion(field, known));
  }
}

/// Results closer than a thousandth of a step are no results, and steps that reached each of them would go on for ever.
template <int dim>
void Recorder<dim>::check_intervals() {
  double step = std::numeric_limits<double>::infinity();
  for (const BodyReport &body : of_.world.report()) step = std::min(step, body.critical_step);
  if (std::isinf(step)) return;  // all soil comes later
  const double least = step / 1000;
  const Output &output = scene_.output;
  for (const auto &[key, interval] : {std::pair{"output.interval", output.interval},
                                      {"output.history_interval", output.history_interval},
                                      {"output.checkpoint_interval", output.checkpoint_interval}})
    if (interval > 0 && interval < least)
      scene_.complain(key, "must be 0, or " + rounded(least) + " s or more: the critical step is " + rounded(step) +
                               " s, and nothing new happens in a thousandth of it");
}

// ---- what happens ----

template <int dim>
void Recorder<dim>::begin_stage(const Stage &stage) {
  if (!results_) return;
  const auto here = scene_.stage.begin() + (&stage - scene_.stage.data());
  results_->progress.stage(stage.name,
                           std::none_of(here, scene_.stage.end(), [](const Stage &s) { return is_static(s.kind); }));
}

template <int dim>
void Recorder<dim>::progress() {
  if (results_) results_->progress.step(of_.clock.time, of_.clock.steps, of_.world.particle_count);
  if (told_escaped_ == 0) note_escaped();
}

template <int dim>
void Recorder<dim>::seeking(int iteration, double out_of_balance) {
  if (!results_) return;
  std::ostringstream text;
  text << of_.clock.stage << "  t = " << of_.clock.time << " s  iteration " << iteration << ": ";
  text.precision(1);
  text << std::scientific << out_of_balance << " of the forces out of balance";
  results_->progress.seeking(text.str());
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

template <int dim>
const std::vector<int> &Recorder<dim>::ways_out() {
  if (known_ways_ != of_.world.escaped.sums().particles)
    ways_out_ = talus::ways_out(of_.world), known_ways_ = of_.world.escaped.sums().particles;
  return ways_out_;
}

/// The groups by which particles left the mesh, with their shares of the mass. Collective.
template <int dim>
std::string Recorder<dim>::ways_in_words() {
  const std::vector<std::string> &names = of_.world.mesh.group_names();
  std::vector<double> mass(names.size() + 1);  // the last: faces without a name
  const auto &mine = of_.world.escaped.of_this_rank();
  const std::vector<int> &groups = ways_out();
  for (std::size_t i = 0; i < mine.size(); ++i) mass[groups[i] < 0 ? names.size() : groups[i]] += mine[i].mass;
  MPI_Allreduce(MPI_IN_PLACE, mass.data(), static_cast<int>(mass.size()), MPI_DOUBLE, MPI_SUM, of_.world.comm);
  std::vector<std::size_t> order(mass.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t g) { return mass[g]; });
  const double all = std::accumulate(mass.begin(), mass.end(), 0.);
  std::ostringstream text;
  text.precision(3);
  for (const std::size_t g : order) {
    if (mass[g] == 0) continue;
    text << (g == order[0] ? "by " : ", ") << (g < names.size() ? names[g] : "faces without a name");
    if (mass[g] < all) text << " " << 100 * mass[g] / all << " %";
  }
  return text.str();
}

/// Says what has left the mesh so far, if more has left than was told. Collective.
template <int dim>
void Recorder<dim>::note_escaped() {
  const EscapedSums &sums = of_.world.escaped.sums();
  if (sums.particles == told_escaped_) return;
  std::ostringstream text;
  text.precision(6);
  if (told_escaped_ == 0) {
    const auto &mine = of_.world.escaped.of_this_rank();
    const bool any = !mine.empty();
    text << "particles leave the mesh, the first near "
         << place_of_first<dim>(of_.world.comm, any, any ? mine.front().position : Vec<dim>{})
         << ", and are taken out; ";
  }
  text << "so far " << sums.particles << (sums.particles == 1 ? " has" : " have") << " left " << ways_in_words()
       << ": mass " << sums.mass << " kg";
  for (int a = 0; a < phases_.fluids(); ++a) text << (a ? ", gas " : ", water ") << sums.fluid_mass[a] << " kg";
  text << ", momentum (";
  for (int d = 0; d < dim; ++d) text << (d ? ", " : "") << sums.momentum[d];
  text << ") kg m/s";
  if (of_.world.particle_count == 0) text << "; no soil is left";
  told_escaped_ = sums.particles;
  note(text.str());
}

/// escaped.csv, whenever it does not hold all particles that have left. Collective.
template <int dim>
void Recorder<dim>::write_escaped() {
  const EscapedParticles<dim> &escaped = of_.world.escaped;
  if (written_escaped_ == escaped.sums().particles) return;
  EscapedTable table;
  table.names = {history_column("time", "s"), "id", "body", history_column("mass", "kg")};
  for (int a = 0; a < phases_.fluids(); ++a) table.names.push_back(history_column(a ? "gas" : "water", "kg"));
  for (const auto &[name, unit] : {std::pair{"", "m"}, {"velocity_", "m/s"}, {"momentum_", "kg m/s"}})
    for (int d = 0; d < dim; ++d) table.names.push_back(history_column(std::string(name) + "xyz"[d], unit));
  table.names.push_back("group"), table.groups = of_.world.mesh.group_names();
  auto way = ways_out().begin();
  for (const EscapedParticle<dim> &one : escaped.of_this_rank()) {
    table.values.insert(table.values.end(),
                        {one.time, static_cast<double>(one.id), static_cast<double>(one.body), one.mass});
    table.values.insert(table.values.end(), one.fluid_mass, one.fluid_mass + phases_.fluids());
    for (const Vec<dim> *x : {&one.position, &one.velocity, &one.momentum})
      table.values.insert(table.values.end(), x->begin(), x->end());
    table.values.push_back(*way++);
  }
  write_escaped_table(of_.world.comm, options_.directory + "/escaped.csv", header().bodies, table);
  written_escaped_ = escaped.sums().particles;
}

/// Work of the rank that has most, over the mean of all ranks: says it when the run starts or is resumed. Collective.
template <int dim>
void Recorder<dim>::note_imbalance() {
  int ranks;
  MPI_Comm_size(of_.world.comm, &ranks);
  if (ranks == 1 || imbalance_at_start_ > 0 || of_.world.particle_count == 0) return;
  double work[2] = {of_.world.work_of_rank(), of_.world.work_of_rank()};
  MPI_Allreduce(MPI_IN_PLACE, &work[0], 1, MPI_DOUBLE, MPI_MAX, of_.world.comm);
  MPI_Allreduce(MPI_IN_PLACE, &work[1], 1, MPI_DOUBLE, MPI_SUM, of_.world.comm);
  imbalance_at_start_ = work[0] * ranks / work[1];
  std::string text = "particles are shared among " + std::to_string(ranks) + " ranks with imbalance " +
                     rounded(imbalance_at_start_) + " (work of the rank that has most, over the mean)";
  if (of_.world.mesh.heaviest_patch() > 0.05)
    text += "; patches of cells stay whole, and the heaviest is " + rounded(of_.world.mesh.heaviest_patch()) +
            " of the mean: a finer mesh or fewer ranks would be better balanced";
  if (results_) results_->progress.note(text);
}

template <int dim>
void Recorder<dim>::note_balancing(double expected) {
  const Balancing &balancing = of_.dynamics.balancing();
  constexpr long long told = 20;  // at which the log stops to tell each of them
  if (!results_ || balancing.count() > told) return;
  std::ostringstream text;
  text.precision(3);
  text << "the mesh was divided among the ranks in another way: imbalance " << balancing.imbalance() << " before, "
       << expected << " now";
  if (balancing.count() == told) text << "; further times are not told";
  results_->progress.note(text.str());
}

/// How the work was shared among the ranks, for the log.
template <int dim>
void Recorder<dim>::note_sharing() {
  const Balancing &balancing = of_.dynamics.balancing();
  if (imbalance_at_start_ == 0) return;
  std::ostringstream text;
  text.precision(3);
  text << "imbalance of ranks: " << imbalance_at_start_ << " at the start, "
       << std::max(imbalance_at_start_, balancing.highest()) << " at most";
  if (balancing.count() > 0) {
    text << "; the mesh was divided in another way " << balancing.count()
         << (balancing.count() == 1 ? " time" : " times") << ", in " << balancing.seconds() << " s";
    if (balancing.saved() > 0)
      text << ", which saved about " << 100 * balancing.saved() / (1 + balancing.saved())
           << " % of the time of steps (by their work, had the imbalance lasted)";
  }
  results_->progress.note(text.str());
}

/// What the integrator did, for the log.
template <int dim>
void Recorder<dim>::note_steps() {
  const StepStatistics &s = of_.dynamics.statistics();
  if (s.steps == 0) return;  // nothing but equilibria
  std::ostringstream text;
  text.precision(3);
  text << s.steps << " steps from " << s.shortest << " to " << s.longest << " s, " << s.evaluations
       << " evaluations of the forces, " << s.rejections << " attempts rejected";
  if (s.rejections > 0) text << " by the error test";
  if (s.inversions > 0) text << ", " << s.inversions << " because a cell turned inside out";
  note(text.str());
  note("steps bounded by the error: " + std::to_string(s.by_error) + ", stability: " + std::to_string(s.by_stability) +
       ", outputs: " + std::to_string(s.by_schedule));
  note(of_.dynamics.step_bound().sentence());
}

template <int dim>
void Recorder<dim>::fail(const std::string &cause) {
  std::ostringstream message;
  message.precision(12);  // the time as history.csv has it
  message << cause << " (t = " << of_.clock.time << " s, step " << of_.clock.steps << ", stage " << of_.clock.stage
          << ")";
  if (results_) message << "; snapshots up to step " << results_->file.last_step() << " are in " << options_.directory;
  if (checkpoint_time_ >= 0) message << ", and --resume goes on from t = " << checkpoint_time_ << " s";
  if (results_) {
    note_steps();
    results_->progress.failure(message.str());
    if (options_.pictures && !interrupted && results_->file.last_step() >= 0)
      throw BrokenOff(message.str() + "; report.html there shows how far it came", options_.directory,
                      scene_.output.picture);
  }
  throw RunError(message.str());
}

// ---- history ----

template <int dim>
void Recorder<dim>::name_columns() {
  history_.names = {history_column("time", "s"), "step"};
  for (const auto &point : of_.points.all())
    for (const std::string &name : point_rows_.names(point.name + "_")) history_.names.push_back(name);
  run_row().visit([&](const std::string &quantity, const char *unit, double) {
    history_.names.push_back(history_column(quantity, unit));
  });
}

/// A row of the history with what needs no sum over ranks.
template <int dim>
RunRow<dim> Recorder<dim>::run_row() const {
  const World<dim> &world = of_.world;
  RunRow<dim> row;
  row.mass = world.total_mass, row.particles = static_cast<double>(world.particle_count);
  row.load_time = of_.clock.load_time;
  row.escaped = world.escaped.sums();
  row.fluids.resize(phases_.fluids());
  for (size_t s = 0; s < world.conditions.sources().size(); ++s) {
    const auto &source = world.conditions.sources()[s];
    row.boundaries.push_back({source.name,
                              world.conditions.loads(static_cast<int>(s)),
                              has_flow_stages(scene_) && source.kind.has_inflow(),
                              source.kind.in_motion == OnSoil::contact,
                              source.kind.remembers,
                              source.kind.shear_zone.has_value(),
                              {},
                              0,
                              0,
                              0,
                              {}});
  }
  return row;
}

template <int dim>
void Recorder<dim>::write_history() {
  require(of_.world.motion->begin(of_.clock.time));
  if (last_row_step_ == of_.clock.steps) return;
  std::vector<double> row = point_rows_.at(of_.clock.time, of_.statics);
  of_.lines.write(of_.clock, of_.statics);
  last_row_step_ = of_.clock.steps, last_row_time_ = of_.clock.time;
  note_imbalance();
  RunRow<dim> run = run_row();
  require(of_.world.motion->balance(of_.clock.time, &run.balance));
  for (int d = 0; d < dim; ++d) run.potential -= scene_.gravity[d] * run.balance.moment[d];
  if (of_.statics.current()) run.balance.strain = of_.statics.strain_energy();
  if (phases_.liquid) {
    require(of_.world.motion->fluid_ledger(run.fluids.data()));
    if (of_.clock.time == 0) fluids_before_ = run.fluids;
    fluids_before_.resize(run.fluids.size());
    for (std::size_t a = 0; a < run.fluids.size(); ++a)
      run.fluids[a].out -= fluids_before_[a].out, run.fluids[a].prescribed -= fluids_before_[a].prescribed;
    if (first_ledger_.empty())
      for (std::size_t a = 0; a < run.fluids.size(); ++a) first_ledger_.push_back(run.owned(a));
    run.first_fluid = first_ledger_;
  }
  if (has_flow_stages(scene_)) {
    const std::vector<double> inflow = of_.statics.inflow();
    for (size_t s = 0; s < inflow.size(); ++s) run.boundaries[s].water = inflow[s];
  }
  std::vector<Vec<dim>> impulses, faces(run.boundaries.size());
  require(of_.world.conditions.take_impulses(of_.world.comm, impulses));
  std::vector<typename RigidBases<dim>::Report> bases;
  require(of_.world.conditions.bases().take_reports(of_.world.comm, bases));
  const std::vector<double> clearances = base_clearances(of_.world);
  for (size_t s = 0; s < bases.size(); ++s)
    run.boundaries[s].base = bases[s], run.boundaries[s].clearance = clearances[s];
  require(of_.world.conditions.surface_loads().mean_displacements(of_.world.motion->grid(), faces));
  if (of_.statics.current()) require(of_.statics.problem().boundary_forces(of_.clock.load_time, impulses, faces));
  const double elapsed = of_.statics.current() ? 1 : of_.clock.time - impulse_time_;
  for (size_t s = 0; s < impulses.size(); ++s)
    for (int d = 0; d < dim; ++d)
      run.boundaries[s].value[d] = run.boundaries[s].loads ? faces[s][d] : elapsed > 0 ? impulses[s][d] / elapsed : 0;
  impulse_time_ = of_.clock.time;
  std::vector<double> work = of_.world.conditions.work();
  const WorkDone &done = of_.world.motion->work();
  work.insert(work.end(), {done.gravity, done.imposed, done.damping});
  MPI_Allreduce(MPI_IN_PLACE, work.data(), static_cast<int>(work.size()), MPI_DOUBLE, MPI_SUM, of_.world.comm);
  const PathWork by_statics = of_.statics.work();
  for (std::size_t s = 0; s < by_statics.of_boundary.size(); ++s) work[s] += by_statics.of_boundary[s];
  work.end()[-3] += by_statics.gravity, work.end()[-2] += of_.statics.imposed_work();
  if (of_.clock.time == 0) work_before_ = work;
  work_before_.resize(work.size());
  for (std::size_t k = 0; k < work.size(); ++k) work[k] -= work_before_[k];
  for (size_t s = 0; s < run.boundaries.size(); ++s) run.boundaries[s].work = work[s];
  run.work = {work.end()[-3], work.end()[-2], work.end()[-1]};
  if (of_.clock.time == 0) first_energy_ = run.balance.kinetic + run.balance.strain;
  run.first_energy = first_energy_, run.balanced = of_.clock.stage != strength_reduction;
  run.visit([&](const std::string &, const char *, double value) { row.push_back(value); });
  // not in finite elements, and not with fluids, whose energy the ledger does not contain
  const bool watched = run.balanced && !of_.statics.current() && !fluids_move(scene_.phases);
  const std::string created = energy_.look(watched ? of_.clock.stage : "", run.dissipated(), run.turnover());
  row.insert(row.begin(), {of_.clock.time, static_cast<double>(of_.clock.steps)});
  history_.rows.push_back(row);
  if (results_)
    results_->history.row(of_.clock.time, of_.clock.steps, of_.clock.stage.empty() ? "start" : of_.clock.stage,
                          {row.begin() + 2, row.end()});
  if (!created.empty()) note("warning: " + created);
  if (energy_.beyond_all()) throw RunFailure(energy_.verdict());
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
  const auto &bodies = of_.world.bodies;
  const auto fields = output_fields<ParticleState<dim>>(phases_, bodies);
  s.columns = fields.columns();
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    const ParticleArrays<dim> &p = bodies[b]->particles();
    for (int i = 0; i < p.count; ++i) {
      s.id.push_back(p.id[i]), s.body.push_back(b);
      fields.append(ParticleState<dim>(phases_, *of_.world.motion, *bodies[b], b, i), s.columns);
    }
  }
  return s;
}

template <int dim>
void Recorder<dim>::write_snapshot() {
  note_escaped();
  for (const std::string &sentence : ends_.newly_reached(of_.clock.stage)) note("warning: " + sentence);
  if (!results_) return;
  write_escaped();
  if (results_->file.last_step() == of_.clock.steps) return;
  results_->file.write(snapshot());
  snapshots_ = results_->file.count();
}

// ---- checkpoints ----

template <int dim>
CheckpointHeader Recorder<dim>::checkpoint_header(int stage) const {
  CheckpointHeader header;
  header.program = program, header.scene = scene_.root ? scene_.root->values() : "", header.stage = stage;
  header.time = of_.clock.time, header.step = of_.clock.steps, header.number = checkpoints_ + 1;
  MPI_Comm_size(of_.world.comm, &header.ranks);
  const BackgroundMesh<dim> &mesh = of_.world.mesh;
  header.mesh = mesh.fingerprint();
  header.partition.resize(header.ranks);
  const unsigned long long mine = mesh.partition_fingerprint();
  MPI_Allgather(&mine, 1, MPI_UNSIGNED_LONG_LONG, header.partition.data(), 1, MPI_UNSIGNED_LONG_LONG, of_.world.comm);
  for (const Cut &cut : mesh.cuts())
    header.cuts.insert(header.cuts.end(), {cut.place, static_cast<double>(cut.axis), static_cast<double>(cut.patch)});
  return header;
}

template <int dim>
void Recorder<dim>::write_checkpoint(int stage, const Archive &state) {
  talus::write_checkpoint(of_.world.comm, options_.directory, checkpoint_header(stage), state);
  ++checkpoints_, checkpoint_time_ = of_.clock.time;
}

/// Why a key of the scene must be what it was: what the saved state has from it.
std::string tie_of(const std::string &table) {
  if (table == "mesh") return "particles, stresses and contacts in the checkpoint belong to the cells of the mesh";
  if (table == "grids") return "functions of place take their values from it";
  if (table == "boundary") return "the checkpoint holds reactions, contacts and work of the boundaries as they were";
  return "the saved state has come about with it";
}

/// Only what the saved state does not depend on may differ: results, what becomes of particles that leave the mesh (up
/// to the checkpoint either none has left, or they have been taken out), the search for factors of safety, and how long
/// stages last that have not ended.
template <int dim>
Checkpoint Recorder<dim>::find_checkpoint() {
  const std::string refusal = "the run in " + options_.directory + " cannot be resumed: ";
  Checkpoint checkpoint;
  const CheckpointHeader &found = checkpoint.header, mine = checkpoint_header(-1);
  try {
    checkpoint = read_checkpoint(of_.world.comm, options_.directory);
  } catch (const std::invalid_argument &error) {
    throw SceneError(refusal + error.what() + "; run the scene without --resume" +
                     (std::filesystem::exists(options_.directory + "/history.csv")
                          ? ", with --force to replace what is there"
                          : ""));
  }
  if (found.program != mine.program)
    throw SceneError(refusal + "it is one of " + found.program + ", this is " + mine.program);
  changed_ = changed_keys(found.scene, mine.scene);
  for (const std::string &path : changed_) {
    const std::vector<std::string> words = split(path);
    const bool listed = words.size() > 1 && words[0] == "stage";
    const int stage = listed ? std::stoi(words[1]) : 0;
    const bool result = words[0] == "title" || words[0] == "factor_of_safety" || path == "mesh.leaving_particles" ||
                        path == "mesh.balance_ranks" ||
                        (words[0] == "output" && words.size() > 1 && words[1] != "point");
    const bool to_come =
        listed &&
        (stage > found.stage || (stage == found.stage && (words.back() == "duration" || words.back() == "rest_speed")));
    if (!result && !to_come)
      scene_.complain(path, "is not what it was when the run in " + options_.directory + " began, and " +
                                tie_of(words[0]) +
                                "; with --resume only title, [output] without its points, [factor_of_safety], "
                                "mesh.leaving_particles, mesh.balance_ranks, duration and rest_speed of the present "
                                "stage and the stages after it "
                                "may change (repeat the --set of that run)");
  }
  if (found.ranks != mine.ranks) written_ranks_ = found.ranks;
  return checkpoint;
}

template <int dim>
void Recorder<dim>::take_checkpoint(const Checkpoint &found) {
  checkpoints_ = found.last_number, checkpoint_time_ = found.header.time, passed_over_ = found.passed_over;
}

template <int dim>
void Recorder<dim>::serialize(Archive &archive) {
  archive.serialize("results", last_row_step_, last_row_time_, snapshots_, impulse_time_, first_ledger_, first_energy_,
                    work_before_, fluids_before_, told_escaped_);
  energy_.serialize(archive);
  point_rows_.serialize(archive);
  ends_.serialize(archive);
  of_.lines.serialize(archive);
}

template class Recorder<2>;
template class Recorder<3>;

}  // namespace talus
