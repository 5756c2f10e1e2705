#pragma once
/// A motion without soil for the tests of integrators: masses on a line between walls, held by springs, with a given
/// force. Like soil it keeps what it accepted: places live in the accepted state, displacement counts from there.
#include <cmath>
#include <functional>
#include <vector>

#include "given_places.h"
#include "solvers/integrator.h"

namespace talus {

class Springs : public GivenPlaces {
 public:
  /// `count` equal masses of 1 kg with springs of `stiffness` [N/m] between them and to both walls.
  Springs(int count, double stiffness) : GivenPlaces(count), stiffness_(stiffness) {}

  std::function<double(double)> force = [](double) { return 0.; };  ///< on each mass, of time [N]
  double beta = 0;  ///< damping by the rate of the forces of the springs, as the stiffness part of Rayleigh's [s]
  int evaluations = 0;

  /// Largest of the frequencies 2 sqrt(k) sin(pi n / 2 (count + 1)).
  double largest_frequency() const {
    const double n = static_cast<double>(place.size());
    return 2 * std::sqrt(stiffness_) * std::sin(M_PI / 2 * n / (n + 1));
  }
  double energy() const {
    double sum = 0, before = 0;
    for (size_t i = 0; i < place.size(); ++i)
      sum += speed[i] * speed[i] / 2 + stiffness_ / 2 * (place[i] - before) * (place[i] - before), before = place[i];
    return sum + stiffness_ / 2 * before * before;
  }

  PetscErrorCode acceleration(double t, const double *u, const double *v, double *a) override {
    ++evaluations;
    const int n = size();
    const auto at = [&](int i) { return i < 0 || i >= n ? 0 : place[i] + (u ? u[i] : 0) + beta * v[i]; };
    for (int i = 0; i < n; ++i) a[i] = stiffness_ * (at(i - 1) - 2 * at(i) + at(i + 1)) + force(t);
    return 0;
  }
  PetscErrorCode apply_boundaries_and_drag(double, double, double *) override { return 0; }
  double seen_square(const double *x) const override {
    double sum = 0;
    for (int i = 0; i < size(); ++i) sum += x[i] * x[i];
    return sum;
  }
  double mass() const override { return size(); }

 protected:
  double stiffness_;
};

/// Runs a motion to time `end` and returns how many steps it took.
inline int run_to(Integrator &integrator, Motion &motion, double critical, double end) {
  double t = 0;
  int steps = 0;
  while (t < end * (1 - 1e-12)) {
    double taken = 0;
    if (integrator.advance(motion, t, {critical, end}, &taken) || !integrator.obstacle().empty()) break;
    t += taken, ++steps;
  }
  return steps;
}

}  // namespace talus
