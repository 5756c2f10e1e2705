#include "simulation/changing_loads.h"

#include <utility>

namespace talus {

template <int dim>
std::vector<ChangingLoad> changing_loads(const World<dim> &world) {
  std::vector<ChangingLoad> loads;
  const auto add = [&](const std::string &key, std::vector<TimeSpan> when) {
    if (!when.empty()) loads.push_back({key, std::move(when)});
  };
  for (const std::vector<NamedBoundary> *sources : {&world.conditions.sources(), &world.seepage_sources})
    for (const NamedBoundary &source : *sources) add("boundary." + source.name, source.kind.changes);
  add("water.level", world.scene.water.level.changes());
  add("water.excess", world.scene.water.excess.changes());
  for (const BodySource &body : world.scene.body) {
    std::vector<TimeSpan> when;
    for (const Function &component : body.body_acceleration)
      for (const TimeSpan &span : component.changes()) when.push_back(span);
    add("body." + body.name + ".body_acceleration", when);
  }
  return loads;
}

template std::vector<ChangingLoad> changing_loads<2>(const World<2> &);
template std::vector<ChangingLoad> changing_loads<3>(const World<3> &);

}  // namespace talus
