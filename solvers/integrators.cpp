#include "solvers/integrators.h"

#include "scene/reader.h"

namespace talus {

IntegratorSettings read_integrator(DeferredTable &table) {
  IntegratorSettings settings;
  read_one_of(table, "kind", settings);
  return settings;
}

std::unique_ptr<Integrator> make_integrator(const IntegratorSettings &settings) {
  return std::visit([](const auto &kind) -> std::unique_ptr<Integrator> { return kind.make(); }, settings);
}

StepRule step_rule(const IntegratorSettings &settings) {
  return std::visit([](const auto &kind) { return kind.rule(); }, settings);
}

}  // namespace talus
