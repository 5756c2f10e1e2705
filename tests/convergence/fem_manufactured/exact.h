#pragma once
/// Manufactured equilibrium of an elastic unit square or cube: u_i = a_i S, S the product of sin(pi x_j). With c_i S
/// the product in which cos(pi x_i) stands for sin(pi x_i), and c_ij S the same for two, div sigma + rho b = 0 asks for
///     rho b_i = pi^2 [(lambda + mu) (a_i S - sum_{j != i} a_j c_ij S) + dim mu a_i S].
#include <array>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_manufactured(Rung &rung) {
  constexpr double E = 1e6, nu = 0.3, rho = 1000, pi = 3.14159265358979323846;
  constexpr double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  constexpr std::array<double, 3> a{1e-3, -0.7e-3, 0.5e-3};
  const char axis[] = "xyz";
  const auto load = [&](int dim) {
    std::string all;
    for (int i = 0; i < dim; ++i) {
      std::string S = "1", sum;
      for (int j = 0; j < dim; ++j) S += std::string(" * sin(pi * ") + axis[j] + ")";
      for (int j = 0; j < dim; ++j) {
        if (j == i) continue;
        sum += " + (" + number(a[j]) + ")";
        for (int k = 0; k < dim; ++k)
          sum += std::string(k == i || k == j ? " * cos" : " * sin") + "(pi * " + axis[k] + ")";
      }
      all += std::string(i ? ", " : "[") + "\"pi^2 / " + number(rho) + " * (" +
             number((lambda + mu + dim * mu) * a[i]) + " * " + S + " - " + number(lambda + mu) + " * (0" + sum + "))\"";
    }
    return all + "]";
  };
  const auto error = [&](const Run &run, int dim) {
    const auto volume = component(run.end, "volume");
    double square = 0, total = 0;
    std::vector<double> S(volume.size(), 1);
    for (int j = 0; j < dim; ++j) {
      const auto x = component(run.end, "position", j);
      for (size_t p = 0; p < S.size(); ++p) S[p] *= std::sin(pi * x[p]);
    }
    for (int i = 0; i < dim; ++i) {
      const auto u = component(run.end, "displacement", i);
      for (size_t p = 0; p < S.size(); ++p)
        square += volume[p] * std::pow(u[p] - a[i] * S[p], 2), total += volume[p] * std::pow(a[i] * S[p], 2);
    }
    return std::sqrt(square / total);
  };
  for (const int dim : {2, 3})
    for (const auto &[elements, order] : {std::pair{"quadratic", 3}, {"linear", 2}, {"patches", 2}}) {
      double size_of_cells;
      const auto at = [&](double size) {
        std::vector<std::string> overrides{"mesh.size=" + number(size), "body.soil.body_acceleration=" + load(dim),
                                           "quasi_static.elements=" + std::string(elements)};
        if (dim == 3)
          overrides.insert(overrides.end(),
                           {"dimension=3",
                            "boundary.walls.group=[\"base\", \"left\", \"right\", \"surface\", \"front\", \"back\"]"});
        const Run run = rung.run(overrides);
        size_of_cells = std::pow(static_cast<double>(run.end.id.size()), -1. / dim);
        return error(run, dim);
      };
      const double first = at(0.2), coarse = size_of_cells, last = at(dim == 2 ? 0.05 : 0.1), fine = size_of_cells;
      const double observed = std::log(first / last) / std::log(coarse / fine);
      const std::string which = name_of(dim) + " " + elements;
      // meshes are unstructured: cells of half the size are not those of the coarse mesh cut in two
      rung.compare(which + ": order of displacement in L2", order, observed, 0.25, 1);
      rung.report(which + ": error on the finer mesh", 0, last, 1);
    }
}

}  // namespace talus::rungs
