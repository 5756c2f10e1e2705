#pragma once
/// What differs between SUNDIALS 6.4 (Debian 12) and 7.1 (Debian 13). Talus uses the names of version 7.
#include <arkode/arkode_arkstep.h>
#include <mpi.h>
#include <sundials/sundials_version.h>

#if SUNDIALS_VERSION_MAJOR >= 7
#include <sundials/sundials_adaptcontroller.h>
#else
inline constexpr auto ARKodeEvolve = ARKStepEvolve;
inline constexpr auto ARKodeFree = ARKStepFree;
inline constexpr auto ARKodeGetEstLocalErrors = ARKStepGetEstLocalErrors;
inline constexpr auto ARKodeGetNonlinearSystemData = ARKStepGetNonlinearSystemData;
inline constexpr auto ARKodeGetNumErrTestFails = ARKStepGetNumErrTestFails;
inline constexpr auto ARKodeReset = ARKStepReset;
inline constexpr auto ARKodeSetCFLFraction = ARKStepSetCFLFraction;
inline constexpr auto ARKodeSetDeduceImplicitRhs = ARKStepSetDeduceImplicitRhs;
inline constexpr auto ARKodeSetFixedStep = ARKStepSetFixedStep;
inline constexpr auto ARKodeSetFixedStepBounds = ARKStepSetFixedStepBounds;
inline constexpr auto ARKodeSetInitStep = ARKStepSetInitStep;
inline constexpr auto ARKodeSetInterpolantDegree = ARKStepSetInterpolantDegree;
inline constexpr auto ARKodeSetInterpolantType = ARKStepSetInterpolantType;
inline constexpr auto ARKodeSetMaxErrTestFails = ARKStepSetMaxErrTestFails;
inline constexpr auto ARKodeSetMaxHnilWarns = ARKStepSetMaxHnilWarns;
inline constexpr auto ARKodeSetMaxNumSteps = ARKStepSetMaxNumSteps;
inline constexpr auto ARKodeSetMinStep = ARKStepSetMinStep;
inline constexpr auto ARKodeSetNonlinearSolver = ARKStepSetNonlinearSolver;
inline constexpr auto ARKodeSetPostprocessStepFn = ARKStepSetPostprocessStepFn;
inline constexpr auto ARKodeSetStabilityFn = ARKStepSetStabilityFn;
inline constexpr auto ARKodeSetStopTime = ARKStepSetStopTime;
inline constexpr auto ARKodeSetUserData = ARKStepSetUserData;
inline constexpr auto ARKodeWFtolerances = ARKStepWFtolerances;
#endif

namespace talus::sundials {

inline int create_context(MPI_Comm comm, SUNContext *context) {
#if SUNDIALS_VERSION_MAJOR >= 7
  return SUNContext_Create(comm, context);
#else
  return SUNContext_Create(&comm, context);
#endif
}

/// Keeps ARKODE from printing its errors: Talus reports them itself.
inline int silence([[maybe_unused]] void *solver, [[maybe_unused]] SUNContext context) {
#if SUNDIALS_VERSION_MAJOR >= 7
  const int failed = SUNContext_ClearErrHandlers(context);
  return failed |
         SUNContext_PushErrHandler(
             context, [](int, const char *, const char *, const char *, SUNErrCode, void *, SUNContext) {}, nullptr);
#else
  return ARKStepSetErrHandlerFn(
      solver, [](int, const char *, const char *, char *, void *) {}, nullptr);
#endif
}

/// Chooses the step after one of length h [s], whose error is e tolerances.
class StepControl {
 public:
  using Next = double (*)(double h, double e, void *data);

  StepControl(Next next, void *data) : next_(next), data_(data) {}
  StepControl(const StepControl &) = delete;
  StepControl &operator=(const StepControl &) = delete;

#if SUNDIALS_VERSION_MAJOR >= 7
  ~StepControl() { release(); }
  int give_to(void *solver, SUNContext context) {
    controller_ = SUNAdaptController_NewEmpty(context);
    if (!controller_) return -1;
    controller_->content = this;
    controller_->ops->gettype = [](SUNAdaptController) { return SUN_ADAPTCONTROLLER_H; };
    controller_->ops->estimatestep = [](SUNAdaptController controller, double h, int, double e, double *next) {
      const StepControl &self = *static_cast<StepControl *>(controller->content);
      *next = self.next_(h, e, self.data_);
      return 0;
    };
    return ARKodeSetAdaptController(solver, controller_);
  }
  /// To be called after the solver and before the context are freed.
  void release() {
    if (controller_) SUNAdaptController_DestroyEmpty(controller_);
    controller_ = nullptr;
  }

 private:
  SUNAdaptController controller_ = nullptr;
#else
  int give_to(void *solver, SUNContext) {
    const int failed = ARKStepSetErrorBias(solver, 1);  // version 7 hands over the error itself
    return failed | ARKStepSetAdaptivityFn(
                        solver,
                        [](N_Vector, double, double h, double, double, double e, double, double, int, int, double *next,
                           void *control) {
                          const StepControl &self = *static_cast<StepControl *>(control);
                          *next = self.next_(h, e, self.data_);
                          return 0;
                        },
                        this);
  }
  void release() {}

 private:
#endif
  Next next_;
  void *data_;
};

}  // namespace talus::sundials
