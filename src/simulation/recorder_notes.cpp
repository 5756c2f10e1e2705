// What the recorder says while a run goes on: on the terminal, in its log and in its list of events.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "output/escaped_table.h"
#include "scene/output_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation/recorder.h"

namespace talus {

template <int dim>
void Recorder<dim>::begin_stage(const Stage &stage) {
  const auto here = scene_.stage.begin() + (&stage - scene_.stage.data());
  shaken_before_ = std::count_if(scene_.stage.begin(), here, [](const Stage &before) { return before.shakes(); });
  if (!results_) return;
  results_->progress.stage(stage.name,
                           std::none_of(here, scene_.stage.end(), [](const Stage &s) { return s.is_static(); }));
}

template <int dim>
void Recorder<dim>::progress() {
  if (results_)
    results_->progress.step(of_.clock.time, of_.clock.steps, of_.world.particle_count, of_.world.cell_count);
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
void Recorder<dim>::record(Event event) {
  if (std::isnan(event.time)) event.time = of_.clock.time, event.load_time = of_.clock.load_time;
  event.stage = of_.clock.stage;
  if (results_) results_->events.add(event);
  events_.push_back(std::move(event));
}

template <int dim>
void Recorder<dim>::tell(const Event &event) {
  record(event);
  if (results_) results_->progress.note(std::string(event.warning ? "warning: " : "") + event.text);
}

template <int dim>
bool Recorder<dim>::happened(const char *kind, double since) const {
  return std::ranges::any_of(events_, [&](const Event &one) { return one.kind == kind && one.time >= since; });
}

/// The groups by which particles left the mesh, with their shares of the mass. Collective.
template <int dim>
std::string Recorder<dim>::ways_in_words() {
  const std::vector<std::string> &names = of_.world.mesh.group_names();
  std::vector<double> mass(names.size() + 1);  // the last: faces without a name
  for (const EscapedParticle<dim> &one : of_.world.escaped.of_this_rank())
    mass[one.group < 0 ? names.size() : one.group] += one.mass;
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
  note(text.str(), event::escaped, {{"particles", sums.particles}, {"mass_kg", sums.mass}});
}

template <int dim>
void Recorder<dim>::note_lost_soil() {
  const EscapedSums &sums = of_.world.escaped.sums();
  if (sums.particles == 0) return;
  const std::string ways = ways_in_words();
  const double share = sums.mass / (sums.mass + of_.world.total_mass);
  warn(rounded(100 * share) + " % of the soil, " + rounded(sums.mass) + " kg, has left the mesh " + ways +
           ": displacements and volumes are those of the rest",
       event::lost_soil, {{"share", share}, {"mass_kg", sums.mass}});
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
  for (const EscapedParticle<dim> &one : escaped.of_this_rank()) {
    table.values.insert(table.values.end(),
                        {one.time, static_cast<double>(one.id), static_cast<double>(one.body), one.mass});
    table.values.insert(table.values.end(), one.fluid_mass, one.fluid_mass + phases_.fluids());
    for (const Vec<dim> *x : {&one.position, &one.velocity, &one.momentum})
      table.values.insert(table.values.end(), x->begin(), x->end());
    table.values.push_back(static_cast<double>(one.group));
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
  double work[2] = {of_.world.work_of_rank(0), of_.world.work_of_rank(0)};
  MPI_Allreduce(MPI_IN_PLACE, &work[0], 1, MPI_DOUBLE, MPI_MAX, of_.world.comm);
  MPI_Allreduce(MPI_IN_PLACE, &work[1], 1, MPI_DOUBLE, MPI_SUM, of_.world.comm);
  imbalance_at_start_ = work[0] * ranks / work[1];
  std::string text = "particles are shared among " + std::to_string(ranks) + " ranks with imbalance " +
                     rounded(imbalance_at_start_) + " (work of the rank that has most, over the mean)";
  if (of_.world.mesh.heaviest_patch() > 0.05)
    text += "; patches of cells stay whole, and the heaviest is " + rounded(of_.world.mesh.heaviest_patch()) +
            " of the mean: a finer mesh or fewer ranks would be better balanced";
  if (results_) note(text, event::ranks);
}

template <int dim>
void Recorder<dim>::note_balancing(double before, double expected) {
  const Balancing &balancing = of_.dynamics.balancing();
  constexpr long long told = 20;  // at which the log stops to tell each of them
  if (!results_ || balancing.count() > told) return;
  std::ostringstream text;
  text.precision(3);
  text << "the mesh was divided among the ranks in another way: imbalance " << before << " before, " << expected
       << " now";
  if (balancing.count() == told) text << "; further times are not told";
  note(text.str(), event::ranks);
}

/// How the work was shared among the ranks, for the log.
template <int dim>
void Recorder<dim>::note_sharing() {
  const Balancing &balancing = of_.dynamics.balancing();
  if (imbalance_at_start_ == 0) return;
  std::ostringstream text;
  text.precision(3);
  const double most = std::max(imbalance_at_start_, balancing.highest());
  text << "imbalance of ranks: " << imbalance_at_start_ << " at the start, " << most << " at most";
  if (balancing.count() > 0) {
    text << "; the mesh was divided in another way " << balancing.count()
         << (balancing.count() == 1 ? " time" : " times");
    if (balancing.count_here() == balancing.count())
      text << ", in " << balancing.seconds() << " s";
    else
      text << " (" << balancing.count_here() << " of them since the run was resumed, in " << balancing.seconds()
           << " s)";
    if (balancing.saved() > 0)
      text << ", which saved about " << 100 * balancing.saved() / (1 + balancing.saved())
           << " % of the time of steps (by their work, had the imbalance lasted)";
  }
  note(text.str(), event::ranks, {{"imbalance_at_start", imbalance_at_start_}, {"largest_imbalance", most}});
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
  note(text.str(), event::steps,
       {{"steps", s.steps},
        {"shortest_step_s", s.shortest},
        {"longest_step_s", s.longest},
        {"evaluations", s.evaluations},
        {"rejections", s.rejections},
        {"inversions", s.inversions},
        {"by_error", s.by_error},
        {"by_stability", s.by_stability},
        {"by_outputs", s.by_schedule}});
  note("steps bounded by the error: " + std::to_string(s.by_error) + ", stability: " + std::to_string(s.by_stability) +
       ", outputs: " + std::to_string(s.by_schedule));
  note(of_.dynamics.step_bound().sentence());
  note_pressure_solves();
}

/// What the solves for implicit pore pressure did, for the log, and a warning where one of them lacks much.
template <int dim>
void Recorder<dim>::note_pressure_solves() {
  constexpr double much = 0.1;  // of the pressure
  const PressureSolves done = of_.world.motion->pressure_solves();
  if (done.steps == 0) return;
  const double mean = static_cast<double>(done.iterations) / static_cast<double>(done.steps);
  const EventValues values = {{"mean_iterations", mean},
                              {"most_iterations", done.most_iterations},
                              {"unsolved", done.unsolved},
                              {"largest_share_lacking", done.worst}};
  note("pore pressure took " + rounded(mean) + " iterations per step and " + std::to_string(done.most_iterations) +
           " at most; " + std::to_string(done.unsolved) + " of " + std::to_string(done.steps) +
           " solves did not converge",
       event::pressure_solves, values);
  if (done.worst > much)
    warn("a solve for pore pressure left out " + rounded(100 * done.worst) +
             " % of it: look at the pressures of that time; a smaller integrator.fraction may help",
         event::pressure_solves, values);
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
    record({event::broke_off, message.str()});
    results_->progress.failure(message.str());
    if (options_.pictures && !interrupted && results_->file.last_step() >= 0)
      throw BrokenOff(message.str() + "; report.html there shows how far it came", options_.directory,
                      scene_.output->picture);
  }
  throw RunError(message.str());
}

template void Recorder<2>::begin_stage(const Stage &);
template void Recorder<3>::begin_stage(const Stage &);
template void Recorder<2>::progress();
template void Recorder<3>::progress();
template void Recorder<2>::seeking(int, double);
template void Recorder<3>::seeking(int, double);
template void Recorder<2>::record(Event);
template void Recorder<3>::record(Event);
template void Recorder<2>::tell(const Event &);
template void Recorder<3>::tell(const Event &);
template bool Recorder<2>::happened(const char *, double) const;
template bool Recorder<3>::happened(const char *, double) const;
template std::string Recorder<2>::ways_in_words();
template std::string Recorder<3>::ways_in_words();
template void Recorder<2>::note_escaped();
template void Recorder<3>::note_escaped();
template void Recorder<2>::note_lost_soil();
template void Recorder<3>::note_lost_soil();
template void Recorder<2>::write_escaped();
template void Recorder<3>::write_escaped();
template void Recorder<2>::note_imbalance();
template void Recorder<3>::note_imbalance();
template void Recorder<2>::note_balancing(double, double);
template void Recorder<3>::note_balancing(double, double);
template void Recorder<2>::note_sharing();
template void Recorder<3>::note_sharing();
template void Recorder<2>::note_steps();
template void Recorder<3>::note_steps();
template void Recorder<2>::fail(const std::string &);
template void Recorder<3>::fail(const std::string &);

}  // namespace talus
