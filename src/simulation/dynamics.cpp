#include "simulation/dynamics.h"

#include <petsctime.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/mesh_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"

namespace talus {

IntegratorSettings choose_integrator(const Scene &scene) {
  const PhaseTraits phases = phase_traits(scene.phases);
  DeferredTable table = scene.integrator;
  const IntegratorSettings settings = read_integrator(table, phases.liquid);
  const bool by_euler = std::holds_alternative<EulerSettings>(settings);
  if (scene.water->drag == PoreDrag::at_start && !(phases.liquid && by_euler))
    scene.complain("water.drag",
                   std::string("can be \"explicit\" only ") +
                       (phases.liquid ? "with integrator.kind = \"euler\": the others take drag over a step"
                                      : "where pore fluids move") +
                       "; leave it out");
  if (scene.water->storage == PoreStorage::rate && !(phases.suction && !phases.gas && by_euler))
    scene.complain("water.storage",
                   "can be \"rate\" only with phases = \"unsaturated\" and integrator.kind = \"euler\"; leave it out");
  if (scene.water->pressure == PoreIntegration::at_end)
    if (const auto refused = implicit_pressure_refused(scene)) scene.complain(refused->key, refused->text);
  if (!phases.liquid) return settings;
  if (const std::string problem = drag_problem(settings); !problem.empty())
    scene.complain("integrator.kind", "must be \"euler\", or \"arkode\" of order 3, where pore fluids move: " +
                                          problem + "; or take phases = \"dry\" or \"drained\"");
  for (size_t k = 0; k < scene.stage.size() && phases.gas; ++k)
    if (scene.stage[k].is_static())
      scene.complain("stage." + std::to_string(k) + ".kind",
                     "must be \"dynamic\" where gas moves; quasi-static stages take any other phases");
  return settings;
}

namespace {

int ranks_of(MPI_Comm comm) {
  int ranks;
  MPI_Comm_size(comm, &ranks);
  return ranks;
}

/// Cells on the busiest rank when the mesh is divided anew: all of the file, and its own once their edges are halved.
template <int dim>
long long cells_to_divide(const World<dim> &world) {
  const long long all = world.mesh.report().cells;
  const int halvings = world.scene.mesh->halvings;
  return halvings == 0 ? all : (all >> dim * halvings) + all / ranks_of(world.comm);
}

/// Adds to `sum` the time that `work` takes [s].
template <class Work>
void timed(double &sum, Work &&work) {
  PetscLogDouble start, end;
  require(PetscTime(&start));
  require(work());
  require(PetscTime(&end));
  sum += end - start;
}

}  // namespace

template <int dim>
Dynamics<dim>::Dynamics(World<dim> &world, Clock &clock, const IntegratorSettings &settings)
    : world_(world),
      clock_(clock),
      bound_(choose_step_bound(world.scene, world.laws, world.report(), settings, world.mesh.report().one_element_slice,
                               world.pore_integration.sentence)),
      settings_(with_bound(settings, bound_.by)),
      integrator_(make_integrator(settings_)),
      balancing_(world.scene.mesh->balance_ranks, ranks_of(world.comm), cells_to_divide(world),
                 world.mesh.divisible()) {
  check_incoming_wave();
  check_fixed_step();
}

/// Integrators of higher order take dashpots once a step, which is of the first order: of a wave that comes in their
/// long steps lose a sixth.
template <int dim>
void Dynamics<dim>::check_incoming_wave() const {
  const auto comes_in = [](const NamedBoundary &source) { return source.kind.incoming_wave; };
  if (std::ranges::any_of(world_.conditions.sources(), comes_in) && !std::holds_alternative<EulerSettings>(settings_))
    world_.scene.complain("integrator.kind", "must be \"euler\" where a wave comes in (incoming_wave = true)");
}

/// A fixed step that the first state already forbids is bad input; one that a later state forbids ends the run.
template <int dim>
void Dynamics<dim>::check_fixed_step() {
  const StepRule rule = step_rule(settings_);
  if (rule.fixed == 0) return;
  double critical =
      bound_.by == FrequencyBound::mesh || explicit_drag() ? critical_step() : std::numeric_limits<double>::infinity();
  if (std::isinf(critical))
    for (const BodyReport &body : world_.report()) critical = std::min(critical, body.critical_step);
  bool damped = false;
  for (const Stage &stage : world_.scene.stage) {
    if (!(stage.damping_frequencies()[1] > 0)) continue;
    damped = true, critical = std::min(critical, critical_step(stage.damping_frequencies()));
  }
  if (rule.fixed > rule.limit * critical)
    world_.scene.complain("integrator.step", "must not exceed the critical step of " + rounded(rule.limit * critical) +
                                                 " s (" + rounded(2 * rule.limit) + " / omega_max of the filled cells" +
                                                 (explicit_drag() ? ", less for explicit drag" : "") +
                                                 (damped ? ", less for Rayleigh damping" : "") +
                                                 "); take a smaller step, a coarser mesh, or leave step out");
}

template <int dim>
void Dynamics<dim>::set_loading(const Stage &stage, double stage_time) {
  world_.set_loading(stage, stage_time, clock_);
  clock_.hold_loads = stage.hold_loads;
}

template <int dim>
Verdict Dynamics<dim>::cycle(double until) {
  constexpr int remaps_between_sorts = 20;
  AnySoilMotion<dim> &motion = *world_.motion;
  require(motion.begin(clock_.time));
  const StepBounds bounds{stable_step(), until};
  double step = 0;
  timed(world_.breakdown.step, [&] { return integrator_->advance(motion, clock_.time, bounds, &step); });
  refuse_obstacle();
  clock_.advance(step);
  const Verdict verdict = agree();
  if (verdict.broken) refuse_broken();
  just_remapped_ = remap_due_;
  if (!remap_due_) {
    require(motion.update_pore_pressures(clock_.time));
    return verdict;
  }
  const bool sorting = ++since_sort_ >= remaps_between_sorts;
  require(world_.release(clock_.time, !sorting));
  ++remaps_;
  if (sorting) require(world_.sort()), since_sort_ = 0;
  double work;
  require(world_.check_conservation(work_of_rank_, &work));
  balancing_.remap(work);
  timed(world_.breakdown.gather, [&] { return motion.begin(clock_.time); });
  return verdict;
}

/// What holds until particles are released does not hold any more.
template <int dim>
void Dynamics<dim>::notice_release() {
  if (known_releases_ == world_.releases()) return;
  known_releases_ = world_.releases();
  critical_step_ = 0, shrink_ = 1;
  integrator_->restart();
}

template <int dim>
double Dynamics<dim>::critical_step() {
  double step = world_.critical_step_of_cells(clock_.time);
  if (bound_.by == FrequencyBound::mesh) {
    constexpr int first = 60, further = 6;  // iterations
    // between two estimates: steps, and what nodes moved in mean edges, by which the default transfer remaps
    constexpr int apart = 8;
    constexpr double moved = 0.1;
    const bool anew = omega_step_ < 0;
    if (anew || (clock_.steps >= omega_step_ + apart && moved_since_estimate_ >= moved)) {
      require(world_.motion->largest_frequency(anew ? first : further, &omega_max_));
      omega_step_ = clock_.steps, moved_since_estimate_ = 0;
    }
    step = std::max(step, with_explicit_drag(2 / omega_max_, world_.damping_rate(omega_max_)));
  }
  if (explicit_drag()) {
    double mine = world_.motion->drag_rate(), rate;
    MPI_Allreduce(&mine, &rate, 1, MPI_DOUBLE, MPI_MAX, world_.comm);
    step = with_explicit_drag(step, rate);
  }
  return step;
}

template <int dim>
double Dynamics<dim>::critical_step(const std::array<double, 2> &damping_frequencies) {
  std::array<double, 2> &acting = world_.motion->loading.damping_frequencies;
  const std::array<double, 2> kept = std::exchange(acting, damping_frequencies);
  const double step = critical_step();
  acting = kept;
  return step;
}

/// The critical step of the present state [s], which a fixed step must not exceed. Collective.
template <int dim>
double Dynamics<dim>::stable_step() {
  notice_release();
  if (damping_frequencies_ != world_.motion->loading.damping_frequencies)
    damping_frequencies_ = world_.motion->loading.damping_frequencies, critical_step_ = 0;
  if (critical_step_ == 0 || explicit_drag())
    critical_step_ = critical_step();  // drag follows saturation from step to step
  const StepRule rule = step_rule(settings_);
  if (rule.fixed > rule.limit * critical_step_)
    throw RunFailure("the soil has come to cells with a critical step of " + rounded(rule.limit * critical_step_) +
                     " s, but integrator.step = " + rounded(rule.fixed) + " s; take a smaller step, or leave it out");
  return critical_step_ * shrink_;
}

template <int dim>
void Dynamics<dim>::refuse_obstacle() {
  const std::string cause = integrator_->obstacle();
  if (cause.empty()) return;
  const FilledGrid<dim> &grid = world_.motion->grid();
  const int component = integrator_->obstructing_component();
  const bool mine = component >= 0;
  const Vec<dim> where = mine ? grid.position[component / dim % grid.node_count()] : Vec<dim>{};
  const std::string particle = text_of_first(world_.comm, mine, mine ? world_.nearest_particle(where) : "");
  throw RunFailure(particle.empty() ? cause
                                    : cause + "; it is largest near " + place_of_first<dim>(world_.comm, mine, where) +
                                          ", at " + particle);
}

template <int dim>
Verdict Dynamics<dim>::agree() {
  constexpr double elsewhere = std::numeric_limits<double>::lowest();
  Vec<3> watched{};
  if (watch && !watch(&watched)) watched.fill(elsewhere);
  const StepMeasures &measures = world_.motion->measures();
  double mine[9] = {measures.moved,
                    1 / measures.step_ratio,
                    measures.smallest_volume_ratio <= 0.2 ? 1. : 0.,
                    !(measures.speed_squared < 1e300) ? 1. : 0.,
                    interrupted ? 1. : 0.,
                    watched[0],
                    watched[1],
                    watched[2],
                    world_.work_of_rank(balancing_.steps() + 1)};
  for (const auto &body : world_.bodies)
    if (!law_trouble(body->law()).text.empty()) mine[3] = 1;
  if (!world_.scene.function_fault().empty()) mine[3] = 1;
  double all[9];
  MPI_Allreduce(mine, all, 9, MPI_DOUBLE, MPI_MAX, world_.comm);
  work_of_rank_ = mine[8], balancing_.step(all[8]);
  if (watch && all[5] == elsewhere)
    throw RunFailure(
        "the particle that this stage watches has left the mesh; watch another place, or end the stage by its "
        "duration");
  const Verdict verdict{all[0], all[1], {all[5], all[6], all[7]}, all[2] > 0, all[3] > 0, all[4] > 0};
  shrink_ = 1 / verdict.shrink;
  const double interval = world_.scene.transfer->remap_interval;
  remap_due_ = interval == 0 || verdict.moved > interval || verdict.inverted;
  if (remap_due_) moved_since_estimate_ += verdict.moved;
  return verdict;
}

template <int dim>
void Dynamics<dim>::refuse_broken() {
  if (const std::string fault = world_.function_fault(); !fault.empty()) throw RunFailure(fault);
  Vec<dim> where{};
  std::string cause;
  const bool refused = world_.motion->find_trouble(&where, &cause);
  const std::string place = place_of_first<dim>(world_.comm, refused, where);
  if (!place.empty()) throw RunFailure("near " + place + ", " + text_of_first(world_.comm, refused, cause));
  const bool mine = world_.motion->find_broken(&where);
  throw MotionFailure("the velocity is not finite near " + place_of_first<dim>(world_.comm, mine, where) +
                      "; look at the loads there; a smaller integrator.fraction" +
                      (world_.phases.fluids() > 0 ? "" : ", a volume_cap") +
                      " or transfer.remap_interval = 0 may help");
}

template <int dim>
void Dynamics<dim>::serialize(Archive &archive) {
  notice_release();
  archive.serialize("dynamics", remaps_, since_sort_, critical_step_, damping_frequencies_, shrink_, omega_max_,
                    omega_step_, moved_since_estimate_, remap_due_);
  balancing_.serialize(archive);
  if (archive.reading()) integrator_ = make_integrator(settings_);  // the nodes are others
  integrator_->serialize(archive);
  known_releases_ = world_.releases();
}

template <int dim>
bool Dynamics<dim>::explicit_drag() const {
  return world_.scene.water->drag == PoreDrag::at_start;
}

template class Dynamics<2>;
template class Dynamics<3>;

}  // namespace talus
