#pragma once
/// Local places of things that have global numbers.
#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

namespace talus {

class LocalNumbers {
 public:
  /// `global[i]` is the global number of local thing i.
  explicit LocalNumbers(const std::vector<long long> &global) {
    for (std::size_t i = 0; i < global.size(); ++i) sorted_.emplace_back(global[i], static_cast<int>(i));
    std::sort(sorted_.begin(), sorted_.end());
  }
  /// Throws std::runtime_error for a number that this rank does not have.
  int operator()(long long global) const {
    const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(global, 0));
    if (at == sorted_.end() || at->first != global)
      throw std::runtime_error("it has a row of something that this rank does not have");
    return at->second;
  }
  /// -1 for a number that this rank does not have.
  int find(long long global) const {
    const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(global, 0));
    return at == sorted_.end() || at->first != global ? -1 : at->second;
  }

 private:
  std::vector<std::pair<long long, int>> sorted_;
};

}  // namespace talus
