#pragma once
/// The shear zone of a base that sliding heats, docs/theory (6.8)-(6.11): its keys, and heat and excess pore pressure
/// normal to the base at one place. The zone is symmetric about its middle, sheared uniformly, and lies in ground of
/// its own kind; temperature counts from that at the start, pressure from that which the scene gives. Sources:
/// Vardoulakis (2000), Mech. Cohes.-Frict. Mater. 5, 443-467; Rice (2006), J. Geophys. Res. 111, B05311.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/required.h"

namespace talus {

struct ShearZone {
  double thickness = required;
  double reach = 1;                          ///< [m] from the middle; the grid ends there
  double heat_capacity = 2.7e6;              ///< per volume [J/(m3 K)]
  double thermal_conductivity = 2;           ///< [W/(m K)]
  double hydraulic_conductivity = required;  ///< [m/s]
  double storage = required;                 ///< volume of water per volume of ground and pressure [1/Pa]
  double thermal_pressurisation = required;  ///< rise of pressure per rise of temperature, undrained [Pa/K]

  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("thickness", thickness, metre, Range{1e-6, 10, {1e-4, 1}},
             "thickness of the shear zone, which friction heats");
    v.number("reach", reach, metre, Range{1e-5, 1e3},
             "distance from the middle of the shear zone to which heat and excess pressure spread: there the ground is "
             "drained, and no heat passes");
    v.number("heat_capacity", heat_capacity, joule_per_cubic_metre_kelvin, Range{1e3, 1e9, {1e6, 5e6}},
             "heat capacity of the ground per volume, grains and water together");
    v.number("thermal_conductivity", thermal_conductivity, watt_per_metre_kelvin, Range{0, 1e4, {0.1, 10, or_zero}},
             "thermal conductivity of the ground");
    v.number("hydraulic_conductivity", hydraulic_conductivity, metre_per_second, Range{0, 1, {1e-14, 1e-3, or_zero}},
             "hydraulic conductivity of the ground for water of 9.81 kN/m3; 0: undrained");
    v.number("storage", storage, per_pascal, Range{1e-13, 1e-3, {1e-12, 1e-6}},
             "water that a volume of ground stores per pressure: compressibility of the pores plus porosity times that "
             "of water");
    v.number("thermal_pressurisation", thermal_pressurisation, pascal_per_kelvin, Range{0, 1e8, {1e4, 2e6, or_zero}},
             "increase of pore pressure per increase of temperature in undrained ground; 0: heat without effect");
  }
  /// What is wrong between the keys; empty: nothing.
  std::string problem() const {
    return reach < thickness ? "reach must not be less than the thickness of the shear zone" : "";
  }
  double thermal_diffusivity() const { return thermal_conductivity / heat_capacity; }
  double hydraulic_diffusivity() const { return hydraulic_conductivity / (unit_weight * storage); }  ///< [m2/s]
  /// Slip over which undrained adiabatic friction falls to 1/e, L* of Rice (2006) [m]; infinite without
  /// friction or expansion.
  double weakening_slip(double friction_coefficient) const {
    return heat_capacity * thickness / (thermal_pressurisation * friction_coefficient);
  }

  static constexpr double unit_weight = 9810;  ///< of water [N/m3]
};

/// Implicit finite volumes on a half of the zone and the ground beside it, uniform in the zone, then graded. The state
/// of a place is `size()` doubles: temperature rise [K] by cell, then excess pressure [Pa]. One grid serves all places
/// of a base: with the step it finds the factors of its systems once.
class ShearZoneGrid {
 public:
  explicit ShearZoneGrid(const ShearZone &zone);

  int size() const { return 2 * cells_; }
  /// Prepares steps of this length [s].
  void set_step(double step);
  /// Spreads heat and pressure over a step without a source.
  void spread(double *state);
  /// Adds a heat per area of base [J/m2] that friction has produced evenly over the zone and the step.
  void add_heat(double heat, double *state) const {
    for (int i = 0; i < 2 * cells_; ++i) state[i] += heat * answer_[i];
  }
  /// Mean excess pressure of the zone at the end of a step, per heat produced in it [Pa m2/J].
  double pressure_per_heat() const { return pressure_per_heat_; }

  double temperature(const double *state) const { return mean(state); }        ///< mean of the zone [K]
  double pressure(const double *state) const { return mean(state + cells_); }  ///< mean of the zone [Pa]
  double heat(const double *state) const;                                      ///< of both halves, per area [J/m2]

 private:
  /// A tridiagonal system: (width + conductances) x = width * source.
  struct System {
    std::vector<double> conductance;  ///< of the face behind a cell, diffusivity over distance; of the last to the end
    std::vector<double> inverse, above;  ///< of the pivots; step * conductance over pivot
  };
  void factorise(System &system, double step) const;
  void solve(const System &system, double *x) const;
  double mean(const double *field) const {
    double sum = 0;
    for (int i = 0; i < in_zone; ++i) sum += field[i];
    return sum / in_zone;
  }

  static constexpr int in_zone = 8;      // cells of a half
  static constexpr double growth = 1.2;  // from cell to cell beside it
  ShearZone zone_;
  int cells_ = 0;
  double step_ = 0, pressure_per_heat_ = 0;
  std::vector<double> width_;  ///< [m]
  System heat_, water_;
  std::vector<double> answer_;  ///< state that a heat of 1 J/m2 leaves at the end of its step
  std::vector<double> before_;
};

}  // namespace talus
