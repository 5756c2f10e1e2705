#include "simulation/changing_loads.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "physics/boundary/boundary.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/reader.h"
#include "scene/rigid_source.h"
#include "scene/scene.h"
#include "scene/water_source.h"

namespace talus {

std::vector<ChangingLoad> changing_loads(const Scene &scene) {
  std::vector<ChangingLoad> loads;
  const auto add = [&](const std::string &key, std::vector<TimeSpan> when) {
    if (!when.empty()) loads.push_back({key, std::move(when)});
  };
  for (const BoundarySource &source : scene.boundary)
    add("boundary." + source.name, read_boundary(source.kind).changes);
  add("water.level", scene.water->level.changes());
  add("water.excess", scene.water->excess.changes());
  for (const BodySource &body : scene.body) {
    std::vector<TimeSpan> when;
    for (const Function &component : body.body_acceleration)
      for (const TimeSpan &span : component.changes()) when.push_back(span);
    add("body." + body.name + ".body_acceleration", when);
  }
  for (const RigidSource &body : scene.rigid) {
    std::vector<TimeSpan> when;
    for (const auto *functions : {&body.velocity, &body.force})
      for (const Function &component : *functions)
        for (const TimeSpan &span : component.changes()) when.push_back(span);
    for (const TimeSpan &span : body.rotation.changes()) when.push_back(span);
    add("rigid." + body.name, when);
  }
  return loads;
}

namespace {

/// Values of an expression at a time, at the corners of the soil and between them.
std::array<double, 3> values_at(const Function &function, const std::array<double, 3> &low,
                                const std::array<double, 3> &high, double t) {
  std::array<double, 3> values;
  for (int k = 0; k < 3; ++k) {
    const auto at = [&](int d) { return low[d] + k * (high[d] - low[d]) / 2; };
    values[k] = function.unlimited(at(0), at(1), at(2), t, high[1]);
  }
  return values;
}
double change(const std::array<double, 3> &before, const std::array<double, 3> &now) {
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(now[k] - before[k]));
  return most;
}

}  // namespace

std::vector<double> load_events(const Scene &scene, const std::array<double, 3> &low, const std::array<double, 3> &high,
                                double begin, double end) {
  constexpr int samples = 4000, halvings = 40;
  constexpr double visible = 0.25;  // of the range of an expression
  std::vector<double> events;
  for (const ChangingLoad &load : changing_loads(scene))
    for (const TimeSpan &span : load.when) events.push_back(span.begin), events.push_back(span.end);
  scene.root->each_expression([&](const Function &function) {
    if (!function.uses("t")) return;
    const auto time = [&](int k) { return begin + (end - begin) * k / samples; };
    std::vector<std::array<double, 3>> values;
    std::array<double, 3> least, most;
    for (int k = 0; k <= samples; ++k) {
      values.push_back(values_at(function, low, high, time(k)));
      if (k == 0) least = most = values[0];
      for (int j = 0; j < 3; ++j)
        least[j] = std::min(least[j], values[k][j]), most[j] = std::max(most[j], values[k][j]);
    }
    const double much = visible * change(least, most);
    double changed = 0;
    for (int k = 1; k <= samples && much > 0; ++k) {
      const double here = change(values[k - 1], values[k]);
      changed += here;
      if (!(changed > much)) continue;
      changed = 0;
      double before = time(k - 1), after = time(k);
      if (here > much)  // it may jump: the step before ends as late as it can
        for (int half = 0; half < halvings; ++half) {
          const double middle = (before + after) / 2;
          const auto there = values_at(function, low, high, middle);
          (change(values[k - 1], there) > here / 2 ? after : before) = middle;
        }
      events.push_back(here > much ? before : after);
    }
  });
  std::erase_if(events, [&](double t) { return !(t > begin && t < end); });
  std::sort(events.begin(), events.end());
  events.erase(std::unique(events.begin(), events.end()), events.end());
  return events;
}

}  // namespace talus
