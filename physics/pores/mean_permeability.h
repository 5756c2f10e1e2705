#pragma once
/// The mean of a relative permeability over a range of pressures, docs/theory/seepage.md (2.2): the conductivity of
/// soil whose pressure goes from one end of the range to the other (Kirchhoff 1894).
#include <vector>

#include "physics/pores/soil_pores.h"

namespace talus {

/// k_rl of a soil at a pressure [Pa], of which that below zero is suction; 1 in full pores.
double liquid_permeability_at(const SoilPores &soil, double pressure);

class MeanPermeability {
 public:
  explicit MeanPermeability(const SoilPores &soil);

  /// Mean of k_rl over all pressures between p and q [Pa], where it is `at_p` and `at_q`.
  double between(double p, double at_p, double q, double at_q) const;

 private:
  struct Sums {
    double below, above;  ///< integrals of k_rl over the suctions below, and above up to the largest of the table [Pa]
  };
  Sums sums(double suction) const;

  SoilPores soil_;
  std::vector<double> suction_, at_, below_, above_;  ///< of the table: suctions [Pa], k_rl, integrals [Pa]
};

}  // namespace talus
