#include "solvers/integrators.h"

#include "scene/reader.h"

namespace talus {

IntegratorSettings read_integrator(DeferredTable &table) {
  IntegratorSettings settings;
  read_one_of(table, "kind", settings);
  return settings;
}

std::unique_ptr<Integrator> make_integrator(const IntegratorSettings &) { return std::make_unique<Euler>(); }

}  // namespace talus
