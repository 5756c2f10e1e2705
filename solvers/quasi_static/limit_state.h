#pragma once
/// Can soil carry its loads? A search for equilibrium that also recognises failure, docs/theory/finite_elements.md
/// section 5. The soil is propped by an elastic solid of the same shape with a small share alpha of its elastic
/// stiffness, which makes every load bearable, and alpha is reduced step by step. Soil in equilibrium unloads the prop:
/// its force goes to zero with alpha. Soil that fails leans on it: displacement grows as 1 / alpha, and the force of
/// the prop stays. For associated flow (psi = phi) the propped soil minimises a convex energy, so that one of the two
/// must happen and the iterations find which.
#include <utility>
#include <vector>

#include "solvers/quasi_static/quasi_static.h"

namespace talus {

// Out-of-balance force over the size of the forces at which soil is in equilibrium. A slide of a hundredth of the soil
// then misses a thousandth of its own weight, a fifth of the width of the bracket of a factor of safety.
constexpr double small_residual = 1e-5;
/// A mechanism has moved by this much more than elastic soil under the same loads.
constexpr double far_from_elastic = 10;

enum class LimitVerdict { equilibrium, mechanism, undecided, interrupted };

/// How a search ended.
struct LimitSearch {
  LimitVerdict verdict = LimitVerdict::undecided;
  int iterations = 0;       ///< linear systems that were solved
  int steps = 0;            ///< of damped motion
  double residual = 0;      ///< out-of-balance force without the prop over the size of the forces at the end [-]
  double displacement = 0;  ///< largest displacement of a node during the search [m]
  double surplus = 0;       ///< of a mechanism: share of the work of the loads that the prop takes up [-]
  /// Largest displacement [m] and force of the prop over that of the loads [-] for each stiffness of the prop: the
  /// load-displacement curve.
  std::vector<std::pair<double, double>> curve;
};

template <int dim>
class LimitState {
 public:
  /// Bodies and loads must not change while it exists; strength may.
  explicit LimitState(QuasiStatic<dim> &problem) : problem_(problem) {}

  /// Prepares searches under the loads of `load_time` at `share` of the path: finds the displacement of elastic soil,
  /// to which displacements are compared. Collective.
  PetscErrorCode setup(double load_time, double time, double share = 1);
  /// Searches from the state of the problem. An equilibrium is committed (with the history of the laws unchanged); in
  /// every other case the problem keeps its state. Collective.
  PetscErrorCode search(LimitSearch *result);
  /// The same by damped motion of the elements, for soil without an energy (psi < phi), where iterations stall.
  /// Sources: Otter, Cassell & Hobbs (1966), Proc. Inst. Civ. Eng. 35; Cundall (1987), in Analytical and Computational
  /// Methods in Engineering Rock Mechanics. Docs/theory/finite_elements.md section 5.
  PetscErrorCode move(LimitSearch *result);  // damped_motion.cpp
  /// The same by creep, in many small parts of the way: each is held by a prop that stands where the part begins, so
  /// that the soil comes to rest or goes on. What is left out of balance in equilibrium is `small` of the forces.
  PetscErrorCode creep(double small, LimitSearch *result);  // creep.cpp
  /// Moves the soil along the mechanism that was found last, so far that its largest displacement is `size` [m].
  /// Collective.
  PetscErrorCode move_along(double size);

 private:
  bool stop_asked() const { return problem_.stop_asked && problem_.stop_asked(); }
  PetscErrorCode make_solver(bool symmetric);
  PetscErrorCode choose_solver();
  PetscErrorCode solve(::Vec b, ::Vec x, bool *solved);
  PetscErrorCode evaluate(::Vec x);
  PetscErrorCode settle(int most_iterations, double of_prop, double of_scale, LimitSearch *result, bool *settled);
  PetscErrorCode settle_on_bases(int most_iterations, LimitSearch *result, bool *settled);
  PetscErrorCode take_mechanism(LimitSearch *result);
  PetscErrorCode line_search(double slope, double *step);

  QuasiStatic<dim> &problem_;
  double load_time_ = 0, time_ = 0, share_ = 1;
  double elastic_displacement_ = 0;  ///< of a node at most [m]
  double prop_ = 0;                  ///< alpha: stiffness of the prop over the elastic stiffness [-]
  double residual_ = 0;              ///< size of the out-of-balance force of the propped soil [N]
  double prop_force_ = 0;            ///< size of the force of the prop [N]
  Owned<KSP, KSPDestroy> solver_;
  bool symmetric_ = true;  ///< the systems that it solves
  Matrix elastic_;         ///< elastic stiffness
  Vector x_, trial_, direction_, force_, of_prop_, start_, mechanism_;
};

}  // namespace talus
