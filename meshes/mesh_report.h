#pragma once
/// A background mesh in numbers, over all ranks.
#include <string>
#include <vector>

namespace talus {

struct MeshReport {
  long long cells, nodes;
  double smallest_altitude;               ///< [m]
  double smallest_quality, mean_quality;  ///< inscribed over circumscribed radius times dim, 1 is regular
  bool one_element_slice;                 ///< 3D, every node lies on one of two parallel planes z = const
  std::vector<std::string> remarks;       ///< sentences about what may be meant but rarely is, on rank 0
};

}  // namespace talus
