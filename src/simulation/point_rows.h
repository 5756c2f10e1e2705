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

  /// Quantities and units of the columns of one point.
  std::vector<std::pair<std::string, std::string>> columns() const;
  /// The columns of all points at a time [s], point by point; those of a point without soil are NaN: its
  /// particle is gone, or its body is not there. The
  /// acceleration is the change of velocity since the last call over the time since then, or since the call before that
  /// where the last one was a short while ago (less than half of the time between these two): the velocity of a single
  /// step tells nothing of a mean. It is zero in the first call, and in stages by finite elements. Collective, the same
  /// on all ranks.
  std::vector<double> at(double time, const Statics<dim> &statics);
  void serialize(Archive &archive) { archive.serialize("points", rows_, time_, velocities_, earlier_time_, earlier_); }

 private:
  const World<dim> &world_;
  TrackedPoints<dim> &points_;
  long long rows_ = 0;                        ///< calls since the start or the last stage by finite elements
  double time_ = 0, earlier_time_ = 0;        ///< of the last call, and of one before it [s]
  std::vector<double> velocities_, earlier_;  ///< of the points then [m/s]
};

}  // namespace talus
