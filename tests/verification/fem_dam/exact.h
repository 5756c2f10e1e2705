#pragma once
/// Steady flow through a dam with vertical faces on an impermeable base (Dupuit 1863; exact by Charny's proof,
/// Polubarinova-Kochina 1962, sec. VII.1): Q = k (h_1^2 - h_2^2) / (2 L). The proof carries over to soil that conducts
/// above the water table too: with Phi(p) the integral of k_r over pressure, the flux int q_x dy is the same at every
/// x, so that
///     Q L = (k / gamma) int_0^H [Phi(p(0, y)) - Phi(p(L, y))] dy,
/// and with k_r = exp(p / p_0) in suction, Phi = p_0 exp(p / p_0) there and p_0 + p under pressure. Along the upstream
/// face suction grows with height as at rest to the second order; the seepage face ends at y_e, so that
///     Q L = k [(h_1^2 - h_2^2) / 2 + (p_0 / gamma) (h_1 - y_e)] within (p_0 / gamma)^2.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_dam(Rung &rung) {
  constexpr double k = 1e-5, gamma = 9810, before = 4, behind = 1, width = 4;
  const auto discharge = [&](double decay, const std::string &more, double *exit, double *lost) {
    const std::string curve = number(decay * gamma);
    const Run run = rung.run(
        {"body.soil.retention.decay_suction=" + curve, "body.soil.relative_permeability.decay_suction=" + curve, more});
    const auto p = component(run.end, "pore_pressure"), x = component(run.end, "position", 0),
               y = component(run.end, "position", 1);
    *exit = behind;
    for (size_t i = 0; i < p.size(); ++i)
      if (x[i] > width - 0.1 && p[i] > 0) *exit = std::max(*exit, y[i]);
    const double in = run.history.column("upstream_inflow_m3_s").back(),
                 out = -run.history.column("downstream_inflow_m3_s").back();
    *lost = in - out;
    return in;
  };
  double exit, lost;
  for (const double decay : {0.1, 0.03}) {
    const double found = discharge(decay, "mesh.size=0.15", &exit, &lost);
    const double exact = k * ((before * before - behind * behind) / 2 + decay * (before - exit)) / width;
    const std::string name = "fringe of " + number(decay) + " m";
    rung.compare(name + ": discharge, m2/s", exact, found, 0.01);
    rung.report(name + ": discharge, of Dupuit's", 1, found * width / (k * (before * before - behind * behind) / 2));
    rung.compare(name + ": what goes in and does not come out", 0, lost, 1e-5, exact);
    rung.report(name + ": end of the seepage face, m", behind, exit);
  }
  // the same flow gives a drained scene its pressure, without suction; particles that carry water share what their cell
  // has of it, others do not
  const auto moving = component(rung.run({}).end, "pore_pressure"),
             given = component(rung.run({"phases=drained"}).end, "pore_pressure");
  double square = 0;
  for (size_t i = 0; i < given.size(); ++i) square += std::pow(given[i] - std::max(0., moving[i]), 2) / given.size();
  rung.compare("drained: pressure against that of the particles' own water, root mean square", 0, std::sqrt(square),
               0.01, gamma * before);
}

}  // namespace talus::rungs
