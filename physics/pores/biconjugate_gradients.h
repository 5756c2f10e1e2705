#pragma once
/// Stabilised biconjugate gradients with a diagonal preconditioner, for an operator that is not symmetric: van der
/// Vorst (1992). Scalar products are those of the preconditioner, so that unknowns of any size count alike.
#include <petscsys.h>

#include <vector>

#include "base/room.h"

namespace talus {

class StabilisedBiconjugateGradients {
 public:
  void make_room_for(size_t most_points) {
    for (std::vector<double> *field : {&residual_, &shadow_, &direction_, &image_, &scaled_, &second_})
      make_room(*field, most_points);
  }

  /// As ConjugateGradients::solve.
  template <class Apply, class Sum>
  PetscErrorCode solve(int points, const double *diagonal, const double *weight, const double *b, double *x, int most,
                       double enough, Apply &&apply, Sum &&sum) {
    PetscFunctionBeginUser;
    double *r = residual_.data(), *shadow = shadow_.data(), *p = direction_.data(), *v = image_.data(),
           *scaled = scaled_.data(), *t = second_.data();
    std::fill_n(x, points, 0.), std::fill_n(p, points, 0.), std::fill_n(v, points, 0.);
    std::copy_n(b, points, r), std::copy_n(b, points, shadow);
    const auto with = [&](const double *f, const double *g) {
      return [f, g, diagonal](int i) { return f[i] * g[i] / diagonal[i]; };
    };
    const auto squares = [&](int i) { return weight[i] * r[i] * r[i]; };
    double before = 1, alpha = 1, omega = 1;
    auto [along, size] = sum(with(shadow, r), squares);
    for (products_ = 0; size > enough && products_ < most && along != 0;) {
      const double beta = along / before * alpha / omega;
      for (int i = 0; i < points; ++i) {
        p[i] = r[i] + beta * (p[i] - omega * v[i]);
        scaled[i] = p[i] / diagonal[i];
      }
      PetscCall(apply(scaled, v));
      ++products_;
      const auto [shadowed] = sum(with(shadow, v));
      if (shadowed == 0) break;
      alpha = along / shadowed;
      for (int i = 0; i < points; ++i) {
        x[i] += alpha * scaled[i], r[i] -= alpha * v[i];
        scaled[i] = r[i] / diagonal[i];
      }
      const auto [half_way] = sum(squares);
      if (half_way <= enough) break;
      PetscCall(apply(scaled, t));
      ++products_;
      const auto [with_rest, with_itself] = sum(with(t, r), with(t, t));
      if (with_rest == 0 || with_itself == 0) break;
      omega = with_rest / with_itself, before = along;
      for (int i = 0; i < points; ++i) x[i] += omega * scaled[i], r[i] -= omega * t[i];
      const auto [next_along, next_size] = sum(with(shadow, r), squares);
      along = next_along, size = next_size;
    }
    PetscFunctionReturn(0);
  }
  int products() const { return products_; }  ///< with A, of the last solve

 private:
  int products_ = 0;
  std::vector<double> residual_, shadow_, direction_, image_, scaled_, second_;
};

}  // namespace talus
