#pragma once
/// Fields that are constant in a cell, to be compared with a profile at its centre.
#include <map>

#include "tests/verify/rung.h"

namespace talus::rungs {

/// Means over the particles that shared a cell at the start, by the cell's number.
struct CellMeans {
  double y, value;
};
inline std::vector<CellMeans> cell_means(const Snapshot &s, const std::string &field, int dimension) {
  const int each = dimension == 2 ? 3 : 4;
  const auto y = component(s, "position", 1), value = component(s, field);
  std::map<long long, CellMeans> sums;
  for (size_t p = 0; p < y.size(); ++p) {
    CellMeans &mean = sums[s.id[p] / each];
    mean.y += y[p] / each, mean.value += value[p] / each;
  }
  std::vector<CellMeans> means;
  for (const auto &[cell, mean] : sums) means.push_back(mean);
  return means;
}

}  // namespace talus::rungs
