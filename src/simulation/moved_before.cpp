#include "simulation/moved_before.h"

#include <algorithm>

#include "base/rounded.h"

namespace talus {

double elastic_settlement(const std::vector<BodyReport> &bodies, const std::vector<Law> &laws, double gravity,
                          int dimension, int up) {
  double stress = 0, compliance = 0;  // weight of all bodies per area [Pa]; thickness over stiffness [m/Pa]
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyReport &body = bodies[b];
    if (body.particles == 0) continue;
    double ground = 1;
    for (int d = 0; d < dimension; ++d)
      if (d != up) ground *= body.high[d] - body.low[d];
    const double thickness = std::min(body.high[up] - body.low[up], 2 * body.volume / ground);
    stress += gravity * body.mass / body.volume * thickness;
    compliance += thickness / constrained_modulus(laws[b]);
  }
  return stress * compliance;
}

std::string moved_before_reset(const std::string &stage, double largest, double elastic, double plastic) {
  constexpr double several = 3;
  if (!(largest > several * elastic)) return "";
  return "stage " + stage + " has moved soil by up to " + rounded(largest) +
         " m before displacements are set to zero; elastic soil of this weight and stiffness settles by " +
         rounded(elastic) + " m at most. It has slid or yielded" +
         (plastic > 0 ? ", and " + rounded(100 * plastic) + " % of it has a plastic strain above " +
                            rounded(100 * yielded) + " %"
                      : "") +
         ": what follows starts from there";
}

}  // namespace talus
