#pragma once
/// A body that turns rigidly about the z axis (in 3D about (1, 1, 1)) takes its stress with it: sigma(t) = R sigma(0)
/// R^T. All nodes are given the chord of the turn as their velocity, (R(omega dt) - I) x / dt, and then the tangent
/// omega x x, whose steps turn by atan(omega dt) and so fall behind as dt^2.
#include <Eigen/Dense>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void rigid_rotation(Rung &rung) {
  constexpr double omega = 2 * 3.14159265358979323846, duration = 10.125;
  const Eigen::Matrix3d start = (Eigen::Matrix3d() << 1000, 700, 300, 700, -2000, -400, 300, -400, 500).finished();
  for (const int dimension : {2, 3}) {
    const Eigen::Vector3d axis = dimension == 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, 1, 1).normalized();
    const auto turn = [&](double angle) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); };
    const auto velocity = [&](const Eigen::Matrix3d &gradient) {
      std::string text = "boundary.turn.velocity=[";
      for (int i = 0; i < dimension; ++i) {
        text += i ? ", \"0" : "\"0";
        for (int j = 0; j < 3; ++j) text += " + (" + number(gradient(i, j)) + ") * " + "xyz"[j];
        text += "\"";
      }
      return text + "]";
    };
    const auto error = [&](double dt, const Eigen::Matrix3d &gradient) {
      std::vector<std::string> overrides{velocity(gradient), "integrator.step=" + number(dt)};
      if (dimension == 3)
        overrides.insert(overrides.end(), {"dimension=3", "mesh.file=core3d.msh",
                                           "body.soil.stress=[1000, -2000, 500, 700, -400, 300]"});
      const Run run = rung.run(overrides);
      Eigen::Matrix3d from = start;
      if (dimension == 2) from(0, 2) = from(2, 0) = from(1, 2) = from(2, 1) = 0;
      const Eigen::Matrix3d exact = turn(omega * duration) * from * turn(omega * duration).transpose();
      const auto stress = [&](int k) { return component(run.end, "stress", k); };
      const std::vector<std::vector<double>> s =
          dimension == 2 ? std::vector{stress(0), stress(1), stress(2), stress(3)}
                         : std::vector{stress(0), stress(1), stress(2), stress(3), stress(4), stress(5)};
      double largest = 0;
      for (size_t p = 0; p < s[0].size(); ++p) {
        const double yz = dimension == 3 ? s[4][p] : 0, xz = dimension == 3 ? s[5][p] : 0;
        const Eigen::Matrix3d computed =
            (Eigen::Matrix3d() << s[0][p], s[3][p], xz, s[3][p], s[1][p], yz, xz, yz, s[2][p]).finished();
        largest = std::max(largest, (computed - exact).norm() / exact.norm());
      }
      return largest;
    };
    const Eigen::Matrix3d spin =
        omega * (Eigen::Matrix3d() << 0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0).finished();
    constexpr double dt = 0.125 / 40;
    rung.compare(name_of(dimension) + " stress after 10 1/8 turns along chords, error over its norm", 0,
                 error(dt, (turn(omega * dt) - Eigen::Matrix3d::Identity()) / dt), 1e-9, 1);
    double coarse = 0, order = 0;
    for (const int steps : {80, 160, 320}) {  // in an eighth of a turn
      const double e = error(0.125 / steps, spin);
      rung.report(name_of(dimension) + " along tangents, " + std::to_string(8 * steps) + " steps a turn", 0, e, 1);
      if (coarse > 0) order = std::log2(coarse / e);
      coarse = e;
    }
    rung.compare(name_of(dimension) + " order along tangents", 2, order, 0.05);
  }
}

}  // namespace talus::rungs
