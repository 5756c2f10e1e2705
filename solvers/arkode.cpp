#include "solvers/arkode.h"

#include <arkode/arkode_erkstep.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "solvers/nodal_vector.h"

namespace talus {
namespace {

/// One explicit Runge-Kutta method and the largest omega h at which its solution of y'' = -omega^2 y does not grow.
struct Method {
  ARKODE_ERKTableID table;
  double limit;
};

// Order 2 in three stages (Kinnmark & Gray 1984): two-stage methods of order 2 amplify every undamped wave. Of order 5, Cash-Karp and
// Fehlberg do as well; of Dormand & Prince's, waves up to omega h = 1 fade.
constexpr Method methods[] = {{ARKODE_ERK_NONE, 2}, {ARKODE_BOGACKI_SHAMPINE_4_2_3, 1.7320508}, {ARKODE_ZONNEVELD_5_3_4, 2.8284271}, {ARKODE_DORMAND_PRINCE_7_4_5, 0.9969}};

const Method &method_of(int order) { return methods[order - 2]; }

ARKodeButcherTable second_order() {
  double c[] = {0, 0.5, 0.5}, b[] = {0, 0, 1}, embedded[] = {1, 0, 0};
  double a[] = {0, 0, 0, 0.5, 0, 0, 0, 0.5, 0};
  return ARKodeButcherTable_Create(3, 2, 1, c, a, b, embedded);
}

}  // namespace

struct Arkode::Memory {
  SUNContext context = nullptr;
  N_Vector state = nullptr, error = nullptr;
  void *solver = nullptr;
  NodalSpace space{};
  double started = 0, largest = 0;   // start of the step under way, stable step [s]
  double wanted = 0;                 // next step that the error allows [s]
  long long evaluations = 0;         // of the step under way
  long rejections = 0;               // that ARKODE has counted
  bool others = true, fresh = true;  // nodes or loads have changed; the state is the accepted one
  PetscErrorCode failure = 0;
  std::string obstacle;
  int node = -1;

  ~Memory() {
    if (solver) ERKStepFree(&solver);
    if (error) N_VDestroy(error);
    if (state) N_VDestroy(state);
    if (context) SUNContext_Free(&context);
  }
  PetscErrorCode create(const ArkodeSettings &settings, Motion &motion, double t);
  void name_obstacle(double floor);

  static int rates(double t, N_Vector y, N_Vector rate, void *self);
  static int accept(double t, N_Vector y, void *self);
  /// The step h whose error e, of order p + 1 for an embedded method of order p, just meets the tolerance. ARKODE's own controllers
  /// look back over several steps; that history does not survive a remap.
  static int next_step(N_Vector, double, double h, double, double, double e, double, double, int, int p, double *next, void *self) {
    constexpr double shrink = 0.1, growth = 5;
    const double factor = e > 0 ? std::pow(e, -1. / (p + 1)) : growth;
    *next = static_cast<Memory *>(self)->wanted = h * std::clamp(factor, shrink, growth);
    return 0;
  }
  static constexpr double cfl = 0.9;  // ARKODE wants a fraction below 1; `stable_step` makes up for it
  static int stable_step(N_Vector, double, double *step, void *self) {
    *step = 1.25 / cfl * static_cast<Memory *>(self)->largest;  // `advance` caps each step; here it bounds what is carried on
    return 0;
  }
};

int Arkode::Memory::rates(double t, N_Vector y, N_Vector rate, void *self) {
  Memory &m = *static_cast<Memory *>(self);
  Motion &motion = *m.space.motion;
  ++m.evaluations;
  m.failure = motion.rates(t, m.fresh ? nullptr : displacement_of(y), velocity_of(y), displacement_of(rate), velocity_of(rate));
  if (!m.fresh && motion.inverted()) m.space.inverted = true;
  m.fresh = false;
  return m.failure ? -1 : 0;
}

/// A step has passed its error test: boundaries take their share, history is committed, and displacement counts from here.
int Arkode::Memory::accept(double t, N_Vector y, void *self) {
  Memory &m = *static_cast<Memory *>(self);
  Motion &motion = *m.space.motion;
  m.failure = motion.drag(t, t - m.started, velocity_of(y));
  if (!m.failure) m.failure = motion.accept(t, displacement_of(y), velocity_of(y));
  std::fill_n(displacement_of(y), motion.size(), 0.);
  m.fresh = true;
  return m.failure ? -1 : 0;
}

PetscErrorCode Arkode::Memory::create(const ArkodeSettings &settings, Motion &motion, double t) {
  PetscFunctionBeginUser;
  MPI_Comm comm = motion.comm();
  space = {&motion, settings.displacement_tolerance, settings.velocity_tolerance};
  PetscCheck(SUNContext_Create(&comm, &context) == 0, comm, PETSC_ERR_LIB, "SUNContext_Create");
  state = make_nodal_vector(space, context), error = N_VClone(state);
  solver = ERKStepCreate(rates, t, state, context);
  PetscCheck(state && error && solver, comm, PETSC_ERR_MEM, "ERKStepCreate");
  const Method &method = method_of(settings.order);
  int bad = 0;
  if (method.table == ARKODE_ERK_NONE) {
    ARKodeButcherTable table = second_order();
    bad |= ERKStepSetTable(solver, table);
    ARKodeButcherTable_Free(table);
  } else {
    bad |= ERKStepSetTableNum(solver, method.table);
  }
  bad |= ERKStepSetUserData(solver, this);
  bad |= ERKStepWFtolerances(solver, [](N_Vector, N_Vector weight, void *) { return N_VConst(1, weight), 0; });
  bad |= ERKStepSetPostprocessStepFn(solver, accept);
  bad |= ERKStepSetStabilityFn(solver, stable_step, this);
  bad |= ERKStepSetCFLFraction(solver, cfl);
  bad |= ERKStepSetAdaptivityFn(solver, next_step, this);
  bad |= ERKStepSetFixedStepBounds(solver, 1, 1.001);    // a step cut short for an output is made up for at once
  bad |= ERKStepSetInterpolantType(solver, ARK_INTERP_LAGRANGE);
  bad |= ERKStepSetInterpolantDegree(solver, 1);         // nobody asks for values between steps
  bad |= ERKStepSetMaxErrTestFails(solver, 30);
  bad |= ERKStepSetMaxNumSteps(solver, -1);
  bad |= ERKStepSetMaxHnilWarns(solver, -1);
  bad |= ERKStepSetErrHandlerFn(solver, [](int, const char *, const char *, char *, void *) {}, nullptr);
  PetscCheck(!bad, comm, PETSC_ERR_LIB, "ERKStep refuses its settings");
  PetscFunctionReturn(0);
}

/// Who asks for the step that is too short: the node with the largest share of the error.
void Arkode::Memory::name_obstacle(double floor) {
  Motion &motion = *space.motion;
  ERKStepGetEstLocalErrors(solver, error);
  const int dim_size = motion.size();
  const double *u = displacement_of(error), *v = velocity_of(error);
  double largest[2] = {0, 0};
  int at = -1;
  for (int i = 0; i < dim_size; ++i)
    for (int k : {0, 1}) {
      const double share = k ? std::abs(v[i]) / space.velocity_tolerance : std::abs(u[i]) / space.displacement_tolerance;
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
  node = rank == all.rank ? at : -1;
  char text[400];
  std::snprintf(text, sizeof text,
                "the error of the %s cannot be kept within integrator.%s with steps above integrator.floor (%.3g s); loosen the tolerance, lower the "
                "floor, or look at the soil",
                velocity ? "velocity" : "displacement", velocity ? "velocity_tolerance" : "displacement_tolerance", floor);
  obstacle = text;
}

Arkode::Arkode(const ArkodeSettings &settings) : settings_(settings), memory_(std::make_unique<Memory>()) {}
Arkode::~Arkode() = default;

StepRule ArkodeSettings::rule() const { return {step, fraction * method_of(order).limit / 2, method_of(order).limit / 2}; }
std::unique_ptr<Integrator> ArkodeSettings::make() const { return std::make_unique<Arkode>(*this); }

void Arkode::restart() { memory_->others = true; }
void Arkode::keep(Archive &archive) {
  Integrator::keep(archive);
  archive.keep("arkode", memory_->wanted);
}

std::string Arkode::obstacle() const { return memory_->obstacle; }
int Arkode::obstructing_node() const { return memory_->node; }

PetscErrorCode Arkode::advance(Motion &motion, double t, const StepBounds &bounds, double *taken) {
  PetscFunctionBeginUser;
  Memory &m = *memory_;
  const bool fixed = settings_.step > 0, first = !m.solver;
  if (first) PetscCall(m.create(settings_, motion, t));
  if (m.others) {
    std::fill_n(displacement_of(m.state), motion.size(), 0.);
    std::copy_n(motion.velocity(), motion.size(), velocity_of(m.state));
    m.fresh = true, m.others = false;
    PetscCheck(ERKStepReset(m.solver, t, m.state) == 0, motion.comm(), PETSC_ERR_LIB, "ERKStepReset");
  }
  m.largest = settings_.rule().share * bounds.critical, m.started = t;
  if (m.wanted == 0) m.wanted = 0.1 * m.largest;
  const double wanted = m.wanted, step = even_step(fixed ? settings_.step : std::min(0.95 * wanted, m.largest), bounds.until - t, fixed);
  const double floor = settings_.floor * bounds.critical;
  int bad = 0;
  if (fixed) {
    bad |= ERKStepSetFixedStep(m.solver, step);
  } else {
    if (first) bad |= ERKStepSetInitStep(m.solver, step);
    bad |= ERKStepSetMinStep(m.solver, std::min(floor, 0.5 * step));
  }
  bad |= ERKStepSetStopTime(m.solver, t + step);
  PetscCheck(!bad, motion.comm(), PETSC_ERR_LIB, "ERKStep refuses a step of %g s", step);
  double reached = t;
  const int ended = ERKStepEvolve(m.solver, t + step, m.state, &reached, ARK_ONE_STEP);
  PetscCall(m.failure);
  long rejections;
  ERKStepGetNumErrTestFails(m.solver, &rejections);
  statistics_.evaluations += std::exchange(m.evaluations, 0), statistics_.rejections += rejections - std::exchange(m.rejections, rejections);
  if (ended < 0) {
    PetscCheck(ended == ARK_ERR_FAILURE, motion.comm(), PETSC_ERR_LIB, "ERKStepEvolve returned %d", ended);
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
