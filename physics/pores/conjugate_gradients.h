#pragma once
/// Conjugate gradients with a diagonal preconditioner, for a symmetric positive definite operator on the nodes of a
/// rank: Hestenes & Stiefel (1952).
#include <petscsys.h>

#include <cmath>
#include <vector>

#include "base/room.h"

namespace talus {

class ConjugateGradients {
 public:
  explicit ConjugateGradients(int most_nodes) {
    for (std::vector<double> *field : {&residual_, &direction_, &image_}) make_room(*field, most_nodes);
  }

  /// Solves A x = b on `nodes` nodes, from x = 0. `diagonal` approximates that of A; `apply`(x, y) finds y = A x;
  /// `product`(a, b) is a scalar product over all ranks; `sizes`(r, z) gives that of the residual r and z, and a
  /// measure of r, at which the solve ends once it is at most `enough`. It ends too after `most` iterations, and where
  /// A is not positive definite. `taken`: number of iterations. Collective.
  template <class Apply, class Product, class Sizes>
  PetscErrorCode solve(int nodes, const double *diagonal, const double *b, double *x, int most, Apply &&apply,
                       Product &&product, Sizes &&sizes, double enough) {
    PetscFunctionBeginUser;
    double *r = residual_.data(), *p = direction_.data(), *q = image_.data();
    for (int i = 0; i < nodes; ++i) x[i] = 0, r[i] = b[i], p[i] = b[i] / diagonal[i];
    double weighted = product(r, p);
    for (int taken = 0; taken < most && weighted > 0; ++taken) {
      PetscCall(apply(p, q));
      const double curvature = product(p, q);
      if (!(curvature > 0)) break;
      const double step = weighted / curvature;
      for (int i = 0; i < nodes; ++i) x[i] += step * p[i], r[i] -= step * q[i], q[i] = r[i] / diagonal[i];
      const auto [next, size] = sizes(r, q);
      if (size <= enough) break;
      for (int i = 0; i < nodes; ++i) p[i] = q[i] + next / weighted * p[i];
      weighted = next;
    }
    PetscFunctionReturn(0);
  }

 private:
  std::vector<double> residual_, direction_, image_;
};

}  // namespace talus
