#include "solvers/arkode.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "solvers/nodal_vector.h"
#include "solvers/sundials_versions.h"

namespace talus {
namespace {

/// One Runge-Kutta method and the largest omega h at which its solution of y'' = -omega^2 y does not grow.
struct Method {
  ARKODE_ERKTableID table;  ///< ARKODE_ERK_NONE: our own below
  double limit;
};

// Order 2 in three stages (Kinnmark & Gray 1984): two-stage methods of order 2 amplify every undamped wave. Of order 5,
// Cash-Karp and Fehlberg do as well; of Dormand & Prince's, waves up to omega h = 1 fade.
constexpr Method methods[] = {{ARKODE_ERK_NONE, 2},
                              {ARKODE_BOGACKI_SHAMPINE_4_2_3, 1.7320508},
                              {ARKODE_ZONNEVELD_5_3_4, 2.8284271},
                              {ARKODE_DORMAND_PRINCE_7_4_5, 0.9969}};
// With drag: Ascher, Ruuth & Spiteri (1997), section 2.8, of order 3. No stage asks for the rate of the drag itself,
// only for the solution of implicit steps, so that it may be as stiff as it likes. The limit holds for two phases of
// any masses, stiffnesses and drag.
constexpr Method method_with_drag{ARKODE_ERK_NONE, 1.56};

const Method &method_of(const ArkodeSettings &settings) {
  return settings.drag ? method_with_drag : methods[settings.order - 2];
}

/// A pair of tables of one method; null where it has no such part.
struct Tables {
  ARKodeButcherTable explicit_part = nullptr, implicit_part = nullptr;
  Tables() = default;
  Tables(const Tables &) = delete;
  ~Tables() { ARKodeButcherTable_Free(explicit_part), ARKodeButcherTable_Free(implicit_part); }
};

void set_tables(const ArkodeSettings &settings, Tables &tables) {
  if (settings.drag) {
    double c[] = {0, 1. / 2, 2. / 3, 1. / 2, 1},
           embedded[] = {0, 2, -3. / 4, -1. / 2, 1. / 4};  // of order 2; damps stiff drag completely
    double a[] = {0, 0, 0,      0,       0,      1. / 2, 0, 0,      0,      0,      11. / 18, 1. / 18, 0,
                  0, 0, 5. / 6, -5. / 6, 1. / 2, 0,      0, 1. / 4, 7. / 4, 3. / 4, -7. / 4,  0};
    double implicit[] = {0, 0, 0, 0,       0,      0,      1. / 2, 0, 0,      0,       0,      1. / 6, 1. / 2,
                         0, 0, 0, -1. / 2, 1. / 2, 1. / 2, 0,      0, 3. / 2, -3. / 2, 1. / 2, 1. / 2};
    tables.explicit_part = ARKodeButcherTable_Create(5, 3, 2, c, a, a + 20, embedded);
    tables.implicit_part = ARKodeButcherTable_Create(5, 3, 2, c, implicit, implicit + 20, embedded);
  } else if (method_of(settings).table == ARKODE_ERK_NONE) {
    double c[] = {0, 0.5, 0.5}, b[] = {0, 0, 1}, embedded[] = {1, 0, 0};
    double a[] = {0, 0, 0, 0.5, 0, 0, 0, 0.5, 0};
    tables.explicit_part = ARKodeButcherTable_Create(3, 2, 1, c, a, b, embedded);
  } else {
    tables.explicit_part = ARKodeButcherTable_LoadERK(method_of(settings).table);
  }
}

}  // namespace

struct Arkode::Memory {
  SUNContext context = nullptr;
  N_Vector state = nullptr, error = nullptr, first = nullptr;  // `first`: rates at the start of the step
  void *solver = nullptr;
  NodalSpace space{};
  double started = 0, largest = 0;   // start of the step under way, stable step [s]
  double wanted = 0;                 // next step that the error allows [s]
  double first_at = 0;               // time of `first` [s]; only the first stage is at that time
  long long evaluations = 0;         // of the step under way
  long rejections = 0;               // that ARKODE has counted
  long long inversions = 0;          // among them
  bool others = true, fresh = true;  // nodes or loads have changed; the state is the accepted one
  PetscErrorCode failure = 0;
  std::string obstacle;
  int component = -1;
  SUNNonlinearSolver drag = nullptr;
  sundials::StepControl control{next_step, this};
  int order = 0;  // of the method

  ~Memory() {
    if (solver) ARKodeFree(&solver);
    control.release();
    if (drag) SUNNonlinSolFreeEmpty(drag);
    if (first) N_VDestroy(first);
    if (error) N_VDestroy(error);
    if (state) destroy_nodal_vector(state);
    if (context) SUNContext_Free(&context);
  }
  PetscErrorCode create(const ArkodeSettings &settings, Motion &motion, double t);
  void name_obstacle(double floor);

  static int rates(double t, N_Vector y, N_Vector rate, void *self);
  static int solve_drag(SUNNonlinearSolver, N_Vector, N_Vector change, N_Vector, double, int, void *solver);
  static int accept(double t, N_Vector y, void *self);
  /// The step whose error just meets the tolerance with some caution, after a step h with error e. The error of the
  /// embedded method is of the order of the method. ARKODE's own controllers look back over several steps; that history
  /// does not survive a remap.
  static double next_step(double h, double e, void *self) {
    constexpr double shrink = 0.1, growth = 5, caution = 1.5;
    Memory &m = *static_cast<Memory *>(self);
    const double factor = e > 0 ? std::pow(caution * e, -1. / m.order) : growth;
    return m.wanted = h * std::clamp(factor, shrink, growth);
  }
  static constexpr double cfl = 0.9;  // ARKODE wants a fraction below 1; `stable_step` makes up for it
  static int stable_step(N_Vector, double, double *step, void *self) {
    *step = 1.25 / cfl *
            static_cast<Memory *>(self)->largest;  // `advance` caps each step; here it bounds what is carried on
    return 0;
  }
};

int Arkode::Memory::rates(double t, N_Vector y, N_Vector rate, void *self) {
  Memory &m = *static_cast<Memory *>(self);
  Motion &motion = *m.space.motion;
  if (!m.fresh && t == m.first_at)
    return N_VScale(1, m.first, rate), 0;  // ARKODE asks again after a reset, and for another attempt
  ++m.evaluations;
  m.failure =
      motion.rates(t, m.fresh ? nullptr : displacement_of(y), velocity_of(y), displacement_of(rate), velocity_of(rate));
  if (!m.fresh && motion.inverted()) m.space.inverted = true;
  if (m.fresh) N_VScale(1, rate, m.first), m.first_at = t;
  m.fresh = false;
  return m.failure ? -1 : 0;
}

/// A stage of the implicit partition: y = predicted + change solves y = predicted + known + gamma D y; places have no
/// drag.
int Arkode::Memory::solve_drag(SUNNonlinearSolver, N_Vector, N_Vector change, N_Vector, double, int, void *solver) {
  double t, gamma;
  N_Vector predicted, known, stage, rate;
  void *self;
  if (ARKodeGetNonlinearSystemData(solver, &t, &predicted, &stage, &rate, &gamma, &known, &self)) return -1;
  Memory &m = *static_cast<Memory *>(self);
  N_VLinearSum(1, predicted, 1, known, change);
  m.failure = m.space.motion->apply_drag(t, gamma, velocity_of(change));
  N_VLinearSum(1, change, -1, predicted, change);
  return m.failure ? -1 : 0;
}

/// A step has passed its error test: boundaries take their share, history is committed, and displacement counts from
/// here.
int Arkode::Memory::accept(double t, N_Vector y, void *self) {
  Memory &m = *static_cast<Memory *>(self);
  Motion &motion = *m.space.motion;
  const double step = t - m.started;
  m.failure = m.drag ? motion.apply_boundaries(t, step, velocity_of(y))
                     : motion.apply_boundaries_and_drag(t, step, velocity_of(y));
  if (!m.failure) m.failure = motion.accept(t, displacement_of(y), velocity_of(y));
  std::fill_n(displacement_of(y), motion.size(), 0.);
  m.fresh = true;
  return m.failure ? -1 : 0;
}

PetscErrorCode Arkode::Memory::create(const ArkodeSettings &settings, Motion &motion, double t) {
  PetscFunctionBeginUser;
  const MPI_Comm comm = motion.comm();
  space = {&motion, settings.displacement_tolerance, settings.velocity_tolerance};
  order = settings.order;
  PetscCheck(sundials::create_context(comm, &context) == 0, comm, PETSC_ERR_LIB, "SUNContext_Create");
  PetscCall(make_nodal_vector(space, context, &state));
  error = N_VClone(state), first = N_VClone(state);
  const ARKRhsFn no_rate = [](double, N_Vector, N_Vector rate, void *) {
    return N_VConst(0, rate), 0;
  };  // asked at a stage that does not count
  solver = ARKStepCreate(rates, settings.drag ? no_rate : nullptr, t, state, context);
  PetscCheck(error && first && solver, comm, PETSC_ERR_MEM, "ARKStepCreate");
  Tables tables;
  set_tables(settings, tables);
  int bad = ARKStepSetTables(solver, settings.order, settings.order - 1, tables.implicit_part, tables.explicit_part);
  if (settings.drag) {
    drag = SUNNonlinSolNewEmpty(context);
    drag->ops->gettype = [](SUNNonlinearSolver) { return SUNNONLINEARSOLVER_FIXEDPOINT; };
    drag->ops->setsysfn = [](SUNNonlinearSolver, SUNNonlinSolSysFn) { return 0; };
    drag->ops->solve = solve_drag;
    bad |= ARKodeSetNonlinearSolver(solver, drag);
    bad |= ARKodeSetDeduceImplicitRhs(solver, 1);
  }
  bad |= ARKodeSetUserData(solver, this);
  bad |= ARKodeWFtolerances(solver, [](N_Vector, N_Vector weight, void *) { return N_VConst(1, weight), 0; });
  bad |= ARKodeSetPostprocessStepFn(solver, accept);
  bad |= ARKodeSetStabilityFn(solver, stable_step, this);
  bad |= ARKodeSetCFLFraction(solver, cfl);
  bad |= control.give_to(solver, context);
  bad |= ARKodeSetFixedStepBounds(solver, 1, 1.001);  // a step cut short for an output is made up for at once
  bad |= ARKodeSetInterpolantType(solver, ARK_INTERP_LAGRANGE);
  bad |= ARKodeSetInterpolantDegree(solver, 1);  // nobody asks for values between steps
  bad |= ARKodeSetMaxErrTestFails(solver, 30);
  bad |= ARKodeSetMaxNumSteps(solver, -1);
  bad |= ARKodeSetMaxHnilWarns(solver, -1);
  bad |= sundials::silence(solver, context);
  PetscCheck(!bad, comm, PETSC_ERR_LIB, "ARKStep refuses its settings");
  PetscFunctionReturn(0);
}

/// Who asks for the step that is too short: the node with the largest share of the error.
void Arkode::Memory::name_obstacle(double floor) {
  Motion &motion = *space.motion;
  ARKodeGetEstLocalErrors(solver, error);
  const int size = motion.size();
  const double *u = displacement_of(error), *v = velocity_of(error);
  double largest[2] = {0, 0};
  int at = -1;
  for (int i = 0; i < size; ++i)
    for (int k : {0, 1}) {
      const double share =
          k ? std::abs(v[i]) / space.velocity_tolerance : std::abs(u[i]) / space.displacement_tolerance;
      if (share > std::max(largest[0], largest[1])) at = i;
      largest[k] = std::max(largest[k], share);
    }
  struct {
    double share;
    int rank;
  } mine{std::max(largest[0], largest[1]), 0}, all;
  int rank;
  MPI_Comm_rank(motion.comm(), &rank);
  mine.rank = rank;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, motion.comm());
  int velocity = largest[1] >= largest[0];
  MPI_Bcast(&velocity, 1, MPI_INT, all.rank, motion.comm());
  component = rank == all.rank ? at : -1;
  char text[400];
  std::snprintf(text, sizeof text,
                "the error of the %s cannot be kept within integrator.%s with steps above integrator.floor (%.3g s); "
                "loosen the tolerance, lower the "
                "floor, or look at the soil",
                velocity ? "velocity" : "displacement", velocity ? "velocity_tolerance" : "displacement_tolerance",
                floor);
  obstacle = text;
}

Arkode::Arkode(const ArkodeSettings &settings) : settings_(settings), memory_(std::make_unique<Memory>()) {}
Arkode::~Arkode() = default;

StepRule ArkodeSettings::rule() const {
  return {step, fraction * method_of(*this).limit / 2, method_of(*this).limit / 2, bound};
}
std::unique_ptr<Integrator> ArkodeSettings::make() const { return std::make_unique<Arkode>(*this); }

void Arkode::restart() { memory_->others = true; }
void Arkode::serialize(Archive &archive) {
  Integrator::serialize(archive);
  archive.serialize("arkode", memory_->wanted);
}

std::string Arkode::obstacle() const { return memory_->obstacle; }
int Arkode::obstructing_component() const { return memory_->component; }

PetscErrorCode Arkode::advance(Motion &motion, double t, const StepBounds &bounds, double *taken) {
  PetscFunctionBeginUser;
  Memory &m = *memory_;
  const bool fixed = settings_.step > 0;
  if (!m.solver) PetscCall(m.create(settings_, motion, t));
  if (m.others) {
    std::fill_n(displacement_of(m.state), motion.size(), 0.);
    std::copy_n(motion.velocity(), motion.size(), velocity_of(m.state));
    m.fresh = true, m.others = false;
  }
  // Each step begins from what a checkpoint knows: ARKODE's own time and step differ from these by round-off, which a
  // resumed run would not have.
  PetscCheck(ARKodeReset(m.solver, t, m.state) == 0, motion.comm(), PETSC_ERR_LIB, "ARKodeReset");
  m.largest = settings_.rule().share * bounds.critical, m.started = t;
  if (m.wanted == 0) m.wanted = 0.1 * m.largest;
  const double wanted = m.wanted,
               step = even_step(fixed ? settings_.step : std::min(0.95 * wanted, m.largest), bounds.until - t, fixed);
  const double floor = settings_.floor * bounds.critical;
  int bad = 0;
  if (fixed) {
    bad |= ARKodeSetFixedStep(m.solver, step);
  } else {
    bad |= ARKodeSetInitStep(m.solver, step);
    bad |= ARKodeSetMinStep(m.solver, std::min(floor, 0.5 * step));
  }
  bad |= ARKodeSetStopTime(m.solver, t + step);
  PetscCheck(!bad, motion.comm(), PETSC_ERR_LIB, "ARKStep refuses a step of %g s", step);
  double reached = t;
  const int ended = ARKodeEvolve(m.solver, t + step, m.state, &reached, ARK_ONE_STEP);
  PetscCall(m.failure);
  long rejections;
  ARKodeGetNumErrTestFails(m.solver, &rejections);
  const long long inversions = m.space.inversions - std::exchange(m.inversions, m.space.inversions);
  statistics_.evaluations += std::exchange(m.evaluations, 0), statistics_.inversions += inversions;
  statistics_.rejections += rejections - std::exchange(m.rejections, rejections) - inversions;
  if (ended < 0) {
    PetscCheck(ended == ARK_ERR_FAILURE, motion.comm(), PETSC_ERR_LIB, "ARKodeEvolve returned %d", ended);
    m.name_obstacle(floor);
    *taken = 0;
    PetscFunctionReturn(0);
  }
  *taken = reached - t;
  const bool short_of = !fixed && (*taken < 0.99 * step || wanted < m.largest);
  count(*taken, short_of ? Bound::error : bounded_by(bounds.until - t, *taken));
  PetscFunctionReturn(0);
}

}  // namespace talus
