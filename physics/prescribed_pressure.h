#pragma once
/// Pore pressure as a prescribed function of place and time: hydrostatic below a water table whose level moves, plus an
/// excess (phase model `drained`); and how full of water the pores are, on which the weight depends. A soil may have
/// water of its own in the region that it fills at the start: a water table, or a share of the overburden. What seepage
/// has found stands in place of [water] where water flowed. Pressure is positive in compression.
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "base/vec.h"
#include "scene/function.h"
#include "scene/water_table.h"

namespace talus {

struct BodySource;
struct Scene;

/// Whose water: a number of a body, or that of the [water] table, which also stands above the ground.
inline constexpr int common_water = -1;

template <int dim>
class PrescribedPressure {
 public:
  /// The scene must outlive it.
  explicit PrescribedPressure(const Scene &scene);

  /// Says which soil fills each cell of this rank at the start; common_water where none does.
  void set_regions(std::vector<int> soil_of_cell) { soil_of_cell_ = std::move(soil_of_cell); }
  int soil_of(int cell) const { return soil_of_cell_[cell]; }

  bool below_table(const Vec<dim> &x, double t, int soil) const {
    const double p = found(x, soil);
    return std::isnan(p) ? x[vertical_] < table(x, t, soil) : p > 0;
  }
  /// Pore pressure at x [Pa].
  double operator()(const Vec<dim> &x, double t, int soil) const {
    const double elevation = table(x, t, soil), p = found(x, soil);
    if (!std::isnan(p)) return p;
    return std::max(0., unit_weight_ * (elevation - x[vertical_])) +
           (*excess_)(x[0], x[1], dim == 3 ? x[2] : 0, t, elevation);
  }
  /// Hydrostatic suction at x above the common water table; 0 without one [Pa].
  double above_table(const Vec<dim> &x, double t) const {
    return !table_->given() ? 0 : std::max(0., unit_weight_ * (x[vertical_] - table(x, t, common_water)));
  }
  /// Degree of saturation of a soil at x, where `soil` is whose water it has: full below the table; above it what
  /// seepage has left by the retention curve, or else what the body says [-].
  double saturation(const BodySource &body, const Vec<dim> &x, double t, int soil) const;
  /// Has the soil water of its own? Its pressure may then jump at the soil's border.
  bool apart(int soil) const { return soil >= 0 && (table_of_[soil]->given() || ratio_[soil]); }
  /// May pores fill or dry while the soil moves? What seepage has found stands still then.
  bool moves() const {
    const auto given = [](const WaterTable *table) { return table->given(); };
    return (table_->given() || std::any_of(table_of_.begin(), table_of_.end(), given)) && !level_->constant();
  }
  /// Degree of saturation of a body's soil at a place [-]; not a number where that is not known.
  using Saturation = std::function<double(const BodySource &, const double *)>;
  /// From now on the common pressure is that of `seeped` [Pa], but where that is not a number, and the saturation above
  /// the water table that of `saturation`; null: those of [water] and of the bodies again.
  void take(std::function<double(const double *)> seeped, Saturation saturation) {
    seeped_ = std::move(seeped), seeped_saturation_ = std::move(saturation);
  }
  /// The pressure of this soil is that of `ratio` [Pa], but where that is not a number.
  void take_of(int soil, std::function<double(const double *)> ratio) { ratio_[soil] = std::move(ratio); }
  bool open_water_load() const { return open_water_load_; }
  double density() const { return density_; }

 private:
  /// Elevation of the water table at x [m].
  double table(const Vec<dim> &x, double t, int soil) const {
    const WaterTable &table = soil >= 0 && table_of_[soil]->given() ? *table_of_[soil] : *table_;
    return table.given() ? table.at(x[0], x[1], dim == 3 ? x[2] : 0) + (*level_)(t) : -1e300;
  }
  /// What is not given by a table; no number where there is none.
  double found(const Vec<dim> &x, int soil) const {
    if (soil >= 0 && ratio_[soil]) return ratio_[soil](x.data());
    const bool own = soil >= 0 && table_of_[soil]->given();
    return seeped_ && !own ? seeped_(x.data()) : NAN;
  }

  const WaterTable *table_;          ///< of [water]
  const Function *level_, *excess_;  ///< likewise
  bool open_water_load_;
  double density_;  ///< [kg/m3]
  int vertical_;    ///< component of a place that is its elevation
  std::function<double(const double *)> seeped_;
  Saturation seeped_saturation_;
  double unit_weight_;
  std::vector<int> soil_of_cell_;
  std::vector<const WaterTable *> table_of_;                  ///< [body]
  std::vector<std::function<double(const double *)>> ratio_;  ///< [body]
};

}  // namespace talus
