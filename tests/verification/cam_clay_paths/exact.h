#pragma once
/// Triaxial compression of normally consolidated modified Cam-clay. With P = p' + a, eta = q / P and Lambda = (lambda -
/// kappa) / lambda, undrained P_0 / P = (1 + (eta / M)^2)^Lambda; drained P = 3 P_0 / (3 - eta) and v = v_0 - lambda
/// ln(P / P_0) - (lambda - kappa) ln(1 + (eta / M)^2) (Muir Wood 1990, ch. 5). Shear strain, from the flow rule d eps_q
/// / d eps_v = 2 eta / (M^2 - eta^2) along these paths, in README.md.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void cam_clay_paths(Rung &rung) {
  constexpr double M = 1, lambda = 0.2, kappa = 0.04, nu = 0.3, v0 = 2, a = 1, P0 = 100e3 + a;
  constexpr double Lambda = (lambda - kappa) / lambda, three_G_over_K = 9 * (1 - 2 * nu) / (2 * (1 + nu));
  const auto eta_of = [](const ElementState &s) { return s.deviator() / (s.mean_pressure() + a); };
  const auto first_at = [&](const std::vector<ElementState> &states, double eta) {
    size_t k = 0;
    while (k + 1 < states.size() && eta_of(states[k]) < eta) ++k;
    return k;
  };
  const auto name = [](const char *what, double eta) { return std::string(what) + " at q/p' = " + number(eta); };

  const auto undrained = rung.element_test("undrained");
  for (const double target : {0.5, 0.8, 0.95}) {
    const ElementState &s = undrained[first_at(undrained, target)];
    const double eta = eta_of(s), arc = std::atan(eta / M);
    const double p = P0 * std::pow(1 + eta * eta / (M * M), -Lambda) - a;
    rung.compare(name("undrained p' [Pa]", target), p, s.mean_pressure(), 1e-8);
    rung.compare(name("undrained u [Pa]", target), 100e3 + s.deviator() / 3 - p, s.pore_pressure, 1e-8);
    const double plastic = 2 * kappa * Lambda / (M * v0) * (std::atanh(eta / M) - arc);
    const double elastic = kappa / (three_G_over_K * v0) * (eta * (1 - 2 * Lambda) + 2 * Lambda * M * arc);
    rung.compare(name("undrained eps_q", target), plastic + elastic, -s.strain[1], 0.005);
  }

  const auto drained = rung.element_test("drained");
  const auto v_of = [](const ElementState &s) { return v0 * std::exp(-s.compression()); };
  const auto shear_of = [](const ElementState &s) { return 2. / 3 * (s.strain[0] - s.strain[1]); };
  double sheared = 0;  // integral of v d eps_q
  size_t k = 0;
  for (const double target : {0.5, 0.8, 0.95}) {
    for (const size_t to = first_at(drained, target); k < to; ++k)
      sheared += (v_of(drained[k]) + v_of(drained[k + 1])) / 2 * (shear_of(drained[k + 1]) - shear_of(drained[k]));
    const ElementState &s = drained[k];
    const double eta = eta_of(s), P = 3 * P0 / (3 - eta);
    rung.compare(name("drained p' [Pa]", target), P - a, s.mean_pressure(), 1e-8);
    rung.compare(name("drained v", target),
                 v0 - lambda * std::log(P / P0) - (lambda - kappa) * std::log1p(eta * eta / (M * M)), v_of(s), 1e-8);
    const double A = 6 / (M * M - 9), B = 1 / (3 - M),
                 C = -1 / (3 + M);  // of 2 eta / ((3 - eta)(M^2 - eta^2)) in partial fractions
    const double along = -A * std::log(1 - eta / 3) - B * std::log(1 - eta / M) + C * std::log1p(eta / M);
    const double plastic = (lambda - kappa) * (along + 2 / M * (std::atanh(eta / M) - std::atan(eta / M)));
    rung.compare(name("drained integral v d eps_q", target),
                 plastic - 3 * kappa / three_G_over_K * std::log(1 - eta / 3), sheared, 0.005);
  }
}

}  // namespace talus::rungs
