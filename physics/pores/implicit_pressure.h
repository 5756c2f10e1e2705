#pragma once
/// Pore pressure that is implicit in time, docs/theory/pores.md section 8: what its solve keeps at nodes and cells, and
/// the solve.
#include <vector>

#include "physics/boundary/prescribed_motion.h"
#include "physics/pores/conjugate_gradients.h"
#include "physics/pores/pressure_matrices.h"
#include "physics/pores/pressure_solves.h"

namespace talus {

/// What the solve of a step finds at its start.
template <int dim>
struct StepStart {
  FilledGrid<dim> &grid;
  const PrescribedMotion<dim> &supports;
  const Shape<dim> *shape;  ///< [cell]
  const double *weight;     ///< [cell]
  double step;              ///< [s]
};

template <int dim>
struct ImplicitPressure {
  using Array = std::vector<double>;

  ImplicitPressure(bool acts, const BackgroundMesh<dim> &mesh);

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
  /// into `change`. `changed`: it is not zero. Collective.
  PetscErrorCode solve(const StepStart<dim> &at, bool *changed);
  /// The step has its pressures: counts its iterations.
  void end();
  /// Nodes to particles and back of velocities [field][node], with the matrix of the operator. Collective.
  PetscErrorCode to_particles_and_back(FilledGrid<dim> &grid, const Vec<dim> *in, Vec<dim> *out);
  /// Finds `push` of pressures of nodes. Collective.
  PetscErrorCode find_push(FilledGrid<dim> &grid, const double *pressure);

  /// A node at which boundaries fix the motion of the liquid against the skeleton.
  struct Wall {
    int node;
    PrescribedDirections<dim> along;
  };

  static constexpr int at_gap = PressureMatrices<dim>::gap;  ///< lane of `push`

  bool acts;
  PressureSolves done;
  ConjugateGradients gradients;
  PressureMatrices<dim> matrices;
  // cells
  Array modulus;    ///< - dP over the strain of the pores: K / n [Pa]
  Array unbounded;  ///< pressure by the content, also below that of cavitation [Pa]
  // nodes
  Array volume;            ///< sum of w / (d + 1) [m3]
  Array particle_volume;   ///< the same of the volumes of the particles [m3]
  Array acting;            ///< pressure that acts in the step [Pa]
  Array change;            ///< of it, by a solve [Pa]
  Array before;            ///< the same in the last step, from which the next solve starts [Pa]
  Array held;              ///< strain of the pores that has this pressure
  Array strain;            ///< that of the step
  Array stiffness;         ///< - dP over strain [Pa]
  Array solid, apart;      ///< velocity of the skeleton, and of the liquid against it, over an impulse of `push` [1/kg]
  Array supported;         ///< velocity of the liquid over an impulse of `push` where the skeleton is held [1/kg]
  Array porosity;          ///< share of `push` on the liquid
  std::vector<Quad> push;  ///< sum of w p grad N [N], and of w p times the shares of gaps [N m]
  std::vector<Vec<dim>> after_drag, mapped;  ///< velocities [field][node] [m/s]
  std::vector<Wall> walls;
  std::vector<typename PressureMatrices<dim>::GapCorner> gap_corners;
  const Vec<dim> *gap = nullptr;  ///< of a node: area of the gap over volume, theory of pores (5.1) [1/m]
  Array gap_solid, gap_apart;     ///< as `solid` and `apart`, over an impulse of a gap, which liquid and grains share

 private:
  PetscErrorCode find_squeezed(const StepStart<dim> &at, double *pressure);
  PetscErrorCode map_velocities(FilledGrid<dim> &grid);
  PetscErrorCode find_velocities(const StepStart<dim> &at, const double *x);
  PetscErrorCode apply(const StepStart<dim> &at, const double *x, double *y);
  PetscErrorCode add_strain_by(const StepStart<dim> &at, const double *x);
  PetscErrorCode find_diagonal(const StepStart<dim> &at);
  PetscErrorCode fit_held(const StepStart<dim> &at, double allowed);
  PetscErrorCode start_as_before(const StepStart<dim> &at, double *lacking, double *share);
  PetscErrorCode correct(const StepStart<dim> &at, double enough);
  PetscErrorCode find_flux_divergence(const StepStart<dim> &at, double *y);
  void stop_at_walls(std::vector<NodalPair> &velocity) const;
  template <class... Terms>
  std::array<double, sizeof...(Terms)> sum(const StepStart<dim> &at, Terms &&...term) const;

  bool starts_ = false;       ///< no solve in the step yet
  double first_ = 0;          ///< volume times the square of what pressures lack at the first solve of a step
  double lacking_ = 0;        ///< share of the pressure that the last solve left; 0: no more than is allowed
  long long iterations_ = 0;  ///< in the step
  Array correction_, wanted_, image_, diagonal_, sums_;
  std::vector<int> numbers_;                  ///< mesh nodes of `before`
  int numbered_ = 0;                          ///< how many
  Array of_mesh_node_;                        ///< scratch, zero
  Array counts_;                              ///< 1 on the one rank that counts a node, otherwise 0
  std::vector<NodalPair> velocity_, mapped_;  ///< by `push`, before and after S
};

}  // namespace talus
