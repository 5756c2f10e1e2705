#include "solvers/multirate.h"

#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_mristep.h>

#include <utility>

#include "solvers/nodal_vector.h"

namespace talus {

struct Multirate::Memory {
  SUNContext context = nullptr;
  N_Vector state = nullptr;
  void *slow = nullptr, *fast = nullptr;
  MRIStepInnerStepper inner = nullptr;
  NodalSpace space{};
  long long slow_evaluations = 0, fast_evaluations = 0;
  PetscErrorCode failure = 0;

  ~Memory() {
    if (slow) MRIStepFree(&slow);
    if (inner) MRIStepInnerStepper_Free(&inner);
    if (fast) ARKStepFree(&fast);
    if (state) destroy_nodal_vector(state);
    if (context) SUNContext_Free(&context);
  }
  PetscErrorCode create(Motion &motion, double t);

  template <auto rates, auto evaluations>
  static int call(double t, N_Vector y, N_Vector rate, void *self) {
    Memory &m = *static_cast<Memory *>(self);
    ++(m.*evaluations);
    m.failure =
        (m.space.motion->*rates)(t, displacement_of(y), velocity_of(y), displacement_of(rate), velocity_of(rate));
    return m.failure ? -1 : 0;
  }
};

PetscErrorCode Multirate::Memory::create(Motion &motion, double t) {
  PetscFunctionBeginUser;
  MPI_Comm comm = motion.comm();
  space = {&motion, 1, 1};
  PetscCheck(SUNContext_Create(&comm, &context) == 0, comm, PETSC_ERR_LIB, "SUNContext_Create");
  PetscCall(make_nodal_vector(space, context, &state));
  fast = ARKStepCreate(call<&Motion::fast_rates, &Memory::fast_evaluations>, nullptr, t, state, context);
  PetscCheck(fast, comm, PETSC_ERR_MEM, "ARKStepCreate");
  int bad = ARKStepSetUserData(fast, this);
  bad |= ARKStepSetTableNum(fast, ARKODE_DIRK_NONE, ARKODE_BOGACKI_SHAMPINE_4_2_3);
  bad |= ARKStepSetMaxNumSteps(fast, -1);
  bad |= ARKStepSetInterpolantType(fast, ARK_INTERP_LAGRANGE);
  bad |= ARKStepSetInterpolantDegree(fast, 1);
  bad |= ARKStepCreateMRIStepInnerStepper(fast, &inner);
  slow = MRIStepCreate(call<&Motion::slow_rates, &Memory::slow_evaluations>, nullptr, t, state, inner, context);
  PetscCheck(slow, comm, PETSC_ERR_MEM, "MRIStepCreate");
  bad |= MRIStepSetUserData(slow, this);
  bad |= MRIStepSetInterpolantType(slow, ARK_INTERP_LAGRANGE);
  bad |= MRIStepSetInterpolantDegree(slow, 1);
  bad |= MRIStepSetMaxNumSteps(slow, -1);
  PetscCheck(!bad, comm, PETSC_ERR_LIB, "MRIStep refuses its settings");
  PetscFunctionReturn(0);
}

Multirate::Multirate(const MultirateSettings &settings) : settings_(settings), memory_(std::make_unique<Memory>()) {}
Multirate::~Multirate() = default;
long long Multirate::slow_evaluations() const { return memory_->slow_evaluations; }

PetscErrorCode Multirate::advance(Motion &motion, double t, const StepBounds &bounds, double *taken) {
  PetscFunctionBeginUser;
  Memory &m = *memory_;
  if (!m.slow) PetscCall(m.create(motion, t));
  const int size = motion.size();
  const double left = bounds.until - t, step = even_step(settings_.step, left, true);
  std::fill_n(displacement_of(m.state), size, 0.);
  std::copy_n(motion.velocity(), size, velocity_of(m.state));
  int bad = MRIStepReset(m.slow, t, m.state);
  bad |= ARKStepSetFixedStep(m.fast, step / settings_.substeps);
  bad |= MRIStepSetFixedStep(m.slow, step);
  bad |= MRIStepSetStopTime(m.slow, t + step);
  PetscCheck(!bad, motion.comm(), PETSC_ERR_LIB, "MRIStep refuses a step of %g s", step);
  double reached = t;
  const int ended = MRIStepEvolve(m.slow, t + step, m.state, &reached, ARK_ONE_STEP);
  PetscCall(m.failure);
  PetscCheck(ended >= 0, motion.comm(), PETSC_ERR_LIB, "MRIStepEvolve returned %d", ended);
  *taken = reached - t;
  PetscCall(motion.drag(reached, *taken, velocity_of(m.state)));
  PetscCall(motion.accept(reached, displacement_of(m.state), velocity_of(m.state)));
  statistics_.evaluations += std::exchange(m.fast_evaluations, 0);
  count(*taken, bounded_by(left, *taken));
  PetscFunctionReturn(0);
}

}  // namespace talus
