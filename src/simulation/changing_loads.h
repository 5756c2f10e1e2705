#pragma once
/// What a scene changes with time while its soil moves.
#include <array>
#include <string>
#include <vector>

#include "scene/function.h"

namespace talus {

struct Scene;

/// A load, a support or a strength that functions of time give.
struct ChangingLoad {
  std::string key;  ///< boundary.NAME, or the path of another key
  std::vector<TimeSpan> when;
};

/// All of a scene, in the order of its boundaries, water and bodies.
std::vector<ChangingLoad> changing_loads(const Scene &scene);

/// Times between `begin` and `end` at which steps have to end in order to see all that changes, ascending: where tables
/// bend, before expressions of time jump, and where these have changed by a quarter of their range, at one of three
/// places between the corners `low` and `high` of the soil [m]. A change of an expression that lasts for less than
/// 1/4000 of the time may be missed.
std::vector<double> load_events(const Scene &scene, const std::array<double, 3> &low, const std::array<double, 3> &high,
                                double begin, double end);

}  // namespace talus
