#pragma once
/// Pore pressure as a prescribed function of place and time: hydrostatic below a water table whose level moves, plus an
/// excess (phase model `drained`); what seepage has found stands in place of both where water flowed. Pressure is
/// positive in compression.
#include <cmath>
#include <functional>
#include <utility>

#include "base/vec.h"
#include "scene/scene.h"

namespace talus {

template <int dim>
class PrescribedPressure {
 public:
  /// `gravity` is its magnitude along -y [m/s2].
  PrescribedPressure(const Water &water, double gravity) : water_(&water), unit_weight_(water.density * gravity) {}

  /// Elevation of the water table at x [m].
  double table(double x, double t) const {
    const auto &points = water_->table;
    if (points.empty()) return -1e300;
    size_t k = 1;
    while (k + 1 < points.size() && points[k][0] < x) ++k;
    const double level = water_->level(t);
    if (points.size() == 1) return points[0][1] + level;
    const double s = std::clamp((x - points[k - 1][0]) / (points[k][0] - points[k - 1][0]), 0., 1.);
    return points[k - 1][1] + s * (points[k][1] - points[k - 1][1]) + level;
  }
  bool below_table(const Vec<dim> &x, double t) const {
    const double p = seeped(x);
    return std::isnan(p) ? x[1] < table(x[0], t) : p > 0;
  }
  /// Pore pressure at x [Pa].
  double operator()(const Vec<dim> &x, double t) const {
    const double elevation = table(x[0], t), p = seeped(x);
    if (!std::isnan(p)) return p;
    return std::max(0., unit_weight_ * (elevation - x[1])) +
           water_->excess(x[0], x[1], dim == 3 ? x[2] : 0, t, elevation);
  }
  /// Hydrostatic suction at x above the water table; 0 without one [Pa].
  double above_table(const Vec<dim> &x, double t) const {
    return water_->table.empty() ? 0 : std::max(0., unit_weight_ * (x[1] - table(x[0], t)));
  }
  /// May pores fill or dry while the soil moves? What seepage has found stands still then.
  bool moves() const { return !water_->table.empty() && !water_->level.constant(); }
  /// From now on the pressure is that of `seeped` [Pa], but where that is not a number; null: that of [water] again.
  void take(std::function<double(const double *)> seeped) { seeped_ = std::move(seeped); }
  bool open_water_load() const { return water_->open_water_load; }
  double density() const { return water_->density; }

 private:
  double seeped(const Vec<dim> &x) const { return seeped_ ? seeped_(x.data()) : NAN; }

  const Water *water_;
  std::function<double(const double *)> seeped_;
  double unit_weight_;
};

}  // namespace talus
