#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/units.h"

namespace talus {

/// Measured points (s, S), joined by monotone cubics: Fritsch & Carlson (1980), slopes by Fritsch & Butland (1984).
/// Below the first suction the soil is as wet as there; beyond the last one saturation falls on exponentially.
struct TabulatedRetention {
  static constexpr const char *name = "tabulated";
  static constexpr const char *meaning = "measured points joined by monotone cubics";
  static constexpr double residual_saturation = 0;
  std::vector<double> suctions, saturations;  ///< [Pa], [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("suctions", suctions, pascal, "suctions of the measured points, increasing; the first point is saturated");
    v.point("saturations", saturations, one, "degrees of saturation at these suctions, decreasing from 1");
  }
  std::string problem() const {
    if (suctions.size() < 2 || suctions.size() != saturations.size())
      return "give suctions and saturations of at least two points, as many of one as of the other";
    if (!(suctions[0] >= 0) || saturations[0] != 1)
      return "the first point must be saturated: suctions begins at 0 or above, saturations with 1";
    for (size_t i = 1; i < suctions.size(); ++i)
      if (!(suctions[i] > suctions[i - 1]) || !(saturations[i] < saturations[i - 1]) || !(saturations[i] > 0))
        return "the curve must be monotone, but point " + std::to_string(i + 1) +
               " is not: suctions must rise and saturations fall from point to point and stay above 0; average "
               "scattered measurements first";
    return "";
  }

  double effective(double s) const {
    if (s <= suctions[0]) return 1;
    const size_t last = suctions.size() - 1;
    if (s >= suctions[last])
      return saturations[last] * std::exp(tangent(last) / saturations[last] * (s - suctions[last]));
    const Piece p = piece(s);
    return p.a + p.r * p.h * p.ma +
           p.r * p.r * ((3 - 2 * p.r) * (p.b - p.a) - (2 - p.r) * p.h * p.ma - (1 - p.r) * p.h * p.mb);
  }
  double slope(double s) const {
    if (s <= suctions[0]) return 0;
    const size_t last = suctions.size() - 1;
    if (s >= suctions[last]) return tangent(last) / saturations[last] * effective(s);
    const Piece p = piece(s);
    return p.ma + p.r * ((6 - 6 * p.r) * (p.b - p.a) / p.h - (4 - 3 * p.r) * p.ma - (2 - 3 * p.r) * p.mb);
  }
  /// By bisection: curves are tabulated over saturation before the time loop.
  double suction(double wet, double) const {
    const size_t last = suctions.size() - 1;
    if (wet <= saturations[last])
      return suctions[last] + saturations[last] / tangent(last) * std::log(wet / saturations[last]);
    double low = suctions[0], high = suctions[last];
    for (int k = 0; k < 200 && low < high; ++k) {
      const double middle = (low + high) / 2;
      if (middle <= low || middle >= high) break;
      (effective(middle) > wet ? low : high) = middle;
    }
    return (low + high) / 2;
  }

 private:
  struct Piece {
    double h, r, a, b, ma, mb;  ///< length, place in it, values and slopes at its ends
  };
  double secant(size_t i) const { return (saturations[i + 1] - saturations[i]) / (suctions[i + 1] - suctions[i]); }
  double tangent(size_t i) const {  // weighted harmonic mean of the neighbouring secants
    if (i == 0) return secant(0);
    if (i + 1 == suctions.size()) return secant(i - 1);
    const double before = suctions[i] - suctions[i - 1], after = suctions[i + 1] - suctions[i];
    const double p = 2 * after + before, q = after + 2 * before;
    return (p + q) / (p / secant(i - 1) + q / secant(i));
  }
  Piece piece(double s) const {
    const size_t i = std::upper_bound(suctions.begin(), suctions.end(), s) - suctions.begin() - 1;
    const double h = suctions[i + 1] - suctions[i];
    return {h, (s - suctions[i]) / h, saturations[i], saturations[i + 1], tangent(i), tangent(i + 1)};
  }
};

}  // namespace talus
