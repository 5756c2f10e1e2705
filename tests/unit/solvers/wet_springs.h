#pragma once
/// A motion without soil for integrators that treat drag between phases implicitly: a chain of nodes that carry grains
/// and water, between a wall and a free end. Skeleton springs hold the grains, the water in each cell resists (1 - n)
/// strain of the grains
/// + n strain of the water, and the two drag at one another. Linear, so its solution is known.
#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "base/eigenvalues.h"
#include "given_places.h"
#include "physics/pores/drag.h"
#include "solvers/integrator.h"
#include "tests/unit/exponential.h"

namespace talus {

class WetSprings : public GivenPlaces {
 public:
  static constexpr int count = 8;
  static constexpr double porosity = 0.4, grains = 0.6, water = 0.4;  ///< masses of a node [kg]

  /// Stiffness of skeleton and pore water [N/m]; drag [kg/s]; velocity of the water at the start over that of the
  /// grains.
  WetSprings(double skeleton, double pores, double drag, double water_velocity = 0.5)
      : GivenPlaces(2 * count), skeleton_(skeleton), pores_(pores), drag_(drag) {
    for (int i = 0; i < count; ++i)
      speed[i] = std::sin(M_PI / 2 * (i + 1) / count), speed[count + i] = water_velocity * speed[i];
  }

  /// Largest frequency without drag [1/s].
  double largest_frequency() const { return std::sqrt(eigenvalues(matrix(0)).cwiseAbs().maxCoeff()); }
  /// (u, v) at time t from the present state.
  Eigen::VectorXd exact(double t) const {
    const int n = 2 * count;
    Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    rates.topRightCorner(n, n).setIdentity();
    rates.bottomLeftCorner(n, n) = -matrix(0), rates.bottomRightCorner(n, n) = -matrix(1);
    Eigen::VectorXd start(2 * n);
    start << Eigen::Map<const Eigen::VectorXd>(place.data(), n), Eigen::Map<const Eigen::VectorXd>(speed.data(), n);
    return exponential<Eigen::MatrixXd>(rates * t) * start;
  }
  /// Largest difference of the present velocities to those.
  double error(const Eigen::VectorXd &state) const {
    return (Eigen::Map<const Eigen::VectorXd>(speed.data(), 2 * count) - state.tail(2 * count)).cwiseAbs().maxCoeff();
  }
  /// Momentum of both phases [kg m/s].
  double momentum() const {
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += grains * speed[i] + water * speed[count + i];
    return sum;
  }

  PetscErrorCode acceleration(double, const double *u, const double *, double *a) override { return force(u, a); }
  PetscErrorCode apply_boundaries_and_drag(double t, double gamma, double *v) override {
    return apply_drag(t, gamma, v);
  }
  PetscErrorCode apply_drag(double, double gamma, double *v) override {
    const NodalFluid node{water, water, drag_};
    for (int i = 0; i < count; ++i) resolve_drag<1>(gamma, grains, v[i], &node, v + count + i);
    return 0;
  }
  PetscErrorCode apply_boundaries(double, double, double *) override { return 0; }
  double seen_square(const double *x) const override {
    double sum = 0;
    for (int i = 0; i < size(); ++i) sum += x[i] * x[i] / 2;
    return sum;
  }
  double mass() const override { return count; }

 private:
  PetscErrorCode force(const double *u, double *a) const {
    std::fill_n(a, size(), 0.);
    const auto at = [&](int i, int phase) {
      return i < 0 ? 0 : place[phase * count + i] + (u ? u[phase * count + i] : 0);
    };
    for (int cell = 0; cell < count; ++cell) {  // between node cell - 1, which is the wall for the first, and node cell
      const double solid = at(cell, 0) - at(cell - 1, 0), fluid = at(cell, 1) - at(cell - 1, 1);
      const double push = pores_ * ((1 - porosity) * solid + porosity * fluid);
      const double forces[] = {skeleton_ * solid + (1 - porosity) * push, porosity * push};
      for (int phase : {0, 1}) {
        const double share = forces[phase] / (phase ? water : grains);
        a[phase * count + cell] -= share;
        if (cell) a[phase * count + cell - 1] += share;
      }
    }
    return 0;
  }
  /// a = -M(0) u - M(1) v.
  Eigen::MatrixXd matrix(int which) const {
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(2 * count, 2 * count);
    if (which == 1) {
      for (int i = 0; i < count; ++i)
        m(i, i) = drag_ / grains, m(i, count + i) = -drag_ / grains, m(count + i, count + i) = drag_ / water,
             m(count + i, i) = -drag_ / water;
      return m;
    }
    WetSprings probe(skeleton_, pores_, 0);
    std::vector<double> unit(2 * count), a(2 * count);
    for (int j = 0; j < 2 * count; ++j) {
      std::fill(unit.begin(), unit.end(), 0.);
      unit[j] = 1;
      probe.force(unit.data(), a.data());
      for (int i = 0; i < 2 * count; ++i) m(i, j) = -a[i];
    }
    return m;
  }
  double skeleton_, pores_, drag_;
};

}  // namespace talus
