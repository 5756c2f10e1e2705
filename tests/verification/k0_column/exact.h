#pragma once
/// K0 column: smooth walls let no soil pass, so sigma_h = nu / (1 - nu) sigma_v, by the logarithmic strains also where
/// they are large. Given as initial stress this state is an equilibrium and stays.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void k0_column(Rung &rung) {
  constexpr double E = 1e6, nu = 0.3, rho = 2000, g = 10, height = 1, k0 = nu / (1 - nu),
                   base_stress = rho * g * height;
  constexpr double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)),
                   settlement = rho * g * height * height / (2 * modulus);
  const auto error = [&](const Run &run, int k) {  // components 0, 1, 2 of the stored stress are xx, yy, zz
    const auto y = component(run.end, "position", 1), u = component(run.end, "displacement", 1),
               stress = component(run.end, "stress", k), mass = component(run.end, "mass");
    double square = 0, total = 0;
    for (size_t p = 0; p < y.size(); ++p) {
      const double ds = stress[p] + (k == 1 ? 1 : k0) * rho * g * (height - (y[p] - u[p]));
      square += mass[p] * ds * ds, total += mass[p];
    }
    return std::sqrt(square / total) / base_stress;
  };
  for (const int dimension : {2, 3}) {
    const Run loaded = rung.run(in_dimension(dimension));
    for (const auto &[name, k] : {std::pair{"sigma_y", 1}, {"sigma_x", 0}, {"sigma_z", 2}})
      rung.compare(name_of(dimension) + " " + name + " by gravity, L2 error over base stress", 0, error(loaded, k),
                   0.01, 1);

    // the exact state as the initial one: moves only by what the mesh cannot represent of it
    const std::string vertical = "\"-20000 * (1 - y)\"", lateral = "\"-20000 * (1 - y) * 0.3 / 0.7\"", none = "\"0\"";
    const std::string shear = dimension == 2 ? none : none + ", " + none + ", " + none;
    const Run given = rung.run(in_dimension(
        dimension, {"body.soil.stress=[" + lateral + ", " + vertical + ", " + lateral + ", " + shear + "]",
                    "stage.0.gravity_ramp=0", "stage.0.damping=0", "stage.0.until=duration", "stage.0.duration=0.5"}));
    double moved = 0;
    for (int d = 0; d < dimension; ++d)
      for (const double u : component(given.end, "displacement", d)) moved = std::max(moved, std::abs(u));
    rung.compare(name_of(dimension) + " initial state, largest displacement over settlement", 0, moved / settlement,
                 0.01, 1);
  }
}

}  // namespace talus::rungs
