#pragma once
/// The list of integrators: one line to add one.
#include <memory>
#include <variant>

#include "scene/deferred.h"
#include "solvers/euler.h"

namespace talus {

using IntegratorSettings = std::variant<EulerSettings>;

IntegratorSettings read_integrator(DeferredTable &table);
std::unique_ptr<Integrator> make_integrator(const IntegratorSettings &settings);

}  // namespace talus
