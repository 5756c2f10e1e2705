#pragma once
/// Steady states of a column of 1 m, one for each kind of boundary, and one that swings: dp/dy = -gamma (1 - q / k_h)
/// for a flux q downwards; below a pressure p_0 sin(w t), p = Im[p_0 exp(i w t) cosh(c (H - z)) / cosh(c H)] with c^2 =
/// i w / c_v. All water that passes is in the balance.
#include <algorithm>
#include <cmath>
#include <complex>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void pore_boundaries(Rung &rung) {
  constexpr double gamma = 1e4, conductivity = 1e-3, modulus = 10e6, porosity = 0.4, bulk = 20e6;
  int dimension = 2;
  using Overrides = std::vector<std::string>;
  const auto boundary = [](const std::string &name, const std::string &group, const std::string &kind,
                           const std::string &key = "", const std::string &value = "") {
    Overrides all{"boundary." + name + ".kind=" + kind, "boundary." + name + ".group=" + group};
    if (!key.empty()) all.push_back("boundary." + name + "." + key + "=" + value);
    return all;
  };
  const auto join = [](Overrides a, const Overrides &b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  /// Compares a pressure profile p(y), by Darcy's law also the flux, and the balance of water. With a flux [m/s] that
  /// is not negative the state is steady: what is stored no longer changes, measured by that flux or by k_h. No result
  /// shows the discharge through one boundary, so it is not compared.
  const auto expect = [&](const std::string &kind, const Overrides &overrides, const std::string &field, auto &&exact,
                          double scale, double flux, double tolerance = 0.01) {
    const std::string name = name_of(dimension) + " " + kind;
    const Run run = rung.run(in_dimension(dimension, overrides));
    const double area = dimension == 3 ? 0.3 * 0.1 : 0.3;  // of the section
    double square = 0, count = 0;
    for (const CellMeans &cell : cell_means(run.end, field, dimension))
      square += std::pow(cell.value - exact(cell.y), 2), ++count;
    rung.compare(name + ", rms error of the pressure", 0, std::sqrt(square / count), tolerance, scale);
    const auto water = run.history.column("water_kg"), out = run.history.column("water_out_kg"),
               error = run.history.column("water_error_kg"), time = run.history.column("time_s");
    const size_t last = out.size() - 1, before = last - 1;
    if (flux >= 0)
      rung.compare(name + ", change of the stored water over the flux", 0,
                   (water[last] - water[before]) / (time[last] - time[before]) / 1000 / area, 0.01,
                   std::max(flux, conductivity));
    rung.compare(name + ", water error over water", 0, std::abs(error[last]), 1e-10, water.front());
  };
  const auto still = [&](double y) { return gamma * (1 - y); };

  for (dimension = 2; dimension <= (rung.longer() ? 3 : 2); ++dimension) {
    expect(
        "flux",
        join(boundary("top", "load", "flux", "inflow", "2e-4 * min(1, t)"),
             boundary("bottom", "base", "pore_pressure", "pressure", "1e4")),
        "pore_pressure", [&](double y) { return gamma - gamma * (1 - 0.2) * y; }, gamma, 2e-4);
    expect(
        "head and seepage face",
        join(boundary("top", "load", "rainfall", "intensity", "0"),
             boundary("bottom", "base", "head", "level", "1 + 0.5 * min(1, t)")),
        "pore_pressure", [&](double y) { return 1.5 * gamma * (1 - y); }, gamma, 5e-4);
    expect(
        "rain that ponds",
        join(boundary("top", "load", "rainfall", "intensity", "3e-3"),
             boundary("bottom", "base", "pore_pressure", "pressure", "0")),
        "pore_pressure", [&](double) { return 0.; }, gamma, conductivity);
    expect(
        "rain that does not pond",
        join(boundary("top", "load", "rainfall", "intensity", "5e-4"),
             boundary("bottom", "base", "pore_pressure", "pressure", "0")),
        "pore_pressure", [&](double y) { return -0.5 * gamma * y; }, gamma, 5e-4);
    expect("impermeable", boundary("top", "load", "impermeable"), "pore_pressure", still, gamma, 0);
    expect(
        "suction",
        Overrides(join(boundary("bottom", "base", "suction", "suction", "2e3 + 3e3 * min(1, t)"),
                       {"phases=unsaturated", "body.soil.hydraulic_conductivity=0.1", "water.suction=2e3 + 1e4 * y",
                        "water.table=[[0, -1], [1, -1]]", "stage.0.duration=12"})),
        "suction", [&](double y) { return 5e3 + gamma * y; }, gamma, 0);
    // p_0 sin(w t) on top for two periods and a quarter
    const double c_v = conductivity / gamma / (1 / modulus + porosity / bulk), period = 2;
    const std::complex<double> rate = std::sqrt(std::complex<double>(0, 2 * M_PI / period / c_v));
    const double end = 2.25 * period;
    expect(
        "pressure that swings",
        join(boundary("top", "load", "pore_pressure", "pressure", "1e3 * sin(pi * t)"),
             {"gravity=0", "water.table=[[0, -1], [1, -1]]", "stage.0.duration=" + number(end), "stage.0.damping=0"}),
        "pore_pressure",
        [&](double y) {
          return 1e3 * std::imag(std::exp(std::complex<double>(0, M_PI * end)) * std::cosh(rate * y) / std::cosh(rate));
        },
        1e3, -1);
  }
}

}  // namespace talus::rungs
