#pragma once
/// What each soil law costs by itself: the stress update of points that fit into the cache, beside the step of
/// bench.cpp.
#include <string>
#include <utility>
#include <vector>

namespace talus {

struct LawRate {
  std::string law;
  double plane = 0, solid = 0;  ///< [ns] per update of a point, in plane strain and in 3D
  double tangent = 0;           ///< [ns] with the consistent tangent, in 3D
};

/// Name and keys of a soil of every law and case of a law.
const std::vector<std::pair<std::string, std::string>> &bench_soils();

/// Measures every law and case of a law; half of the points yield or flow.
std::vector<LawRate> measure_laws();

}  // namespace talus
