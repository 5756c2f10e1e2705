#pragma once
/// Thick cylinder under pressure p in its bore, radii a and b (compression positive; Yu 2000, Cavity Expansion Methods,
/// sec. 3.3). Inside the radius c soil yields, sigma_r = N sigma_theta + Y with N = (1 + sin phi) / (1 - sin phi), Y =
/// 2 c' cos phi / (1 - sin phi); equilibrium gives sigma_r + Y / (N - 1) ~ r^-(N - 1) / N. Outside it is Lame's
/// solution with the pressure p_c that brings r = c to yield:
///     p_c = Y (m - 1) / [(m - 1) + N (m + 1)], m = b^2 / c^2;  u(b) = 2 (1 - nu^2) p_c b / [E (m - 1)].
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_cylinder(Rung &rung) {
  constexpr double a = 1, b = 2, E = 100e6, nu = 0.3, cohesion = 20e3, N = 3;
  const double Y = 2 * cohesion * std::sqrt(N);
  const auto elastic_pressure = [&](double c) {
    return Y * (b * b / (c * c) - 1) / (b * b / (c * c) - 1 + N * (b * b / (c * c) + 1));
  };
  const auto bore_pressure = [&](double c) {
    return (elastic_pressure(c) + Y / (N - 1)) * std::pow(c / a, (N - 1) / N) - Y / (N - 1);
  };
  for (const double c : {1.3, 1.6}) {
    const double p = bore_pressure(c), p_c = elastic_pressure(c), m = b * b / (c * c);
    const Run run = rung.run({"boundary.bore.pressure=" + number(p) + " * t"});
    const auto x = component(run.end, "position", 0), y = component(run.end, "position", 1),
               volume = component(run.end, "volume");
    const auto ux = component(run.end, "displacement", 0), uy = component(run.end, "displacement", 1);
    const auto sxx = component(run.end, "stress", 0), syy = component(run.end, "stress", 1),
               sxy = component(run.end, "stress", 3);
    double square = 0, total = 0, moved = 0, weight = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      const double r = std::hypot(x[i], y[i]), cosine = x[i] / r, sine = y[i] / r;
      const double radial = -(sxx[i] * cosine * cosine + syy[i] * sine * sine + 2 * sxy[i] * sine * cosine);
      const double exact = r < c ? (p + Y / (N - 1)) * std::pow(a / r, (N - 1) / N) - Y / (N - 1)
                                 : p_c * (b * b / (r * r) - 1) / (m - 1);
      square += volume[i] * (radial - exact) * (radial - exact), total += volume[i];
      if (r < c) continue;  // Lame's displacement
      const double u = (1 + nu) * p_c / (E * (m - 1)) * ((1 - 2 * nu) * r + b * b / r);
      moved += volume[i] * ((ux[i] * cosine + uy[i] * sine) / u - 1), weight += volume[i];
    }
    const std::string which = "yielding to r = " + number(c);
    rung.compare(which + ": radial stress, L2 error over the pressure", 0, std::sqrt(square / total) / p, 0.01, 1);
    rung.compare(which + ": displacement of the elastic ring over Lame's", 1, 1 + moved / weight, 0.01);
  }
}

}  // namespace talus::rungs
