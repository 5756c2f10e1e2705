#include "solvers/quasi_static/quasi_static.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/local_numbers.h"
#include "scene/quasi_static_source.h"
#include "scene/scene.h"
#include "solvers/quasi_static/line_search.h"

namespace talus {

template <int dim>
PetscErrorCode QuasiStatic<dim>::activate(const std::vector<char> &present) {
  PetscFunctionBeginUser;
  present_ = present, left_out_ = {};
  soil_.leave_out({});
  PetscCall(activate_again());
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::activate_again() {
  PetscFunctionBeginUser;
  PetscCall(soil_.activate(present_));
  PetscCall(supports_.setup(soil_.mesh(), soil_.nodes(), soil_.active(), sources_));
  PetscCall(bases_.activate());
  PetscCall(structures_.activate());
  structures_.set_bonds();
  loads_.activate();
  PetscCall(unknowns_.setup());
  for (auto *v : {&x_, &f_, &out_of_balance_, &target_, &lifted_}) PetscCall(soil_.nodes().global_vector(*v));
  PetscCall(unknowns_.make_matrix(matrix_, [this] { return structures_.add_room(matrix_); }));
  PetscCall(make_solver());
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::make_solver(SNESLineSearchType line_search) {
  KSP ksp;
  const QuasiStaticSource &settings = *scene_.quasi_static;
  PetscFunctionBeginUser;
  PetscCall(SNESCreate(soil_.nodes().comm(), solver_.create()));
  PetscCall(SNESSetOptionsPrefix(solver_, "talus_"));
  PetscCall(SNESSetFunction(solver_, f_, snes_function, this));
  PetscCall(SNESSetJacobian(solver_, matrix_, matrix_, snes_jacobian, this));
  PetscCall(SNESSetType(solver_, SNESNEWTONLS));
  PetscCall(set_line_search(solver_, line_search));
  PetscCall(SNESSetTolerances(solver_, 0, settings.tolerance, 0, settings.iterations, PETSC_MAX_INT));
  PetscCall(SNESSetConvergenceTest(solver_, snes_converged, this, nullptr));
  PetscCall(SNESGetKSP(solver_, &ksp));
  PetscCall(prepare_linear_solver(ksp, false));
  PetscCall(SNESSetFromOptions(solver_));
  PetscFunctionReturn(0);
}

template <int dim>
bool QuasiStatic<dim>::direct() const {
  constexpr long long largest_direct = dim == 2 ? 400000 : 40000;  // unknowns, at which its fill is still cheap
  const LinearSolver wanted = scene_.quasi_static->linear_solver;
  return wanted == LinearSolver::direct || (wanted == LinearSolver::automatic && unknowns() <= largest_direct);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::prepare_linear_solver(KSP ksp, bool symmetric) {
  PC pc;
  PetscFunctionBeginUser;
  if (direct()) {
    PetscCall(solve_directly(ksp, matrix_, symmetric ? Factorization::cholesky : Factorization::lu));
    PetscFunctionReturn(0);
  }
  PetscCall(KSPSetType(ksp, KSPFGMRES));
  PetscCall(KSPGMRESSetRestart(ksp, 100));
  PetscCall(KSPSetTolerances(ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, 1000));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCGAMG));
  PetscCall(PCGAMGSetReuseInterpolation(pc, PETSC_TRUE));
  PetscCall(unknowns_.tell_rigid_motions(matrix_));
  PetscFunctionReturn(0);
}

// ---- Newton ----

template <int dim>
PetscErrorCode QuasiStatic<dim>::residual(::Vec x, ::Vec f) {
  std::vector<double> u, force;
  double *value, size;
  const double *unknown;
  PetscFunctionBeginUser;
  PetscCall(unknowns_.displacement_of(x, true, u));
  soil_.deform(u);
  soil_.internal_force(force, true);
  bases_.add_trial_force(u, force);
  structures_.add_trial_force(u, force);
  PetscCall(soil_.nodes().add_to_global(force, f));
  PetscCall(VecNorm(f, NORM_2, &size));
  if (scale_open_) force_scale_ = std::max(force_scale_, size);
  PetscCall(unknowns_.turn(f, true));
  PetscCall(VecAXPY(f, -1, target_));
  PetscCall(VecGetArray(f, &value));
  PetscCall(VecGetArrayRead(x, &unknown));
  unknowns_.each_held([&](PetscInt k) { value[k] = stiffness_scale_ * unknown[k]; });
  PetscCall(VecRestoreArrayRead(x, &unknown));
  PetscCall(VecRestoreArray(f, &value));
  PetscFunctionReturn(0);
}

/// `lift` receives what `motion` (local nodes, in their frames) does to the free rows.
template <int dim>
PetscErrorCode QuasiStatic<dim>::stiffness(double plastic, double elastic, const std::vector<double> *motion,
                                           std::vector<double> *lift) {
  PetscFunctionBeginUser;
  PetscCall(matrix_.clear());
  if (lift) lift->assign(static_cast<size_t>(soil_.nodes().count()) * dim, 0);
  const auto put = [&](const int *node, int count, typename SoilElements<dim>::Stiffness &element) {
    return unknowns_.add(matrix_, node, count, element, motion, lift);
  };
  PetscCall(soil_.each_stiffness(plastic, elastic, put));
  PetscCall(bases_.each_stiffness(plastic, elastic, put));
  PetscCall(structures_.add_stiffness(plastic, elastic, matrix_, motion, lift));
  PetscCall(unknowns_.finish(matrix_, stiffness_scale_));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::snes_function(SNES, ::Vec x, ::Vec f, void *problem) {
  return static_cast<QuasiStatic *>(problem)->residual(x, f);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::snes_jacobian(SNES, ::Vec, Mat, Mat, void *problem) {
  return static_cast<QuasiStatic *>(problem)->tangent();
}

/// Force out of balance over the forces that act, beyond which iterates do not come back.
constexpr double ran_away = 1e4;
/// Iterations that do not halve the least force out of balance so far go round in circles.
constexpr int most_in_vain = 8;

template <int dim>
PetscErrorCode QuasiStatic<dim>::snes_converged(SNES, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                                SNESConvergedReason *reason, void *context) {
  PetscFunctionBeginUser;
  QuasiStatic &problem = *static_cast<QuasiStatic *>(context);
  *reason = SNES_CONVERGED_ITERATING;
  problem.balanced_ = norm <= problem.scene_.quasi_static->tolerance * problem.force_scale_;
  if (iteration == 0) problem.scale_open_ = false;  // an iterate that goes astray must not widen what counts as small
  if (problem.iterated && problem.force_scale_ > 0) problem.iterated(iteration, norm / problem.force_scale_);
  if (iteration == 0 || norm < problem.least_ / 2) problem.least_ = norm, problem.since_ = 0;
  if (!std::isfinite(norm))
    *reason = SNES_DIVERGED_FNORM_NAN;
  else if (problem.balanced_)
    *reason = SNES_CONVERGED_FNORM_RELATIVE;
  else if (norm > ran_away * problem.force_scale_ || ++problem.since_ > most_in_vain)
    *reason = SNES_DIVERGED_DTOL;
  else if (problem.stop_asked && problem.stop_asked())
    problem.stopped_ = true, *reason = SNES_DIVERGED_DTOL;
  PetscFunctionReturn(0);
}

// ---- paths ----

template <int dim>
PetscErrorCode QuasiStatic<dim>::begin_path(double load_time) {
  std::vector<double> internal, external;
  PetscFunctionBeginUser;
  soil_.internal_force(internal, false);
  bases_.add_force(internal);
  structures_.add_force(internal);
  loads_.force(load_time, external);
  const Vec<dim> now = std::exchange(loads_.acceleration, borne_acceleration_);
  loads_.force(load_time, unborne_, [this](int cell) { return soil_.stressed(cell); });
  loads_.weight(load_time, unborne_parts_.gravity, [this](int cell) { return soil_.stressed(cell); });
  loads_.acceleration = now, share_ = 0, load_time_ = load_time;
  std::vector<double> whole;
  loads_.weight(load_time, whole);
  for (size_t i = 0; i < whole.size(); ++i) unborne_parts_.gravity[i] = whole[i] - unborne_parts_.gravity[i];
  unborne_parts_.loads.assign(sources_.size(), {});
  for (size_t s = 0; s < sources_.size(); ++s) {
    if (!loads_.loads(static_cast<int>(s))) continue;
    std::vector<double> &part = unborne_parts_.loads[s];
    loads_.load_of(static_cast<int>(s), load_time, part, [this](int cell) { return soil_.stressed(cell); });
    loads_.load_of(static_cast<int>(s), load_time, whole);
    for (size_t i = 0; i < whole.size(); ++i) part[i] = whole[i] - part[i];
  }
  for (size_t i = 0; i < external.size(); ++i) unborne_[i] = external[i] - unborne_[i], external[i] -= internal[i];
  PetscCall(soil_.nodes().add_to_global(external, out_of_balance_));
  PetscCall(unknowns_.turn(out_of_balance_, true));
  PetscCall(soil_.nodes().sum(unborne_));  // the rank that owns a node has all of it, so that it can move with the node
  for (int i = 0; i < soil_.nodes().count(); ++i)
    if (!soil_.nodes().owned[i]) std::fill_n(&unborne_[i * dim], dim, 0.);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::prepare(double share, double load_time, double time, double dt, ::Vec x) {
  std::vector<double> external, motion;
  PetscFunctionBeginUser;
  stopped_ = balanced_ = false, scale_open_ = true, trial_share_ = share, trial_load_time_ = load_time;
  soil_.find_suction(load_time);
  bases_.set_strength(load_time);
  structures_.set_bonds();
  loads_.force(load_time, external);
  PetscCall(soil_.nodes().add_to_global(external, target_));
  PetscCall(VecNorm(target_, NORM_2, &force_scale_));
  PetscCall(unknowns_.turn(target_, true));
  PetscCall(VecAXPY(target_, -(1 - share), out_of_balance_));

  stiffness_scale_ = 0;
  for (const GaussPoints<dim> &p : soil_.points())
    stiffness_scale_ = std::max(stiffness_scale_, constrained_modulus(p.law));
  PetscCall(VecZeroEntries(x));
  unknowns_.set_motion({});
  if (!supports_.moves()) PetscFunctionReturn(0);
  bool moves;
  PetscCall(unknowns_.find_motion(time, dt, motion, &moves));
  if (moves) PetscCall(start_with_motion(motion, x));
  PetscFunctionReturn(0);
}

/// The linear answer to the motion is where Newton starts: plates alone would strain their own cells only.
template <int dim>
PetscErrorCode QuasiStatic<dim>::start_with_motion(const std::vector<double> &motion, ::Vec x) {
  std::vector<double> lift;
  double *value;
  bool solved;
  PetscFunctionBeginUser;
  PetscCall(residual(x, f_));
  PetscCall(stiffness(1, 0, &motion, &lift));
  PetscCall(soil_.nodes().add_to_global(lift, lifted_));
  PetscCall(VecGetArray(lifted_, &value));
  unknowns_.each_held([&](PetscInt k) { value[k] = 0; });
  PetscCall(VecRestoreArray(lifted_, &value));
  PetscCall(VecAYPX(lifted_, -1, f_));
  PetscCall(VecAXPY(lifted_, -2, f_));  // -(f + lift)
  PetscCall(solve_linear(lifted_, x, &solved));
  if (!solved) PetscCall(VecZeroEntries(x));
  unknowns_.set_motion(motion);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::solve_linear(::Vec b, ::Vec x, bool *solved) {
  KSP ksp;
  PetscFunctionBeginUser;
  PetscCall(SNESGetKSP(solver_, &ksp));
  PetscCall(solve_system(ksp, matrix_, b, x, solved));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::advance(double share, double load_time, double time, double dt, bool softening,
                                         StepOutcome *outcome) {
  SNESConvergedReason reason;
  PetscInt iterations;
  PetscFunctionBeginUser;
  // of bonds, whose friction is that of the stress before, over all of them
  constexpr double small_change = 1e-3;
  constexpr int most_changes = 20;
  *outcome = {};
  const auto built = structures_.save();
  int before = 0;  // iterations
  const auto search = [&](SNESLineSearchType along) -> PetscErrorCode {
    PetscFunctionBeginUser;
    if (std::string(along) != SNESLINESEARCHCP) PetscCall(make_solver(along));
    structures_.restore(built);
    PetscCall(prepare(share, load_time, time, dt, x_));
    int total = 0;
    for (int k = 0; k <= most_changes; ++k) {
      PetscCall(SNESSolve(solver_, nullptr, x_));
      PetscCall(SNESGetConvergedReason(solver_, &reason));
      PetscCall(SNESGetIterationNumber(solver_, &iterations));
      total += static_cast<int>(iterations);
      double change = 0;
      if (balanced_) structures_.follow_soil(&change);
      if (change <= small_change) break;
    }
    PetscCall(SNESGetFunctionNorm(solver_, &outcome->residual));
    PetscCall(VecNorm(x_, NORM_INFINITY, &outcome->largest));
    outcome->iterations = before + total;
    outcome->residual /= force_scale_ > 0 ? force_scale_ : 1;
    outcome->singular = reason == SNES_DIVERGED_LINEAR_SOLVE;
    // neither MUMPS nor the line search recovers from numbers that ran away
    if (!balanced_) PetscCall(make_solver());
    PetscFunctionReturn(0);
  };
  const auto relaxed = [&]() -> PetscErrorCode {
    PetscFunctionBeginUser;
    PetscCall(advance_on_bases(share, load_time, time, dt, outcome));
    if (!balanced_) PetscCall(make_solver());
    PetscFunctionReturn(0);
  };
  const bool creeps = share_ == 0 && may_creep(softening);  // nothing of the path is borne that could show what moves
  const auto ended = [&] { return balanced_ || stopped_ || creeps || !outcome->moving.empty(); };
  PetscCall(search(SNESLINESEARCHCP));
  const bool bare = share_ == 0;  // contact opens and closes at many nodes
  if (!ended() && (bare || !bases_.any())) {
    PetscCall(relaxed());
    before = outcome->iterations;
  }
  if (!ended()) {  // there may be no energy whose critical point to find
    PetscCall(search(SNESLINESEARCHBT));
    PetscCall(make_solver());
  }
  if (!ended() && bases_.any() && !bare) PetscCall(relaxed());
  if (!ended() && bases_.any()) outcome->moved_most = moving_where_;
  outcome->converged = balanced_, outcome->stopped = stopped_;
  if (outcome->converged)
    PetscCall(commit(x_, softening));
  else
    structures_.restore(built);  // nothing tears in a step that is not taken
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::follow_normal_forces(double *change) {
  double of_bonds;
  PetscFunctionBeginUser;
  PetscCall(bases_.follow_normal_forces(change));
  structures_.follow_soil(&of_bonds);
  *change = std::max(*change, of_bonds);
  PetscFunctionReturn(0);
}

template <int dim>
bool QuasiStatic<dim>::may_creep(bool softening) const {
  const auto loses_strength = [](const GaussPoints<dim> &p) { return p.present && softens(p.law); };
  return !bases_.any() && !supports_.moves() && !(softening && std::ranges::any_of(soil_.points(), loses_strength));
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::commit(::Vec x, bool softening) {
  std::vector<double> u;
  PetscFunctionBeginUser;
  PetscCall(unknowns_.displacement_of(x, true, u));
  Working forces;
  std::vector<double> sums(2 + sources_.size(), 0);
  PetscCall(working_forces(&forces));
  PetscCall(add_work(u, 0.5, forces, sums));
  soil_.deform(u);
  sums[0] = soil_.stress_work();
  soil_.commit(u, softening), bases_.commit(u), structures_.commit(u);
  share_ = trial_share_, load_time_ = trial_load_time_, borne_acceleration_ = loads_.acceleration;
  PetscCall(working_forces(&forces));
  PetscCall(add_work(u, 0.5, forces, sums));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM,
                             soil_.nodes().comm()));
  work_.stress += sums[0], work_.gravity += sums[1];
  work_.of_boundary.resize(sources_.size());
  for (size_t s = 0; s < sources_.size(); ++s) work_.of_boundary[s] += sums[2 + s];
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::accept(::Vec x) {
  std::vector<double> u;
  PetscFunctionBeginUser;
  PetscCall(unknowns_.displacement_of(x, true, u));
  soil_.accept(u, false), bases_.commit(u), structures_.commit(u);
  PetscFunctionReturn(0);
}

/// At the last converged state. What the soil did not bear when the path began counts by the share of the path.
template <int dim>
PetscErrorCode QuasiStatic<dim>::working_forces(Working *forces) const {
  PetscFunctionBeginUser;
  const auto without = [this](const std::vector<double> &unborne, std::vector<double> &force) {
    for (size_t i = 0; share_ < 1 && i < unborne.size(); ++i) force[i] -= (1 - share_) * unborne[i];
  };
  loads_.weight(load_time_, forces->gravity);
  without(unborne_parts_.gravity, forces->gravity);
  forces->loads.assign(sources_.size(), {});
  for (size_t s = 0; s < sources_.size(); ++s) {
    if (!loads_.loads(static_cast<int>(s))) continue;
    loads_.load_of(static_cast<int>(s), load_time_, forces->loads[s]);
    if (!unborne_parts_.loads.empty()) without(unborne_parts_.loads[s], forces->loads[s]);
  }
  if (supports_.moves()) PetscCall(reactions(load_time_, forces->reaction, nullptr));
  PetscFunctionReturn(0);
}

/// Adds what these forces, times `share`, do on nodal increments: `sums` has gravity behind its first entry, then the
/// boundaries.
template <int dim>
PetscErrorCode QuasiStatic<dim>::add_work(const std::vector<double> &u, double share, const Working &forces,
                                          std::vector<double> &sums) const {
  PetscFunctionBeginUser;
  const auto on_u = [&](const std::vector<double> &force) {
    double work = 0;
    for (size_t i = 0; i < force.size(); ++i) work += force[i] * u[i];
    return share * work;
  };
  sums[1] += on_u(forces.gravity);
  std::vector<double> of_source(sources_.size(), 0);
  for (size_t s = 0; s < sources_.size(); ++s) of_source[s] = on_u(forces.loads[s]);
  bases_.add_work(u, share, of_source);
  for (int i = 0; i < soil_.nodes().count() && !forces.reaction.empty(); ++i) {
    const Support<dim> *s = soil_.nodes().owned[i] ? supports_.at(i) : nullptr;
    for (int k = 0; s && k < s->count; ++k) {
      double force = 0, way = 0;
      for (int d = 0; d < dim; ++d)
        force += forces.reaction[i * dim + d] * s->direction[k][d], way += u[i * dim + d] * s->direction[k][d];
      of_source[s->source[k]] += share * force * way;
    }
  }
  for (size_t s = 0; s < sources_.size(); ++s) sums[2 + s] += of_source[s];
  PetscFunctionReturn(0);
}

template <int dim>
void QuasiStatic<dim>::serialize(Archive &archive) {
  soil_.serialize(archive);
  bases_.serialize(archive);
  archive.serialize("path", share_, borne_acceleration_);
  const ElementNodes<dim> &nodes = soil_.nodes();
  std::vector<long long> numbers;
  std::vector<double> loads;
  for (int i = 0; i < nodes.count() && !unborne_.empty(); ++i) {
    if (!nodes.owned[i]) continue;
    numbers.push_back(nodes.number[i]);
    loads.insert(loads.end(), &unborne_[i * dim], &unborne_[i * dim] + dim);
  }
  if (archive.reading()) numbers.clear(), loads.clear();
  archive.column(archive.rows("nodes of unborne loads", Belongs::to_points, numbers), "unborne loads", loads, dim);
  if (!archive.reading()) return;
  unborne_.assign(static_cast<size_t>(nodes.count()) * dim, 0);
  std::vector<long long> mine;
  for (int i = 0; i < nodes.count(); ++i) mine.push_back(nodes.number[i]);
  const LocalNumbers node_of(mine);
  for (size_t k = 0; k < numbers.size(); ++k) {
    const int i = node_of.find(numbers[k]);
    if (i >= 0 && nodes.owned[i]) std::copy_n(&loads[k * dim], dim, &unborne_[i * dim]);
  }
}

// ---- what it found ----

/// Forces of the supports on local nodes at the last converged state [N]; `of_base`, if given, receives the force of
/// each base on the soil. Collective.
template <int dim>
PetscErrorCode QuasiStatic<dim>::reactions(double load_time, std::vector<double> &reaction,
                                           std::vector<Vec<dim>> *of_base) const {
  std::vector<double> external;
  PetscFunctionBeginUser;
  soil_.internal_force(reaction, false);
  bases_.add_force(reaction, of_base);
  structures_.add_force(reaction);
  loads_.force(load_time, external);
  for (size_t i = 0; i < reaction.size(); ++i) reaction[i] -= external[i];
  for (size_t i = 0; share_ < 1 && i < reaction.size(); ++i) reaction[i] += (1 - share_) * unborne_[i];
  PetscCall(soil_.nodes().sum(reaction));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::boundary_forces(double load_time, std::vector<Vec<dim>> &force,
                                                 std::vector<Vec<dim>> &face) const {
  std::vector<double> reaction;
  PetscFunctionBeginUser;
  const ElementNodes<dim> &nodes = soil_.nodes();
  force.assign(sources_.size(), Vec<dim>{});
  PetscCall(reactions(load_time, reaction, &force));
  for (int i = 0; i < nodes.count(); ++i) {
    const Support<dim> *s = nodes.owned[i] ? supports_.at(i) : nullptr;
    for (int k = 0; s && k < s->count; ++k) {
      double along = 0;
      for (int d = 0; d < dim; ++d) along += reaction[i * dim + d] * s->direction[k][d];
      for (int d = 0; d < dim; ++d) force[s->source[k]][d] += along * s->direction[k][d];
    }
  }
  if (!force.empty())
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force[0].data(), static_cast<int>(force.size()) * dim, MPI_DOUBLE, MPI_SUM,
                               nodes.comm()));
  PetscCall(loads_.mean_displacement(face));
  PetscFunctionReturn(0);
}

template class QuasiStatic<2>;
template class QuasiStatic<3>;

}  // namespace talus
