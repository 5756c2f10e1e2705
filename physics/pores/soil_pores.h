#pragma once
/// The pores of one soil: its curves, tabulated over saturation, and its permeabilities (docs/theory/pores.md, sections
/// 1 and 2).
#include <string>

#include "physics/pores/octave_table.h"
#include "physics/pores/permeability.h"
#include "physics/pores/retention.h"

namespace talus {

struct BodySource;

class SoilPores {
 public:
  /// Reads curves and permeabilities of a body; `liquid` turns a hydraulic conductivity into a permeability with the
  /// weight of water `unit_weight` [N/m3] and its viscosity [Pa s]. A body without a retention curve has saturated
  /// pores only. Throws like the reader.
  SoilPores(const BodySource &body, double unit_weight, double liquid_viscosity);

  /// Suction and relative permeabilities at a degree of saturation S_l = 1 - `gas_share`.
  struct State {
    double suction;      ///< [Pa]
    double slope;        ///< ds / dS_g, S_g the gas share [Pa]
    double liquid, gas;  ///< k_rl, k_rg [-]
  };
  [[gnu::always_inline]] State at(double gas_share) const {
    const double dry = gas_share * inverse_range_, wet = 1 - dry;
    const bool is_wet = dry <= 0.5, beyond = dry < Table::smallest;
    const auto place = curves_.find(is_wet ? wet_end : dry_end, is_wet ? dry : wet);
    const double suction = curves_.value(place, 0), slope = curves_.slope(place, 0) * inverse_range_,
                 liquid = curves_.value(place, 1);
    return {beyond ? entry_ : suction, is_wet ? slope : -slope, is_wet || wet > 0 ? liquid : 0,
            curves_.value(place, 2)};
  }
  double suction(double gas_share) const { return at(gas_share).suction; }
  /// Largest suction that saturated soil bears [Pa].
  double entry() const { return entry_; }
  /// Largest gas share: what residual water leaves [-].
  double largest_gas_share() const { return 1 - residual_; }

  const Retention &retention() const { return retention_; }
  const RelativePermeability &relative() const { return relative_; }
  double porosity() const { return porosity_; }                  ///< n_0
  double permeability() const { return permeability_; }          ///< intrinsic, of the liquid, at n_0 [m2]
  double gas_permeability() const { return gas_permeability_; }  ///< of the gas [m2]
  double change(double n) const { return permeability_factor(change_, n, porosity_); }

 private:
  Retention retention_;
  RelativePermeability relative_;
  static constexpr int wet_end = 0, dry_end = 1;
  using Table = OctaveTable<3, 2>;
  Table curves_;  ///< suction, k_rl, k_rg over 1 - S_e and over S_e
  PermeabilityChange change_;
  double permeability_, gas_permeability_, porosity_, residual_ = 0, entry_ = 0, inverse_range_ = 1;
};

}  // namespace talus
