#pragma once
#include <string>
#include <vector>

#include "base/units.h"
#include "physics/boundary/kind.h"

namespace talus {

/// Dashpots that absorb waves arriving at a right angle to the face: rho c_p across it, rho c_s along it (Lysmer &
/// Kuhlemeyer 1969). Dashpots bear no load at rest. In quasi-static stages and in those that freeze loads
/// (`hold_loads`) a support stands in for them, and its reaction at the end of the stage remains as a dead load.
/// Their other end may move as the outcrop of the rock beyond the face: an upgoing wave of half of this motion then
/// comes in through them (Joyner & Chen 1975).
struct NonReflecting {
  static constexpr const char *name = "non_reflecting";
  static constexpr OnSoil in_motion = OnSoil::dashpot, quasi_static = OnSoil::support;
  static constexpr OnWater water = OnWater::surface;
  static constexpr OnGas gas = OnGas::surface;
  static constexpr int precedence = 2;
  enum class Support { roller, fixed, none };
  Support support = Support::roller;
  bool incoming_wave = false;
  double density = 0, shear_wave_speed = 0, compression_wave_speed = 0;  ///< beyond the face; 0: those of the soil
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice("support", support, {{"roller", Support::roller}, {"fixed", Support::fixed}, {"none", Support::none}},
             "support of the face in quasi-static stages and in stages with hold_loads = true; its reaction at their "
             "end acts as a dead load from then on");
    v.flag("incoming_wave", incoming_wave,
           "in stages with earthquake = true a wave comes in through the face whose motion at an outcrop, where it is "
           "doubled, is that of [[earthquake]]");
    v.number("density", density, kilogram_per_cubic_metre, Range{0, 1e4, {1500, 3500, or_zero}},
             "density of the rock beyond the face; 0: rock and soil are the same");
    v.number("shear_wave_speed", shear_wave_speed, metre_per_second, Range{0, 1e4},
             "speed of shear waves in this rock");
    v.number("compression_wave_speed", compression_wave_speed, metre_per_second, Range{0, 1e4},
             "speed of compression waves in this rock");
  }
  std::string problem() const {
    const int given = (density > 0) + (shear_wave_speed > 0) + (compression_wave_speed > 0);
    return given % 3 ? "density, shear_wave_speed and compression_wave_speed describe rock together: give all or none"
                     : "";
  }

  /// Of the support that stands in for the dashpots.
  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &normal) const {
    if (support == Support::none) return {};
    if (support == Support::roller) return {normal};
    return all_axes<dim>();
  }
  template <int dim>
  Square<dim> dashpot(const std::array<double, 2> &of_soil, const Vec<dim> &n) const {
    const std::array<double, 2> impedance =
        density > 0 ? std::array{density * compression_wave_speed, density * shear_wave_speed} : of_soil;
    return absorbing<dim>(impedance, n);
  }
};

}  // namespace talus
