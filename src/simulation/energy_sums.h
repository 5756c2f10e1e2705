#pragma once
/// Energies of all soil, and the work done to it since the start of the run, docs/theory (6.6). The same on all ranks.
#include <cmath>
#include <numeric>
#include <vector>

#include "physics/any_soil_motion.h"

namespace talus {

struct EnergySums {
  Balance balance;                  ///< its kinetic and its strain energy [J]
  double first = 0;                 ///< kinetic and strain energy at the start [J]
  double escaped = 0;               ///< kinetic energy of soil that was taken out, when it left [J]
  std::vector<double> of_boundary;  ///< work of each boundary [J]
  WorkDone work;                    ///< of the rest [J]

  /// Energy that was there or was brought, and that is not elastic: in motion, gone with soil, or dissipated [J].
  double not_stored() const {
    const double by_boundaries = std::accumulate(of_boundary.begin(), of_boundary.end(), 0.);
    return first + by_boundaries + work.gravity + work.imposed + work.damping - balance.strain;
  }
  double dissipated() const { return not_stored() - balance.kinetic - escaped; }
  /// Energy that was there or was brought, whatever its sign [J].
  double turnover() const {
    double sum = std::abs(first) + std::abs(work.gravity) + std::abs(work.imposed) + std::abs(work.damping);
    for (const double joules : of_boundary) sum += std::abs(joules);
    return sum;
  }
};

}  // namespace talus
