#include "simulation/changing_loads.h"

#include <algorithm>

namespace talus {

template <int dim>
std::vector<ChangingLoad> changing_loads(const World<dim> &world) {
  std::vector<ChangingLoad> loads;
  const auto add = [&](const std::string &key, double until) {
    if (until > Function::never) loads.push_back({key, until});
  };
  for (const std::vector<NamedBoundary> *sources : {&world.conditions.sources(), &world.seepage_sources})
    for (const NamedBoundary &source : *sources) add("boundary." + source.name, source.kind.last_change);
  add("water.level", world.scene.water.level.last_change());
  add("water.excess", world.scene.water.excess.last_change());
  for (const BodySource &body : world.scene.body) {
    double until = Function::never;
    for (const Function &component : body.body_acceleration) until = std::max(until, component.last_change());
    add("body." + body.name + ".body_acceleration", until);
  }
  return loads;
}

template std::vector<ChangingLoad> changing_loads<2>(const World<2> &);
template std::vector<ChangingLoad> changing_loads<3>(const World<3> &);

}  // namespace talus
