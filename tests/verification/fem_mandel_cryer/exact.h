#pragma once
/// De Leeuw's problem (1965; Verruijt 2016, Theory and Problems of Poroelasticity, sec. 5.3): a cylinder of radius a in
/// plane strain under a radial load q at its drained rim, the plane form of Cryer's sphere. With m = lambda + 2 G, S =
/// n / K_l, c = (k / mu) / (1 / m + S): equilibrium makes m e = p + f(t) of the volume strain e, the load f (1 - G / m)
/// = -q + (2 G / m) P with P = int_0^1 p rho d rho, and the balance of water p_t + g f_t = c lap p with g = 1 / (1 + m
/// S). Laplace's transform and its residues then give
///     p / q = sum_j 2 g / (1 - G / m) [J_0(x_j rho) - J_0(x_j)] / [(1 + b / 2) x_j J_1(x_j) - b J_2(x_j)] exp(-x_j^2 c
///     t / a^2), (1 + b / 2) J_0(x) = b J_1(x) / x,   b = 2 g G / (m - G);
/// at first p = p_0 = q / [1 + S m (1 - G / m)] inside.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_mandel_cryer(Rung &rung) {
  constexpr double young = 10e6, porosity = 0.3, bulk = 2.2e9, viscosity = 1e-3, load = 10e3, k = 1e-15;
  const auto J = [](int n, double x) { return std::cyl_bessel_j(n, x); };
  for (const double nu : {0., 0.3}) {
    if (nu > 0 && !rung.longer()) break;
    const double G = young / (2 * (1 + nu)), m = young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), S = porosity / bulk;
    const double g = 1 / (1 + m * S), b = 2 * g * G / (m - G), c = k / viscosity / (1 / m + S);
    const auto root = [&](double x) { return (1 + b / 2) * J(0, x) - b * J(1, x) / x; };
    std::vector<double> roots;
    for (double x = 0.05; roots.size() < 60; x += 0.1) {
      double low = x, high = x + 0.1;
      if (root(low) * root(high) > 0) continue;
      for (int halving = 0; halving < 60; ++halving)
        (root(low) * root((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
      roots.push_back(low);
    }
    const auto pressure = [&](double rho, double T) {
      double sum = 0;
      for (double x : roots)
        sum += 2 * g / (1 - G / m) * (J(0, x * rho) - J(0, x)) / ((1 + b / 2) * x * J(1, x) - b * J(2, x)) *
               std::exp(-x * x * T);
      return load * sum;
    };
    for (const double T : {0.05, 0.2}) {
      const Run run = rung.run({"body.soil.poisson_ratio=" + number(nu), "stage.0.duration=" + number(T / c)});
      const auto p = component(run.end, "pore_pressure"), x = component(run.end, "position", 0),
                 y = component(run.end, "position", 1);
      double largest = 0, inside = 2;
      size_t centre = 0;
      for (size_t i = 0; i < p.size(); ++i) {
        const double rho = std::hypot(x[i], y[i]);
        largest = std::max(largest, std::abs(p[i] - pressure(rho, T)));
        if (rho < inside) inside = rho, centre = i;
      }
      const std::string name = "nu = " + number(nu) + ", T = " + number(T);
      rung.compare(name + ", largest error of p / q", 0, largest / load, 0.01, 1);
      rung.compare(name + ", p / q near the axis", pressure(inside, T) / load, p[centre] / load, 0.01);
    }
  }
}

}  // namespace talus::rungs
