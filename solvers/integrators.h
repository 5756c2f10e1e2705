#pragma once
/// The list of integrators: one line to add one.
#include <memory>
#include <variant>

#include "scene/deferred.h"
#include "solvers/arkode.h"
#include "solvers/euler.h"
#include "solvers/forward_euler.h"
#include "solvers/petsc_ts.h"

namespace talus {

using IntegratorSettings = std::variant<EulerSettings, ArkodeSettings, ForwardEulerSettings, PetscTsSettings>;

/// `drag`: between the phases of the motion.
IntegratorSettings read_integrator(DeferredTable &table, bool drag);
/// Why an integrator cannot follow that drag; empty if it can.
std::string drag_problem(const IntegratorSettings &settings);
std::unique_ptr<Integrator> make_integrator(const IntegratorSettings &settings);
StepRule step_rule(const IntegratorSettings &settings);

}  // namespace talus
