#pragma once
/// Pseudo-static earthquake, in stages in which soil moves or comes to rest.
#include <vector>

#include "base/units.h"

namespace talus {

struct SeismicKeys {
  std::vector<double> seismic_coefficient;  ///< inertia over weight, by axis [-]; empty: none
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("seismic_coefficient", seismic_coefficient, one, Usual{0, 0.6},
            "pseudo-static earthquake: inertia force over weight, one component per dimension, positive along the "
            "axes, such as [0.15, 0]; it acts on soil and pore water, and the water table stays where it is");
  }
};

}  // namespace talus
