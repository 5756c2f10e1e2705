#pragma once
/// Pore pressure that is implicit in time, docs/theory/pores.md section 8: what its solve keeps at nodes and cells, and
/// the solve.
#include <vector>

#include "physics/pores/biconjugate_gradients.h"
#include "physics/pores/conjugate_gradients.h"
#include "physics/pores/drying_pores.h"
#include "physics/pores/open_pores.h"
#include "physics/pores/pressure_matrices.h"
#include "physics/pores/pressure_solves.h"
#include "physics/pores/step_start.h"

namespace talus {

template <int dim>
struct ImplicitPressure {
  using Array = std::vector<double>;

  /// `suction`: pores may dry. `patches`: the skeleton has one mean stress per patch.
  ImplicitPressure(bool acts, bool suction, bool patches, const BackgroundMesh<dim> &mesh);

  /// Finds the rows of a grid that has been filled anew.
  void begin_part(const FilledGrid<dim> &grid);
  /// The nodes of `before` are those of the grid.
  void number_nodes(const FilledGrid<dim> &grid);
  /// Finds the pressures that act without a strain of the step. Cells have their modulus, pressure and volumes, nodes
  /// their mobilities. Collective.
  PetscErrorCode begin(const StepStart<dim> &at);
  /// Strain of the pores at the nodes over displacements u [1 + fluids][nodes], theory (8.3). Collective.
  PetscErrorCode find_strain(const StepStart<dim> &at, const Vec<dim> *u);
  /// Finds the change of pressure after which pressures fit the strain, which follows the change by the operator (8.5):
  /// into `change`, and that of what the skeleton bears into `mixture_change`. `changed`: it is not zero. Collective.
  PetscErrorCode solve(const StepStart<dim> &at, bool *changed);
  /// The step has its pressures: counts its iterations.
  void end();
  /// Nodes to particles and back of velocities [field][node], with the matrix of the operator. Collective.
  PetscErrorCode to_particles_and_back(FilledGrid<dim> &grid, const Vec<dim> *in, Vec<dim> *out);
  /// Finds `push` of pressures on the liquid, and `mixture_push` of those on the skeleton and the liquid. Collective.
  PetscErrorCode find_push(const StepStart<dim> &at, const double *pressure, const double *mixture);
  /// Force on the skeleton and the liquid of a node, without its gaps [N].
  Quad on_mixture(int i) const { return open.acts ? mixture_push[i] : push[i]; }

  /// A node at which boundaries fix the motion of the liquid against the skeleton.
  struct Wall {
    int node;
    double share;  ///< of the liquid in the mass of the node
    PrescribedDirections<dim> along;
  };

  /// A node of whose velocity a dashpot leaves `rest` v in a step.
  struct Damped {
    int node;
    double free;  ///< part of a change of the skeleton's velocity that the liquid does not follow
    Square<dim> rest;
  };

  static constexpr int at_gap = PressureMatrices<dim>::gap;  ///< lane of `push`

  bool acts;
  PressureSolves done;
  ConjugateGradients gradients;
  StabilisedBiconjugateGradients skew_gradients;  ///< where pores may dry: suction does not act on the skeleton
  PressureMatrices<dim> matrices;
  OpenPores<dim> open;
  // cells
  Array modulus;                    ///< - dP over the strain of the pores: K / n [Pa]
  Array unbounded;                  ///< pressure by the content, were pores full of liquid, however low it is [Pa]
  std::vector<DryingPores> drying;  ///< where pores may dry
  const Liquid *liquid = nullptr;
  // points of pressure: the nodes, and after them the cells where pores may dry, of which open ones count
  Array volume;           ///< sum of w / (d + 1); of the particles of an open cell [m3]
  Array particle_volume;  ///< the same of the volumes of the particles [m3]
  Array acting;           ///< pressure that acts in the step [Pa]
  Array change;           ///< of it, by a solve [Pa]
  Array before;           ///< the same in the last step, from which the next solve starts [Pa]
  Array held;             ///< strain of the pores that has this pressure
  Array strain;           ///< that of the step
  Array stiffness;        ///< - dP over strain [Pa]
  Array mixture_change;   ///< of the pressure that the skeleton bears, by a solve [Pa]
  // nodes
  Array solid, apart;      ///< velocity of the skeleton, and of the liquid against it, over an impulse of `push` [1/kg]
  Array supported;         ///< velocity of the liquid over an impulse of `push` where the skeleton is held [1/kg]
  Array porosity;          ///< share of `push` on the liquid
  std::vector<Quad> push;  ///< sum of w p grad N [N], and of w p times the shares of gaps [N m]
  std::vector<Quad> mixture_push;            ///< the same of the pressures on the skeleton, where pores may dry
  bool bishop = false;                       ///< the skeleton bears S_l P; otherwise pressure, but no suction
  std::vector<Vec<dim>> after_drag, mapped;  ///< velocities [field][node] [m/s]
  std::vector<Wall> walls;
  std::vector<Damped> damped;
  std::vector<typename PressureMatrices<dim>::GapCorner> gap_corners;
  const Vec<dim> *gap = nullptr;  ///< of a node: area of the gap over volume, theory of pores (5.1) [1/m]
  Array gap_solid,
      gap_apart;  ///< the same, over an impulse that liquid and grains share: that of a gap, or less suction

 private:
  PetscErrorCode find_squeezed(const StepStart<dim> &at, double *pressure);
  PetscErrorCode map_velocities(FilledGrid<dim> &grid);
  PetscErrorCode find_velocities(const StepStart<dim> &at, const double *x);
  PetscErrorCode apply(const StepStart<dim> &at, const double *x, double *y);
  PetscErrorCode add_strain_by(const StepStart<dim> &at, const double *x);
  PetscErrorCode find_diagonal(const StepStart<dim> &at);
  PetscErrorCode fit_held(const StepStart<dim> &at, double allowed);
  PetscErrorCode start_as_before(const StepStart<dim> &at, double *lacking, double *share);
  PetscErrorCode limit_correction(const StepStart<dim> &at);
  PetscErrorCode correct(const StepStart<dim> &at, double enough);
  PetscErrorCode find_flux_divergence(const StepStart<dim> &at, double *y);
  PetscErrorCode find_divergences(const StepStart<dim> &at, double *own, double *flux);
  int points(const StepStart<dim> &at) const { return at.grid.node_count() + (open.acts ? at.grid.cell_count() : 0); }
  /// Share of the pressure of a point that the skeleton bears.
  double borne(const StepStart<dim> &at, int k) const {
    const int cell = k - at.grid.node_count();
    return bishop ? (cell < 0 ? 1 : open.saturation[cell]) : acting[k] > 0;
  }
  const double *integrated(const StepStart<dim> &at) const { return open.acts ? open.full_weight.data() : at.weight; }
  void stop_at_walls(std::vector<NodalPair> &velocity) const;
  template <class... Terms>
  std::array<double, sizeof...(Terms)> sum(const StepStart<dim> &at, Terms &&...term) const;

  bool starts_ = false;       ///< no solve in the step yet
  double first_ = 0;          ///< volume times the square of what pressures lack at the first solve of a step
  double lacking_ = 0;        ///< share of the pressure that the last solve left; 0: no more than is allowed
  long long iterations_ = 0;  ///< in the step
  Array correction_, wanted_, image_, diagonal_, sums_, mixture_;
  std::vector<int> numbers_;                  ///< mesh nodes of `before`
  int numbered_ = 0;                          ///< how many
  Array of_mesh_node_;                        ///< scratch, zero
  Array counts_;                              ///< of a point: 1 on the one rank that counts it, otherwise 0
  std::vector<Quad> grains_, flux_;           ///< velocities of nodes, for open cells
  std::vector<NodalPair> velocity_, mapped_;  ///< by `push`, before and after S
};

}  // namespace talus
