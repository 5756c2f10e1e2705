/// Damped motion of the elements (dynamic relaxation), docs/theory/finite_elements.md section 5.
#include <algorithm>
#include <cmath>

#include "solvers/quasi_static/limit_state.h"

namespace talus {
namespace {

/// Masses with which a step of 1 is stable: a quarter of the sum of each row's stiffness bounds the largest eigenvalue
/// (Gershgorin), with a margin for bases and laws that are stiffer than their elastic part.
PetscErrorCode masses_of(Mat stiffness, ::Vec mass) {
  constexpr double margin = 2;
  PetscInt first, last;
  double *value;
  PetscFunctionBeginUser;
  PetscCall(MatGetOwnershipRange(stiffness, &first, &last));
  PetscCall(VecGetArray(mass, &value));
  for (PetscInt row = first; row < last; ++row) {
    PetscInt count;
    const PetscScalar *entry;
    PetscCall(MatGetRow(stiffness, row, &count, nullptr, &entry));
    double sum = 0;
    for (PetscInt k = 0; k < count; ++k) sum += std::abs(entry[k]);
    value[row - first] = margin * sum / 4;
    PetscCall(MatRestoreRow(stiffness, row, &count, nullptr, &entry));
  }
  PetscCall(VecRestoreArray(mass, &value));
  PetscFunctionReturn(0);
}

/// One step of 1 with Cundall's local damping: the force on a component counts less where it drives the motion and more
/// where it stops it. Steady motion is not resisted.
PetscErrorCode accelerate(::Vec force, ::Vec mass, ::Vec velocity) {
  constexpr double damping = 0.8;
  PetscInt count;
  const double *f, *m;
  double *v;
  PetscFunctionBeginUser;
  PetscCall(VecGetLocalSize(velocity, &count));
  PetscCall(VecGetArrayRead(force, &f));
  PetscCall(VecGetArrayRead(mass, &m));
  PetscCall(VecGetArray(velocity, &v));
  for (PetscInt k = 0; k < count; ++k) v[k] += (f[k] - damping * std::copysign(std::abs(f[k]), v[k])) / m[k];
  PetscCall(VecRestoreArray(velocity, &v));
  PetscCall(VecRestoreArrayRead(mass, &m));
  PetscCall(VecRestoreArrayRead(force, &f));
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode LimitState<dim>::move(LimitSearch *result) {
  constexpr int most_steps = 100000, between = 50, first_look = 200, looks = 2;  // in the time that doubles
  // Soil that goes on at one speed moves twice as far in twice the time, soil that comes to rest hardly further.
  constexpr double going_on = 1.5;
  constexpr int settled = 20000;  // steps after which heavy soil that goes on has failed, however far it came
  PetscFunctionBeginUser;
  *result = {};
  const auto before = problem_.save();
  Vector mass, velocity, way, way_then;  // at the last look
  for (Vector *v : {&mass, &velocity, &way, &way_then}) PetscCall(problem_.soil().nodes().global_vector(*v));
  PetscCall(masses_of(elastic_, mass));
  PetscCall(problem_.prepare(share_, load_time_, time_, 0, x_));
  PetscCall(problem_.residual(x_, force_));
  problem_.close_scale();
  PetscCall(VecZeroEntries(velocity));
  PetscCall(VecZeroEntries(way));
  PetscCall(VecZeroEntries(way_then));
  double look = first_look;
  for (int step = 1; step <= most_steps; ++step) {
    PetscCall(VecScale(force_, -1));
    PetscCall(accelerate(force_, mass, velocity));
    PetscCall(VecAXPY(way, 1, velocity));
    PetscCall(problem_.residual(velocity, force_));
    PetscCall(problem_.accept(velocity));
    if (step % between != 0) continue;
    result->steps = step;
    if (stop_asked()) {
      result->verdict = LimitVerdict::interrupted;
      break;
    }
    PetscCall(VecNorm(force_, NORM_2, &residual_));
    PetscCall(VecNorm(way, NORM_INFINITY, &result->displacement));
    result->residual = residual_ / problem_.force_scale();
    if (problem_.iterated) problem_.iterated(step, result->residual);
    if (result->residual <= small_residual) {
      result->verdict = LimitVerdict::equilibrium;
      break;
    }
    if (step < look) continue;
    look *= std::pow(2, 1. / looks);
    auto &curve = result->curve;
    curve.emplace_back(result->displacement, result->residual);
    const auto way_before = [&](size_t doublings) {
      return curve.size() > doublings * looks ? curve[curve.size() - 1 - doublings * looks].first : 0.;
    };
    const auto gained = [&](size_t doublings) { return way_before(doublings) - way_before(doublings + 1); };
    const bool far = result->displacement > far_from_elastic * elastic_displacement_;
    const bool lasts = step > settled && gained(1) > going_on * gained(2);
    if (gained(0) > going_on * gained(1) && (far || lasts)) {
      double work, of_loads;
      PetscCall(VecWAXPY(mechanism_, -1, way_then, way));
      PetscCall(VecDot(force_, mechanism_, &work));
      PetscCall(VecDot(problem_.loads(), mechanism_, &of_loads));
      result->verdict = LimitVerdict::mechanism, result->surplus = -work / of_loads;
      break;
    }
    PetscCall(VecCopy(way, way_then));
  }
  if (result->verdict == LimitVerdict::equilibrium) {
    PetscCall(VecZeroEntries(x_));
    PetscCall(problem_.commit(x_, false));
  } else {
    problem_.restore(before);
  }
  PetscFunctionReturn(0);
}

template PetscErrorCode LimitState<2>::move(LimitSearch *);
template PetscErrorCode LimitState<3>::move(LimitSearch *);

}  // namespace talus
