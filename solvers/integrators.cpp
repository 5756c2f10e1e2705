#include "solvers/integrators.h"

#include "scene/reader.h"

namespace talus {

namespace {

/// Refuses keys that a fixed step leaves without effect, and those that only a fixed step has.
void refuse_idle_keys(const TableReader &table, bool fixed) {
  const auto refuse = [&](const char *key, const std::string &why) {
    if (table.has(key)) table.complain(key, "has no effect " + why);
  };
  if (fixed)
    for (const char *key : {"fraction", "velocity_tolerance", "displacement_tolerance", "floor"})
      refuse(key, "beside a fixed step: leave it out, or leave `step` out");
  else
    refuse("limit", "without a fixed step: give `step`, or leave it out");
}

}  // namespace

IntegratorSettings read_integrator(DeferredTable &table, bool drag) {
  IntegratorSettings settings;
  read_one_of(table, "kind", settings);
  if (table.reader) refuse_idle_keys(*table.reader, step_rule(settings).fixed > 0);
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
