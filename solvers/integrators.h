#pragma once
/// The list of integrators: one line to add one.
#include <memory>
#include <variant>

#include "scene/deferred.h"
#include "solvers/arkode.h"
#include "solvers/euler.h"
#include "solvers/forward_euler.h"

namespace talus {

using IntegratorSettings = std::variant<EulerSettings, ArkodeSettings, ForwardEulerSettings>;

IntegratorSettings read_integrator(DeferredTable &table);
std::unique_ptr<Integrator> make_integrator(const IntegratorSettings &settings);
StepRule step_rule(const IntegratorSettings &settings);

}  // namespace talus
