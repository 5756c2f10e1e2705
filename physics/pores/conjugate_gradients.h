#pragma once
/// Conjugate gradients with a diagonal preconditioner, for a symmetric positive definite operator on the nodes of a
/// rank: Hestenes & Stiefel (1952). Arrays of their own, since the nodes are others after each remap and the time loop
/// allocates nothing.
#include <petscsys.h>

#include <array>
#include <vector>

#include "base/room.h"

namespace talus {

class ConjugateGradients {
 public:
  void make_room_for(size_t most_points) {
    for (std::vector<double> *field : {&residual_, &preconditioned_, &direction_, &image_})
      make_room(*field, most_points);
  }

  /// Solves A x = b on `nodes` nodes, from x = 0. `diagonal` approximates that of A; `apply`(x, y) finds y = A x;
  /// `sum`(terms...) sums functions of a node over all ranks. The solve ends once the sum of `weight` times the square
  /// of the residual is at most `enough`, after `most` iterations, or where A is not positive definite. Collective.
  template <class Apply, class Sum>
  PetscErrorCode solve(int nodes, const double *diagonal, const double *weight, const double *b, double *x, int most,
                       double enough, Apply &&apply, Sum &&sum) {
    PetscFunctionBeginUser;
    double *r = residual_.data(), *z = preconditioned_.data(), *p = direction_.data(), *q = image_.data();
    double weighted = 1;
    std::fill_n(x, nodes, 0.), std::fill_n(p, nodes, 0.), std::copy_n(b, nodes, r);
    for (iterations_ = 0;; ++iterations_) {
      for (int i = 0; i < nodes; ++i) z[i] = r[i] / diagonal[i];
      const auto [next, size] = sum([&](int i) { return r[i] * z[i]; }, [&](int i) { return weight[i] * r[i] * r[i]; });
      if (size <= enough || iterations_ == most) break;
      for (int i = 0; i < nodes; ++i) p[i] = z[i] + next / weighted * p[i];
      weighted = next;
      PetscCall(apply(p, q));
      const auto [curvature] = sum([&](int i) { return p[i] * q[i]; });
      if (!(curvature > 0)) break;
      const double step = weighted / curvature;
      for (int i = 0; i < nodes; ++i) x[i] += step * p[i], r[i] -= step * q[i];
    }
    PetscFunctionReturn(0);
  }
  int products() const { return iterations_; }                 ///< with A, of the last solve
  const double *residual() const { return residual_.data(); }  ///< b - A x after it

 private:
  int iterations_ = 0;
  std::vector<double> residual_, preconditioned_, direction_, image_;
};

}  // namespace talus
