#pragma once
/// What history.csv and the files of lines hold of tracked points: the fields of output_fields.h that are tracked, and
/// the mean acceleration since the row before.
#include <string>
#include <vector>

#include "simulation/statics.h"
#include "simulation/tracked_points.h"

namespace talus {

template <int dim>
class PointRows {
 public:
  /// The references must outlive it.
  PointRows(const World<dim> &world, TrackedPoints<dim> &points) : world_(world), points_(points) {}

  /// Names of the columns of one point, which begin with `prefix`.
  std::vector<std::string> names(const std::string &prefix) const;
  /// The columns of all points at a time [s], point by point; those of a point whose particle is gone are NaN. The
  /// acceleration is the change of velocity since the last call over the time since then; zero in the first one, and in
  /// stages by finite elements. Collective, the same on all ranks.
  std::vector<double> at(double time, const Statics<dim> &statics);
  void serialize(Archive &archive) { archive.serialize("points", time_, velocities_); }

 private:
  const World<dim> &world_;
  TrackedPoints<dim> &points_;
  double time_ = 0;                 ///< of the last call [s]
  std::vector<double> velocities_;  ///< of the points then [m/s]; empty: there was none
};

}  // namespace talus
