#pragma once
/// The slice of tetrahedra that stands for plane strain.
#include <string>
#include <vector>

namespace talus {

/// Overrides that make a plane scene three-dimensional: a slice, held by rollers at its faces.
inline const std::vector<std::string> slice{"dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller"};

/// The overrides of a command, with those of its flag `--slice`.
inline std::vector<std::string> with_slice(bool wanted, std::vector<std::string> set) {
  if (wanted) set.insert(set.end(), slice.begin(), slice.end());
  return set;
}

inline constexpr const char *slice_meaning =
    "take a plane scene as a slice of tetrahedra, one cell thick between rollers; short for --set dimension=3 --set "
    "boundary.front.kind=roller --set boundary.back.kind=roller";

}  // namespace talus
