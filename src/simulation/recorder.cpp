#include "simulation/recorder.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numeric>

#include "base/version.h"
#include "output/csv.h"
#include "output/pictures.h"
#include "output/replace_file.h"
#include "output/together.h"
#include "scene/contact_source.h"
#include "scene/output_source.h"
#include "scene/reader.h"
#include "scene/rigid_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/water_source.h"
#include "scene/words.h"
#include "simulation/base_clearance.h"
#include "simulation/dynamics.h"
#include "simulation/model.h"
#include "simulation/output_fields.h"

namespace talus {

template <int dim>
Recorder<dim>::Recorder(const Sources<dim> &of, const RunOptions &options)
    : of_(of),
      scene_(of.world.scene),
      phases_(of.world.phases),
      options_(options),
      point_rows_(of.world, of.points),
      structures_(of.world.comm, of.world.structures.get()),
      ends_(of.world),
      ground_path_(of.world.shaking) {
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
                           Progress(of_.world.comm, options_.directory + "/run.log", longest_duration()),
                           EventFile(of_.world.comm, options_.directory, events_)});
  write_model(), write_columns();
  of_.lines.open(options_.directory);
  structures_.open(options_.directory);
  for (const std::string &sentence : of_.lines.left_out()) note(sentence);
  for (const std::string &sentence : of_.points.far_off()) warn(sentence);
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
  const BackgroundMesh<dim> &mesh = of_.world.mesh;
  const int nodes = mesh.nodes_in_sheet(), cells = mesh.cells_in_sheet();
  picture.position.reserve(static_cast<std::size_t>(nodes) * dim);
  picture.cell_node.reserve(static_cast<std::size_t>(cells) * (dim + 1));
  for (int i = 0; i < nodes; ++i)
    picture.position.insert(picture.position.end(), mesh.position[i].begin(), mesh.position[i].end());
  for (int c = 0; c < cells; ++c)
    picture.cell_node.insert(picture.cell_node.end(), mesh.cells[c].node.begin(), mesh.cells[c].node.end());
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
                           Progress(of_.world.comm, options_.directory + "/run.log", longest_duration(), true),
                           EventFile(of_.world.comm, options_.directory, events_)});
  write_model(), write_columns();
  of_.lines.append(options_.directory, last_row_time_);
  structures_.append(options_.directory, last_row_time_);
  results_->progress.resume(of_.clock.time, of_.clock.steps);
  note("resumed at t = " + rounded(of_.clock.time) + " s, step " + std::to_string(of_.clock.steps), event::resumed,
       {{"step", of_.clock.steps}});
  if (!passed_over_.empty()) warn(passed_over_ + "; the run goes on from the checkpoint before it");
  if (written_ranks_ > 0)
    note("before it ran on " + std::to_string(written_ranks_) + (written_ranks_ == 1 ? " rank" : " ranks") +
         ": the answer differs by round-off from that of a run on the same number");
  for (const std::string &key : changed_) note("since then the scene has another " + key);
  if (!has_table)
    warn("history.csv was missing; it begins here");
  else if (results_->history.has_gap())
    warn("history.csv was damaged; rows before this time are missing");
  for (const std::string &line : of_.lines.with_gaps())
    warn("line_" + line + ".csv was missing or damaged; rows before this time are missing");
  for (const std::string &one : damaged) warn(one);
  write_escaped();
  of_.statics.save_seeped_pressure(options_.directory);
}

template <int dim>
void Recorder<dim>::close(const std::string &last_words) {
  if (!results_) return;
  note_steps();
  note_sharing();
  if (!last_words.empty()) note(last_words, event::still_moving);
  record({event::end, "the run came to its end"});
  results_->events.complete(events_);
  results_->progress.finish();
  if (!options_.pictures) return;
  int rank, drawn = 1;
  MPI_Comm_rank(of_.world.comm, &rank);
  if (rank == 0) drawn = draw_pictures(options_.directory, {.fields = scene_.output->picture, .times = {}});
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
  if (scene_.output->picture.empty()) return;
  const auto fields = output_fields<ParticleState<dim>>(phases_, of_.world.bodies);
  std::vector<std::string> known;
  for (const auto &field : fields.list())
    if (field.name != "position") known.push_back(field.name);
  for (const std::string &field : scene_.output->picture) {
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
  if (scene_.water->drag == PoreDrag::at_start) return;  // its steps are as short as pores are tight
  double step = std::numeric_limits<double>::infinity();
  for (const BodyReport &body : of_.world.report()) step = std::min(step, body.critical_step);
  if (std::isinf(step)) return;  // all soil comes later
  if (const double fixed = step_rule(choose_integrator(scene_)).fixed; fixed > 0) step = std::min(step, fixed);
  const double least = step / 1000;
  const Output &output = *scene_.output;
  for (const auto &[key, interval] : {std::pair{"output.interval", output.interval},
                                      {"output.history_interval", output.history_interval},
                                      {"output.checkpoint_interval", output.checkpoint_interval}})
    if (interval > 0 && interval < least)
      scene_.complain(key, "must be 0, or " + rounded(least) + " s or more: the longest step is " + rounded(step) +
                               " s, and nothing new happens in a thousandth of it");
}

// ---- history ----

template <int dim>
void Recorder<dim>::name_columns() {
  history_.names = {history_column("time", "s"), "step"};
  columns_.clear();
  for (const auto &point : of_.points.all())
    for (const auto &[quantity, unit] : point_rows_.columns())
      columns_.push_back(column_of("point", point.name, quantity, unit));
  run_row().visit([&](const HistoryColumn &column, double) { columns_.push_back(column); });
  for (const HistoryColumn &one : columns_) history_.names.push_back(one.name);
}

/// history_columns.csv. Collective.
template <int dim>
void Recorder<dim>::write_columns() const {
  std::string table = "column,quantity,unit,of,which\n";
  for (const HistoryColumn &one : columns_)
    table += csv_field(one.name) + "," + one.quantity + "," + (one.unit == "-" ? "" : one.unit) + "," + one.of + "," +
             csv_field(one.which) + "\n";
  on_first_rank(of_.world.comm, [&] { replace_file(options_.directory + "/history_columns.csv", table); });
}

/// The ground stays where it is in stages that do not shake.
template <int dim>
GroundRow Recorder<dim>::ground_row() const {
  GroundRow row;
  const Loading<dim> &loading = of_.world.motion->loading;
  if (loading.shaking) {
    const double since = of_.clock.time - loading.shaken_since;
    row = {loading.shaking->acceleration(since), loading.shaking->velocity(since), ground_path_.displacement(since)};
  }
  const std::array<double, 3> left = ground_path_.displacement(of_.world.shaking.duration());
  for (int d = 0; d < 3; ++d) row.displacement[d] += static_cast<double>(shaken_before_) * left[d];
  return row;
}

/// A row of the history with what needs no sum over ranks.
template <int dim>
RunRow<dim> Recorder<dim>::run_row() const {
  const World<dim> &world = of_.world;
  RunRow<dim> row;
  row.mass = world.total_mass, row.particles = static_cast<double>(world.particle_count);
  row.load_time = of_.clock.load_time;
  row.escaped = world.escaped.sums();
  if (std::ranges::any_of(scene_.stage, [](const Stage &stage) { return stage.shakes(); })) row.ground = ground_row();
  row.fluids.resize(phases_.fluids());
  if (std::ranges::any_of(scene_.stage, [](const Stage &stage) { return stage.is_static(); }))
    row.handed.resize(row.fluids.size());
  for (size_t s = 0; s < world.conditions.sources().size(); ++s) {
    const auto &source = world.conditions.sources()[s];
    row.boundaries.push_back({source.name,
                              world.conditions.loads(static_cast<int>(s)),
                              source.kind.fluids_only(),
                              has_flow_stages(scene_) && source.kind.has_inflow(),
                              source.kind.in_motion == OnSoil::contact,
                              source.kind.remembers,
                              source.kind.shear_zone.has_value(),
                              {},
                              0,
                              0,
                              {}});
  }
  for (const RigidSource &source : scene_.rigid) row.rigid.push_back({source.name});
  if (world.conditions.soil_contact())
    for (const ContactSource &source : scene_.contact) row.contacts.push_back({source.name});
  if (world.structures)
    for (const Bar<dim> &bar : world.structures->bars()) row.structures.push_back({bar.name, bar.report()});
  return row;
}

template <int dim>
void Recorder<dim>::write_history() {
  require(of_.world.motion->begin_results(of_.clock.time));
  if (last_row_step_ == of_.clock.steps) return;
  of_.world.count_cells();
  std::vector<double> row = point_rows_.at(of_.clock.time, of_.statics);
  of_.lines.write(of_.clock, of_.statics);
  structures_.write(of_.clock);
  last_row_step_ = of_.clock.steps, last_row_time_ = of_.clock.time;
  note_imbalance();
  RunRow<dim> run = run_row();
  run.energy = of_.energies.sums(), run.balanced = of_.clock.stage != strength_reduction;
  for (int d = 0; d < dim; ++d) run.potential -= scene_.gravity[d] * run.energy.balance.moment[d];
  if (phases_.liquid) {
    require(of_.world.motion->fluid_ledger(run.fluids.data()));
    fluids_.show(of_.clock.time, run);
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
  if (RigidBodies<dim> *bodies = of_.world.conditions.rigid_bodies()) {
    std::vector<typename RigidBodies<dim>::Report> reports;
    require(bodies->take_reports(reports));
    for (size_t b = 0; b < reports.size(); ++b)
      run.rigid[b].report = reports[b], run.rigid[b].elapsed = of_.clock.time - impulse_time_;
  }
  if (SoilContact<dim> *contact = of_.world.conditions.soil_contact()) {
    std::vector<typename SoilContact<dim>::Report> reports;
    require(contact->take_reports(reports));
    for (size_t k = 0; k < reports.size(); ++k)
      run.contacts[k].report = reports[k], run.contacts[k].elapsed = of_.clock.time - impulse_time_;
  }
  impulse_time_ = of_.clock.time;
  run.visit([&](const HistoryColumn &, double value) { row.push_back(value); });
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
  require(of_.world.motion->begin_results(of_.clock.time));
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
  std::size_t count = 0;
  for (const auto &body : bodies) count += body->particles().count;
  s.columns = fields.columns(count);
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
  for (const std::string &sentence : ends_.newly_reached(of_.clock.stage)) warn(sentence);
  if (!results_) return;
  write_escaped();
  if (results_->file.last_step() == of_.clock.steps) return;
  results_->file.write(snapshot());
  snapshots_ = results_->file.count();
}

template class Recorder<2>;
template class Recorder<3>;

}  // namespace talus
