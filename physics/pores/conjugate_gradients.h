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
  /// `sum`(a, b) is a scalar product over all ranks; `small`(r) tells whether a residual is small enough. Stops after
  /// `most` iterations, or where A is not positive definite. `taken`: number of iterations. Collective.
  template <class Apply, class Sum, class Small>
  PetscErrorCode solve(int nodes, const double *diagonal, const double *b, double *x, int most, Apply &&apply,
                       Sum &&sum, Small &&small, int *taken) {
    PetscFunctionBeginUser;
    double *r = residual_.data(), *p = direction_.data(), *q = image_.data(), weighted = 0;
    for (int i = 0; i < nodes; ++i) x[i] = 0, r[i] = b[i], p[i] = b[i] / diagonal[i];
    PetscCall(sum(r, p, &weighted));
    for (*taken = 0; *taken < most && weighted > 0; ++*taken) {
      double curvature = 0, next = 0;
      PetscCall(apply(p, q));
      PetscCall(sum(p, q, &curvature));
      if (!(curvature > 0)) break;
      const double step = weighted / curvature;
      for (int i = 0; i < nodes; ++i) x[i] += step * p[i], r[i] -= step * q[i], q[i] = r[i] / diagonal[i];
      PetscCall(sum(r, q, &next));
      bool enough = false;
      PetscCall(small(r, &enough));
      if (enough) break;
      for (int i = 0; i < nodes; ++i) p[i] = q[i] + next / weighted * p[i];
      weighted = next;
    }
    PetscFunctionReturn(0);
  }

 private:
  std::vector<double> residual_, direction_, image_;
};

}  // namespace talus
