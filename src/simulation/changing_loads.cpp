#include "simulation/changing_loads.h"

#include <utility>

#include "physics/boundary/boundary.h"

namespace talus {

std::vector<ChangingLoad> changing_loads(const Scene &scene) {
  std::vector<ChangingLoad> loads;
  const auto add = [&](const std::string &key, std::vector<TimeSpan> when) {
    if (!when.empty()) loads.push_back({key, std::move(when)});
  };
  for (const BoundarySource &source : scene.boundary)
    add("boundary." + source.name, read_boundary(source.kind).changes);
  add("water.level", scene.water.level.changes());
  add("water.excess", scene.water.excess.changes());
  for (const BodySource &body : scene.body) {
    std::vector<TimeSpan> when;
    for (const Function &component : body.body_acceleration)
      for (const TimeSpan &span : component.changes()) when.push_back(span);
    add("body." + body.name + ".body_acceleration", when);
  }
  return loads;
}

}  // namespace talus
