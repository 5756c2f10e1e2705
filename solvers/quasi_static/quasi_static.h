#pragma once
/// Quasi-static equilibrium by finite elements on the active cells of the background mesh, docs/theory/finite_elements.md. Stress and
/// history live at Gauss points and go through the laws' own stress update; supports and loads are the scene's boundaries; strains are
/// small: geometry is that of the mesh. One class for plane strain and 3D.
#include <petscsnes.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "physics/laws/update_stress.h"
#include "scene/scene.h"
#include "solvers/quasi_static/pore_flow.h"
#include "solvers/quasi_static/supports.h"

namespace talus {

using NonlinearSolver = Owned<SNES, SNESDestroy>;

/// What the problem takes from the rest of the program.
template <int dim>
struct SoilData {
  /// Total density of a body at a place and time of the loads [kg/m3].
  std::function<double(const BodySource &, const Vec<dim> &, double)> density;
  /// Pore pressure at a place and time of the loads [Pa]; empty where the scene has none.
  std::function<double(const Vec<dim> &, double)> pressure;
  bool open_water_load = true;
  /// Water whose pressure and weight the soil carries instead, where it flows; else null.
  const PoreFlow<dim> *flow = nullptr;
};

/// The Gauss points of one body. Arrays have one row per point, those of a cell together.
template <int dim>
struct GaussPoints {
  Law law;
  bool present = true;                   ///< the body is there in this stage
  std::vector<int> cell;                 ///< of points
  std::vector<double> volume;            ///< [m3]
  std::vector<Vec<dim>> position;        ///< [m]
  std::vector<double> stress, history;   ///< at the last converged state, as laws store them
  std::vector<double> total_strain;      ///< since displacement was last reset [stress_size]
  std::vector<double> trial_stress, trial_history;
  std::vector<Increment<dim>> increment;
  std::vector<int> number;               ///< 0, 1, ...: each point has an increment of its own
  std::vector<double> size;              ///< element size of softening laws [m]
  std::vector<double> suction;           ///< at the loads of the step, for laws that read it [Pa]
  int count() const { return static_cast<int>(cell.size()); }
  /// From the converged state to the trial one by `increment`.
  StressPoints<dim> trial() {
    return {count(), stress.data(), history.data(), trial_stress.data(), trial_history.data(), number.data(), increment.data(), size.data(),
            suction.empty() ? nullptr : suction.data()};
  }
};

/// How a load step ended.
struct StepOutcome {
  bool converged = false;
  int iterations = 0;
  double residual = 0;      ///< out-of-balance force over the size of the forces
  double largest = 0;       ///< largest displacement of a node in the step [m]
  bool blown_up = false;    ///< it passed the limit of displacement
  bool singular = false;    ///< the linear system had no solution
};

template <int dim>
class QuasiStatic {
 public:
  using Source = typename Supports<dim>::Source;
  /// Gauss points of all bodies, stresses zero. The references must outlive the problem.
  QuasiStatic(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws, const std::vector<Source> &sources,
              SoilData<dim> data);

  /// Takes these bodies (by their place in the scene) into the problem and leaves out the others. Nodes keep their displacement;
  /// new ones have none. Collective.
  PetscErrorCode activate(const std::vector<char> &present);
  /// Rigid motions that the supports leave to some piece of soil, in words; empty if there are none. Collective.
  PetscErrorCode find_freedom(std::string *freedom) const;  // freedom.cpp
  /// Bodies without a vertex inside: one element across. Collective.
  PetscErrorCode find_thin_bodies(std::vector<char> *thin) const;  // freedom.cpp
  /// Begins a path from the present state at `load_time`: what is out of balance there is released along the path.
  PetscErrorCode begin_path(double load_time);
  /// Solves for the state at `share` of the path, with loads of `load_time`; prescribed motion acts over (time, time + dt). The state
  /// is committed if it converges, else left as it was.
  PetscErrorCode advance(double share, double load_time, double time, double dt, bool softening, StepOutcome *outcome);
  /// The parts of `advance`, for problems with more unknowns than displacement (flow_step.h): what stands before the iterations, `x` being
  /// where they start; the out-of-balance force, with the tangent then in `matrix`; and the acceptance of what was found.
  PetscErrorCode prepare(double share, double load_time, double time, double dt, ::Vec x);
  PetscErrorCode residual(::Vec x, ::Vec f);
  PetscErrorCode tangent() { return stiffness(matrix_, nullptr, nullptr); }
  PetscErrorCode commit(::Vec x, bool softening);
  Mat matrix() const { return matrix_; }
  double force_scale() const { return force_scale_; }  ///< what forces are small against [N]
  void close_scale() { scale_open_ = false; }          ///< an iterate that goes astray must not widen it
  /// Displacement counts from here; so does plastic strain.
  void reset_displacement();
  /// A state to come back to.
  struct State {
    std::vector<GaussPoints<dim>> points;
    std::vector<double> displacement;
  };
  State save() const { return {points_, displacement_}; }
  void restore(const State &state) { points_ = state.points, displacement_ = state.displacement; }
  /// Brings the present stress to what the laws admit now, as after a change of strength.
  void admit();

  std::vector<GaussPoints<dim>> &points() { return points_; }
  const std::vector<GaussPoints<dim>> &points() const { return points_; }
  const BackgroundMesh<dim> &mesh() const { return mesh_; }
  const ElementNodes<dim> &nodes() const { return nodes_; }
  const Supports<dim> &supports() const { return supports_; }
  const std::vector<char> &active() const { return active_; }
  const std::vector<int> &bodies() const { return body_of_; }
  int points_per_cell() const { return static_cast<int>(rule_.point.size()); }
  const Quadrature<dim> &rule() const { return rule_; }
  /// Displacement at a place of a cell given in barycentric coordinates [m].
  Vec<dim> displacement(int cell, const Barycentric<dim> &place) const;
  /// First point of a cell in its body; -1 if the body is not there.
  int first_point(int cell) const { return first_point_[cell]; }
  int body_of(int cell) const { return body_of_[cell]; }
  /// Force of each boundary on the soil [N] and mean displacement of each loaded face [m], at the last converged state. Collective.
  PetscErrorCode boundary_forces(double load_time, std::vector<Vec<dim>> &force, std::vector<Vec<dim>> &face) const;
  /// Largest displacement of a node [m]; collective.
  double largest_displacement() const;
  long long unknowns() const { return unknowns_; }
  bool direct() const { return direct_; }

  double blow_up = 0;  ///< largest displacement in a step that is not taken for failure [m]; 0: none

 private:
  static constexpr int components = stress_size<dim>;

  /// Cells that are integrated together: one, or a patch that shares its volumetric strain.
  struct Group {
    int body, first_point, points;
    int first_node, nodes;        ///< in group_node_
    size_t first_gradient;        ///< in gradient_: [point][node]
    size_t mean_gradient;         ///< in gradient_: [node]
  };
  struct LoadedFacet {
    Facet<dim> facet;
    int source;
    double share;
    std::vector<int> node;
  };

  void place_points();
  void make_groups(const std::vector<char> &active);
  PetscErrorCode make_matrix();
  PetscErrorCode make_solver();
  void strain_increments(const std::vector<double> &u);
  void update_stresses();
  void find_suction(double t);
  double pore_pressure(const Vec<dim> &x, double t) const;
  void internal_force(std::vector<double> &force, bool trial) const;
  void external_force(double t, std::vector<double> &force) const;
  Vec<dim> traction_of(const LoadedFacet &load, const Vec<dim> &x, double t) const;
  PetscErrorCode stiffness(Mat matrix, const std::vector<double> *motion, std::vector<double> *lift);
  PetscErrorCode near_null_space();
  PetscErrorCode displacement_of(::Vec x, bool with_motion, std::vector<double> &u) const;
  void impose(double *global, bool clear) const;
  static PetscErrorCode snes_function(SNES, ::Vec, ::Vec, void *);
  static PetscErrorCode snes_jacobian(SNES, ::Vec, Mat, Mat, void *);
  static PetscErrorCode snes_converged(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason *, void *);

  const BackgroundMesh<dim> &mesh_;
  const Scene &scene_;
  const std::vector<Source> &sources_;
  SoilData<dim> data_;
  int order_;
  bool patches_;
  Quadrature<dim> rule_, load_rule_;
  Quadrature<dim - 1> facet_rule_;
  std::vector<GaussPoints<dim>> points_;
  std::vector<int> body_of_, first_point_;   // of cells
  std::vector<char> active_;                 // cells

  ElementNodes<dim> nodes_;
  Supports<dim> supports_;
  std::vector<LoadedFacet> loads_;
  std::vector<Group> groups_;
  std::vector<int> group_node_;
  std::vector<Vec<dim>> gradient_;
  std::vector<PetscInt> owned_, owned_supported_;  // local nodes in the order of their rows; those with a support

  std::vector<double> displacement_;         // of local nodes, committed
  std::vector<double> displacement_of_point_;  // the same by point of the DMPlex, kept while nodes come and go
  Matrix matrix_;
  NonlinearSolver solver_;
  Vector x_, f_, out_of_balance_, target_, internal_, scratch_;
  std::vector<double> motion_;               // prescribed increments of owned nodes in their frames [row * dim]
  bool suction_matters_ = false;             // a law reads it: pressure below zero is suction, not stress
  double force_scale_ = 0, stiffness_scale_ = 1;  // sizes of the forces before the first iteration [N] and of stiffness [Pa]
  bool scale_open_ = true;
  bool direct_ = true, blown_up_ = false;
  long long unknowns_ = 0;
};

}  // namespace talus
