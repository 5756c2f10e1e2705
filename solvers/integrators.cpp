#include "solvers/integrators.h"

#include "scene/reader.h"

namespace talus {

IntegratorSettings read_integrator(DeferredTable &table, bool drag) {
  IntegratorSettings settings;
  read_one_of(table, "kind", settings);
  if (auto *arkode = std::get_if<ArkodeSettings>(&settings)) arkode->drag = drag;
  return settings;
}

std::string drag_problem(const IntegratorSettings &settings) {
  return std::visit(
      [](const auto &kind) {
        const std::string problem = kind.drag_problem();
        return problem.empty() ? problem : kind.name + (" " + problem);
      },
      settings);
}

std::unique_ptr<Integrator> make_integrator(const IntegratorSettings &settings) {
  return std::visit([](const auto &kind) -> std::unique_ptr<Integrator> { return kind.make(); }, settings);
}

StepRule step_rule(const IntegratorSettings &settings) {
  return std::visit([](const auto &kind) { return kind.rule(); }, settings);
}

}  // namespace talus
