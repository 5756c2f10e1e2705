#pragma once
/// Quasi-static equilibrium by finite elements, docs/theory/finite_elements.md: Newton's iterations along a path of
/// loads. What the soil does is in soil_elements.h, what loads it in loads.h, what holds it in supports.h, what is
/// unknown in unknowns.h. One class for plane strain and 3D.
#include <petscsnes.h>

#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "solvers/quasi_static/base_contact.h"
#include "solvers/quasi_static/hanging_pieces.h"
#include "solvers/quasi_static/loads.h"
#include "solvers/quasi_static/soil_elements.h"
#include "solvers/quasi_static/structures_in_soil.h"
#include "solvers/quasi_static/unknowns.h"

namespace talus {

using NonlinearSolver = Owned<SNES, SNESDestroy>;

/// How a load step ended.
struct StepOutcome {
  bool converged = false;
  int iterations = 0;
  double residual = 0;     ///< out-of-balance force over the size of the forces
  double largest = 0;      ///< largest displacement of a node in the step [m]
  bool singular = false;   ///< the linear system had no solution
  bool fails = false;      ///< a mechanism of failure was found for the loads at the end of the path
  bool undrained = false;  ///< that mechanism is one of soil whose pore water does not flow
  double crawl = 0;        ///< steps became shorter than this, in which no water drains [s]; 0: they did not
  bool stopped = false;    ///< somebody asked the program to stop
  bool dry = false;        ///< pores would need a suction at which soil has no water, or water tears
  bool shut = false;       ///< water that enters has no way out but by pressures beyond any soil
  std::string moving;      ///< soil on bases that moves although its prop gives way: where, how much, and on what
  std::string
      moved_most;  ///< soil on bases in the last of iterations that were lost, which may move for no other reason
};

/// Work on the soil along the paths so far, by forces that are the means of those at the ends of each step: exact where
/// they are linear in between. The same on all ranks [J].
struct PathWork {
  double stress = 0;                ///< on the strains: the sum of all work
  double gravity = 0;               ///< and what else pulls on all mass
  std::vector<double> of_boundary;  ///< by loads, prescribed motion and bases
  /// The rest: by pore pressure, body accelerations, structures, and forces that were out of balance when a path began.
  double imposed() const { return stress - gravity - std::accumulate(of_boundary.begin(), of_boundary.end(), 0.); }
};

template <int dim>
class QuasiStatic {
 public:
  using Source = typename Loads<dim>::Source;
  /// The references must outlive the problem.
  QuasiStatic(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws,
              const std::vector<Source> &sources, SoilData<dim> data)
      : scene_(scene),
        sources_(sources),
        data_(std::move(data)),
        soil_(mesh, scene, laws, data_),
        loads_(soil_, scene, sources, data_),
        bases_(soil_, sources),
        structures_(soil_, supports_, data_.structures),
        unknowns_(soil_, supports_),
        borne_acceleration_(loads_.acceleration) {}
  QuasiStatic(const QuasiStatic &) = delete;  // its parts know each other's place

  /// Takes these bodies (by their place in the scene) into the problem and leaves out the others. Collective.
  PetscErrorCode activate(const std::vector<char> &present);
  /// Rigid motions that supports, and bases with their strength at `load_time`, leave to some piece of soil, in words;
  /// empty if there are none. Collective.
  PetscErrorCode find_freedom(double load_time, std::string *freedom);  // freedom.cpp
  /// Gravity, and what else pulls on all mass along the next paths [m/s2].
  void set_acceleration(const std::array<double, 3> &of) { std::copy_n(of.begin(), dim, loads_.acceleration.begin()); }
  /// Begins a path from the present state at `load_time`: what is out of balance there is released along the path.
  PetscErrorCode begin_path(double load_time);
  /// Solves for the state at `share` of the path, with loads of `load_time`; prescribed motion acts over (time, time +
  /// dt). The state is committed if it converges, else left as it was.
  PetscErrorCode advance(double share, double load_time, double time, double dt, bool softening, StepOutcome *outcome);
  /// May soil creep where the iterations of `advance` lead nowhere, see LimitState? Its strength and its supports then
  /// stay what they are.
  bool may_creep(bool softening) const;
  /// The parts of `advance`, for problems with more unknowns than displacement (flow_step.h): what stands before the
  /// iterations, `x` being where they start; the out-of-balance force, with the tangent then in `matrix`; and the
  /// acceptance of what was found.
  PetscErrorCode prepare(double share, double load_time, double time, double dt, ::Vec x);
  PetscErrorCode residual(::Vec x, ::Vec f);
  PetscErrorCode tangent() { return stiffness(1, 0); }
  /// Puts `plastic` times the tangent of the laws at the trial state plus `elastic` times the elastic stiffness into
  /// `matrix`.
  PetscErrorCode stiffness(double plastic, double elastic) { return stiffness(plastic, elastic, nullptr, nullptr); }
  /// Solves `matrix` x = b; `solved` is false where the matrix is singular.
  PetscErrorCode solve_linear(::Vec b, ::Vec x, bool *solved);
  ::Vec loads() const { return target_; }  ///< nodal forces that the soil has to carry after `prepare` [N]
  PetscErrorCode commit(::Vec x, bool softening);
  /// Soil and bases go on from the trial state of the last `residual(x)`; without its work, and without softening.
  PetscErrorCode accept(::Vec x);
  Mat matrix() const { return matrix_; }
  double force_scale() const { return force_scale_; }  ///< what forces are small against [N]
  void close_scale() { scale_open_ = false; }          ///< an iterate that goes astray must not widen it

  SoilElements<dim> &soil() { return soil_; }
  const SoilElements<dim> &soil() const { return soil_; }
  const Supports<dim> &supports() const { return supports_; }
  BaseContact<dim> &bases() { return bases_; }
  StructuresInSoil<dim> &structures() { return structures_; }
  /// Friction of bases in trials, and of the bonds of structures, is that of the trial stress from now on. `change`: by
  /// how much that changes it, over all of it [-]. Collective.
  PetscErrorCode follow_normal_forces(double *change);
  /// A state of the soil and of its bases to come back to.
  struct State {
    typename SoilElements<dim>::State soil;
    typename BaseContact<dim>::State bases;
    typename StructuresInSoil<dim>::State structures;
    double share, load_time;
    Vec<dim> borne_acceleration;
    PathWork work;
  };
  State save() const {
    return {soil_.save(), bases_.save(), structures_.save(), share_, load_time_, borne_acceleration_, work_};
  }
  void restore(const State &state) {
    soil_.restore(state.soil), bases_.restore(state.bases), structures_.restore(state.structures);
    work_ = state.work;
    share_ = state.share, load_time_ = state.load_time, borne_acceleration_ = state.borne_acceleration;
  }
  const PathWork &work() const { return work_; }
  void set_work(const PathWork &work) { work_ = work; }
  /// The state in a checkpoint, between two paths.
  void serialize(Archive &archive);
  /// Force of each boundary on the soil [N] and mean displacement of each loaded face [m], at the last converged state.
  /// On the way along a path the loads that the soil did not bear at its begin count by the share of the path, as they
  /// do in the equilibrium. Collective.
  PetscErrorCode boundary_forces(double load_time, std::vector<Vec<dim>> &force, std::vector<Vec<dim>> &face) const;
  long long unknowns() const { return unknowns_.count(); }
  bool direct() const;  ///< the linear solver; else it is GMRES with algebraic multigrid
  /// Lets `ksp` solve systems of `matrix`, which is symmetric and positive definite or not. PETSc's options change all
  /// of it. Collective.
  PetscErrorCode prepare_linear_solver(KSP ksp, bool symmetric);
  /// Pieces that hang, and that no base holds, since `activate`.
  const LeftOut<dim> &left_out() const { return left_out_; }

  std::function<bool()> stop_asked;  ///< ends iterations when it is true; collective; may be empty
  /// Told of each iteration for equilibrium: its number, and the force out of balance over the forces that act; may be
  /// empty.
  std::function<void(int, double)> iterated;

 private:
  /// Nodal forces that do work on the soil, this rank's part [N].
  struct Working {
    std::vector<double> gravity, reaction;   ///< `reaction` on the rank that owns a node; empty where no support moves
    std::vector<std::vector<double>> loads;  ///< by source; empty for those that do not load
  };
  PetscErrorCode working_forces(Working *forces) const;
  PetscErrorCode reactions(double load_time, std::vector<double> &reaction, std::vector<Vec<dim>> *of_base) const;
  PetscErrorCode add_work(const std::vector<double> &u, double share, const Working &forces,
                          std::vector<double> &sums) const;
  PetscErrorCode make_solver(SNESLineSearchType line_search = SNESLINESEARCHCP);
  PetscErrorCode activate_again();
  // soil_on_bases.cpp
  enum class Way { balanced, moving, lost };
  PetscErrorCode share_of_step(::Vec direction, ::Vec last, double *share);
  PetscErrorCode relax(int *iterations, double *unbalanced, Way *way);
  PetscErrorCode find_moving(::Vec direction, const char *how);
  PetscErrorCode leave_out_hanging(bool *found);
  PetscErrorCode advance_on_bases(double share, double load_time, double time, double dt, StepOutcome *outcome);
  // quasi_static.cpp
  PetscErrorCode start_with_motion(const std::vector<double> &motion, ::Vec x);
  PetscErrorCode stiffness(double plastic, double elastic, const std::vector<double> *motion,
                           std::vector<double> *lift);
  static PetscErrorCode snes_function(SNES, ::Vec, ::Vec, void *);
  static PetscErrorCode snes_jacobian(SNES, ::Vec, Mat, Mat, void *);
  static PetscErrorCode snes_converged(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason *, void *);

  const Scene &scene_;
  const std::vector<Source> &sources_;
  SoilData<dim> data_;
  SoilElements<dim> soil_;
  Loads<dim> loads_;
  Supports<dim> supports_;
  BaseContact<dim> bases_;
  StructuresInSoil<dim> structures_;
  Unknowns<dim> unknowns_;
  SparseMatrix matrix_;
  NonlinearSolver solver_;
  Vector x_, f_, out_of_balance_, target_, lifted_;
  double force_scale_ = 0,
         stiffness_scale_ = 1;          // sizes of the forces before the first iteration [N] and of stiffness [Pa]
  double share_ = 1, trial_share_ = 1;  ///< of the path, at the converged state and at the one that is being solved
  std::vector<double> unborne_;         ///< [local nodes][dim] loads at the begin of the path that come along it [N]
  Working unborne_parts_;               ///< likewise
  double load_time_ = 0, trial_load_time_ = 0;  ///< of the loads, likewise [s]
  PathWork work_;
  Vec<dim> borne_acceleration_;  ///< under which the soil was at the last converged state [m/s2]
  bool scale_open_ = true;
  /// Whether the last iterate is in equilibrium. PETSc's reason is not enough: its search for a critical point calls an
  /// iterate that went astray converged where force and step are perpendicular.
  bool balanced_ = false;
  double least_ = 0;  ///< out-of-balance force that counts as an advance of the iterations, halved with each [N]
  int since_ = 0;     ///< iterations since the last advance
  bool stopped_ = false;
  std::vector<char> present_;  ///< bodies
  LeftOut<dim> left_out_;
  CellSet moving_;            ///< cells that moved when `relax` ended
  std::string moving_where_;  ///< the same in words
};

}  // namespace talus
