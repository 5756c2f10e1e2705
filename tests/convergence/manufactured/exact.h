#pragma once
/// Manufactured solution on the unit square or cube: u_i = A sin(pi X_i) sin(pi (phi_i + c t)). F is diagonal, so with
/// sigma_ii = lambda ln J + 2 mu ln F_ii the momentum balance on the undeformed body, rho0 u_tt = dP_ii / dX_i + rho0
/// b_i with P_ii = J sigma_ii / F_ii, and J / F_ii free of X_i, asks for
///     b_i = pi^2 u_i [(lambda + 2 mu) J / (rho0 F_ii^2) - c^2].
#include <array>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

namespace manufactured_motion {

constexpr double E = 100e3, nu = 0.3, rho = 1000, c = 10, pi = 3.14159265358979323846;

struct Motion {
  int dimension;
  double A;
  std::array<double, 3> phi;

  /// Displacement, velocity, stress and body acceleration as expressions of the scene.
  std::vector<std::string> overrides() const {
    const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
    const char axis[] = "xyz";
    const auto text = [](double x) { return "(" + number(x) + ")"; };
    const auto list = [](const std::vector<std::string> &items) {
      std::string all;
      for (const std::string &item : items) all += (all.empty() ? "[\"" : ", \"") + item + "\"";
      return all + "]";
    };
    std::array<std::string, 3> u, f, f0;  // u_i(X, t); F_ii at t, at t = 0
    std::string J = "1", J0 = "1";
    for (int i = 0; i < dimension; ++i) {
      const std::string X = std::string("pi * ") + axis[i],
                        swing = "sin(pi * (" + text(phi[i]) + " + " + text(c) + " * t))";
      u[i] = text(A) + " * sin(" + X + ") * " + swing;
      f[i] = "(1 + " + text(A * pi) + " * cos(" + X + ") * " + swing + ")";
      f0[i] = "(1 + " + text(A * pi * std::sin(pi * phi[i])) + " * cos(" + X + "))";
      J += " * " + f[i], J0 += " * " + f0[i];
    }
    std::vector<std::string> displacement, velocity, stress, body;
    for (int i = 0; i < dimension; ++i) {
      const std::string X = std::string("pi * ") + axis[i];
      displacement.push_back(text(A * std::sin(pi * phi[i])) + " * sin(" + X + ")");
      velocity.push_back(text(A * pi * c * std::cos(pi * phi[i])) + " * sin(" + X + ")");
      body.push_back(text(pi * pi) + " * " + u[i] + " * (" + text((lambda + 2 * mu) / rho) + " * " + J + " / " + f[i] +
                     "^2 - " + text(c * c) + ")");
    }
    for (int i = 0; i < 3; ++i)
      stress.push_back(text(lambda) + " * ln(" + J0 + ")" +
                       (i < dimension ? " + " + text(2 * mu) + " * ln(" + f0[i] + ")" : ""));
    for (int i = 0; i < (dimension == 2 ? 1 : 3); ++i) stress.push_back("0");
    std::vector<std::string> all{"body.soil.velocity=" + list(velocity), "body.soil.body_acceleration=" + list(body),
                                 "body.soil.stress=" + list(stress)};
    bool displaced = false;
    for (int i = 0; i < dimension; ++i) displaced = displaced || std::abs(std::sin(pi * phi[i])) > 1e-12;
    if (displaced) all.push_back("body.soil.displacement=" + list(displacement));
    return all;
  }

  /// Error of the displacement at the end, root of the mean square over the mass, over A.
  double error(const Run &run) const {
    const auto mass = component(run.end, "mass");
    double square = 0, total = 0;
    for (const double m : mass) total += m;
    for (int i = 0; i < dimension; ++i) {
      const auto x = component(run.end, "position", i), u = component(run.end, "displacement", i);
      const auto x0 = component(run.start, "position", i), u0 = component(run.start, "displacement", i);
      for (size_t p = 0; p < x.size(); ++p) {
        const double X = x0[p] - u0[p], exact = A * std::sin(pi * X) * std::sin(pi * (phi[i] + c * run.end.time));
        square += mass[p] * (x[p] - X - exact) * (x[p] - X - exact);
      }
    }
    return std::sqrt(square / total) / A;
  }
};

/// Slope of log(error) over log(size) by least squares.
inline double order(const std::vector<double> &size, const std::vector<double> &error) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const double n = static_cast<double>(size.size());
  for (size_t i = 0; i < size.size(); ++i) {
    const double x = std::log(size[i]), y = std::log(error[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace manufactured_motion

inline void manufactured(Rung &rung) {
  using namespace manufactured_motion;
  for (const int dimension : {2, 3}) {
    const std::vector<double> sizes =
        dimension == 2 ? std::vector{0.2, 0.1, 0.05, 0.025} : std::vector{0.15, 0.075, 0.0375};
    // in 3D one mesh and its halvings: the order over meshes of Gmsh hangs on which tetrahedra it makes
    const auto mesh = [&](double size) -> std::vector<std::string> {
      if (dimension == 2) return {"mesh.size=" + number(size)};
      return {"mesh.size=" + number(sizes[0]), "mesh.halvings=" + number(std::log2(sizes[0] / size))};
    };
    const auto study = [&](const Motion &motion, const std::vector<std::string> &more, std::vector<double> &errors) {
      for (const double size : sizes) {
        auto overrides = motion.overrides();
        for (const auto &added : {mesh(size), more}) overrides.insert(overrides.end(), added.begin(), added.end());
        errors.push_back(motion.error(rung.run(in_dimension(dimension, overrides))));
      }
      return order(sizes, errors);
    };
    const auto state = [&](const std::string &what, const std::vector<double> &errors) {
      for (size_t i = 0; i < sizes.size(); ++i)
        rung.report(name_of(dimension) + " error over A, " + what + ", h = " + number(sizes[i]), 0, errors[i], 1);
    };
    std::vector<double> frozen, crossing;
    // nothing moves as far as 0.3 of an edge, so nothing is remapped
    const double order_frozen = study({dimension, 0.004, {0, 1, 0}}, {}, frozen);
    rung.compare(name_of(dimension) + " order of the displacement in L2, cells frozen", 2, order_frozen, 0.1);
    state("cells frozen", frozen);
    if (dimension == 3 && !rung.longer()) continue;
    const double order_crossing =
        study({dimension, 0.05, {0, 2. / 3, 4. / 3}}, {"transfer.remap_interval=0"}, crossing);
    rung.report(name_of(dimension) + " order of the displacement in L2, cells crossed", 2, order_crossing);
    state("cells crossed", crossing);
  }
}

}  // namespace talus::rungs
