#pragma once
/// The part of the soil whose strength is divided in a search for the factor of safety.
#include <vector>

#include "base/vec.h"

namespace talus {

struct FactorSource;

/// Cracks in the soil above a line, and the water in them.
class TensionCrack {
 public:
  explicit TensionCrack(const FactorSource &search);
  bool given() const { return !line_.empty(); }
  bool wet() const;
  /// Is a point above the line?
  bool reaches(double x, double elevation) const;
  /// By how much water stands above a point in a crack [m].
  double head(double elevation) const;

 private:
  std::vector<Vec<2>> line_;
  double water_;  ///< [m]
};

class SearchRegion {
 public:
  explicit SearchRegion(const FactorSource &search);
  /// Is it all of the soil?
  bool everywhere() const { return polygon_.empty() && line_.empty(); }
  /// Is a point in it, in an element of this size [m]? The polygon and the band hold across the whole width of a 3D
  /// soil; with both a point has to be in both.
  bool holds(double x, double elevation, double size) const;

 private:
  std::vector<Vec<2>> polygon_, line_;
  double width_;  ///< of the band on the line [m]; 0: two cells
};

}  // namespace talus
