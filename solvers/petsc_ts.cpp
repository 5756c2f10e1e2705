#include "solvers/petsc_ts.h"

#include <algorithm>
#include <utility>

#include "base/owned.h"

namespace talus {
namespace {

/// A method and the largest omega h at which its solution of y'' = -omega^2 y does not grow, tests/unit/solvers.
struct Method {
  const char *type;
  double limit;
};
constexpr Method methods[] = {{TSRK3, 1.7320508}, {TSRK4, 2.8284271}, {TSRK5BS, 1.664}, {TSRK8VR, 2.591}};
const Method &method_of(RungeKutta method) { return methods[static_cast<int>(method)]; }

}  // namespace

struct PetscTs::Memory {
  Owned<TS, TSDestroy> stepper;
  Vector state;  // [2 capacity] on each rank: u, then v, each `size()` long
  Motion *motion = nullptr;
  long long evaluations = 0;
  bool fresh = true;  // the state is the accepted one

  static PetscErrorCode rates(TS, PetscReal t, Vec y, Vec rate, void *self) {
    PetscFunctionBeginUser;
    Memory &m = *static_cast<Memory *>(self);
    const int size = m.motion->size();
    const double *state;
    double *out;
    ++m.evaluations;
    PetscCall(VecGetArrayRead(y, &state));
    PetscCall(VecGetArray(rate, &out));
    PetscCall(m.motion->rates(t, m.fresh ? nullptr : state, state + size, out, out + size));
    m.fresh = false;
    PetscCall(VecRestoreArray(rate, &out));
    PetscCall(VecRestoreArrayRead(y, &state));
    PetscFunctionReturn(0);
  }
};

PetscTs::PetscTs(const PetscTsSettings &settings) : settings_(settings), memory_(std::make_unique<Memory>()) {}
PetscTs::~PetscTs() = default;

StepRule PetscTsSettings::rule() const {
  return {step, fraction * method_of(method).limit / 2, method_of(method).limit / 2};
}
std::unique_ptr<Integrator> PetscTsSettings::make() const { return std::make_unique<PetscTs>(*this); }

PetscErrorCode PetscTs::advance(Motion &motion, double t, const StepBounds &bounds, double *taken) {
  PetscFunctionBeginUser;
  Memory &m = *memory_;
  const double step = step_length(settings_.rule(), t, bounds);
  const int size = motion.size();
  m.motion = &motion, m.fresh = true;
  if (!m.stepper) {
    PetscCall(VecCreateMPI(motion.comm(), 2 * motion.capacity(), PETSC_DETERMINE, m.state.create()));
    PetscCall(VecSet(m.state, 0));
    PetscCall(TSCreate(motion.comm(), m.stepper.create()));
    PetscCall(TSSetType(m.stepper, TSRK));
    PetscCall(TSRKSetType(m.stepper, method_of(settings_.method).type));
    PetscCall(TSSetRHSFunction(m.stepper, nullptr, Memory::rates, &m));
    TSAdapt adapt;
    PetscCall(TSGetAdapt(m.stepper, &adapt));
    PetscCall(TSAdaptSetType(adapt, TSADAPTNONE));
    PetscCall(TSSetExactFinalTime(m.stepper, TS_EXACTFINALTIME_STEPOVER));
    PetscCall(TSSetMaxSteps(m.stepper, PETSC_MAX_INT));
    PetscCall(TSSetMaxTime(m.stepper, 1e300));
    PetscCall(TSSetSolution(m.stepper, m.state));
  }
  double *y;
  PetscCall(VecGetArray(m.state, &y));
  std::fill_n(y, size, 0.);
  std::copy_n(motion.velocity(), size, y + size);
  PetscCall(VecRestoreArray(m.state, &y));
  PetscCall(TSSetTime(m.stepper, t));
  PetscCall(TSSetTimeStep(m.stepper, step));
  PetscCall(TSRestartStep(m.stepper));  // boundaries have changed the velocity since the last stage
  PetscCall(TSStep(m.stepper));
  PetscCall(VecGetArray(m.state, &y));
  PetscCall(motion.apply_boundaries_and_drag(t + step, step, y + size));
  PetscCall(motion.accept(t + step, y, y + size));
  PetscCall(VecRestoreArray(m.state, &y));
  *taken = step;
  statistics_.evaluations += std::exchange(m.evaluations, 0);
  count(step, bounded_by(bounds.until - t, step));
  PetscFunctionReturn(0);
}

}  // namespace talus
