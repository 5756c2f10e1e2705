#pragma once
/// What retention curves share: they are written for the effective saturation S_e = (S - S_r) / (1 - S_r),
/// docs/theory/pores.md (1.1).
#include "base/units.h"

namespace talus {

struct ResidualWater {
  double residual_saturation = 0;  ///< S_r: water that suction does not draw out [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("residual_saturation", residual_saturation, one, Range{0, 0.9, {0, 0.5}},
             "residual degree of saturation at large suction");
  }
};

}  // namespace talus
