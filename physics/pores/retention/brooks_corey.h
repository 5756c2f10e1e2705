#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/pores/retention/residual.h"
#include "scene/required.h"

namespace talus {

/// S_e = (P_e / s)^l beyond the air-entry suction P_e, 1 below it. Source: Brooks & Corey (1964), eq. (5).
struct BrooksCorey : ResidualWater {
  static constexpr const char *name = "brooks_corey";
  static constexpr const char *meaning = "retention curve with an air-entry suction, Brooks & Corey (1964)";
  double air_entry = required;        ///< P_e [Pa]
  double pore_size_index = required;  ///< l [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    ResidualWater::fields(v);
    v.number("air_entry", air_entry, pascal, Range{1, 1e9, {200, 1e7}}, "suction P_e at which air enters the pores");
    v.number("pore_size_index", pore_size_index, one, Range{0.05, 20, {0.1, 5}}, "exponent lambda");
  }

  double effective(double s) const { return s > air_entry ? std::pow(air_entry / s, pore_size_index) : 1; }
  double slope(double s) const {
    return s > air_entry ? -pore_size_index / s * std::pow(air_entry / s, pore_size_index) : 0;
  }
  double suction(double wet, double) const { return air_entry * std::pow(wet, -1 / pore_size_index); }
};

}  // namespace talus
