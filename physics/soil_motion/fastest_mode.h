#pragma once
/// Largest frequency of elastic motion of the filled mesh by power iteration, docs/theory (5.7), for scenes that bound
/// the step by the mesh. Starts from the mode found last, so that a few iterations suffice at a remap. The quotient
/// comes from below.
#include <array>
#include <memory>
#include <vector>

#include "base/archive.h"
#include "particles/body.h"
#include "physics/soil_motion/soil_state.h"

namespace talus {

template <int dim>
class FastestMode {
 public:
  /// `smallest_mass`: lighter nodes are carried along, docs/theory (3.7) [kg].
  FastestMode(const BackgroundMesh<dim> &mesh, double smallest_mass) : mesh_(mesh), smallest_mass_(smallest_mass) {}

  /// Angular frequency after some `iterations` [1/s], from the cells of `state` and the stress points of the bodies.
  /// Collective.
  PetscErrorCode find(FilledGrid<dim> &grid, const SoilState<dim> &state,
                      const std::vector<std::unique_ptr<Body<dim>>> &bodies, const std::vector<PointSet> &points,
                      int iterations, double *omega);
  void serialize(Archive &archive);

 private:
  void measure_elasticity(const FilledGrid<dim> &grid, const SoilState<dim> &state,
                          const std::vector<std::unique_ptr<Body<dim>>> &bodies, const std::vector<PointSet> &points);
  PetscErrorCode start(const FilledGrid<dim> &grid);
  double elastic_force(const FilledGrid<dim> &grid, const SoilState<dim> &state);

  const BackgroundMesh<dim> &mesh_;
  double smallest_mass_;
  std::vector<Vec<dim>> mode_;                     ///< [mesh node] [m]; empty before the first search
  std::vector<Vec<dim>> wave_, force_;             ///< [node] [m], [N]
  std::vector<std::array<double, 2>> elasticity_;  ///< [cell] Lame's constant and shear modulus [Pa]
};

}  // namespace talus
