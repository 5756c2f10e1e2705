#pragma once
/// Largest frequency of elastic motion of the filled mesh by power iteration, docs/theory (5.7), for scenes that bound
/// the step by the mesh. Fluids that move on their own are fields beside the skeleton; drag, which lowers frequencies,
/// is left out. Starts from the mode found last, so that a few iterations suffice at a remap. The estimate comes from
/// below.
#include <array>
#include <memory>
#include <vector>

#include "base/archive.h"
#include "base/phases.h"
#include "particles/body.h"
#include "physics/pores/pore_stiffness.h"
#include "physics/soil_motion/soil_state.h"

namespace talus {

/// `fields`: the skeleton and the fluids that move on their own.
template <int dim, int fields>
class FastestMode {
 public:
  /// `smallest_mass`: lighter nodes are carried along, docs/theory (3.7) [kg]. `pores` of each body.
  FastestMode(const BackgroundMesh<dim> &mesh, double smallest_mass, std::vector<PoreStiffness> pores)
      : mesh_(mesh), smallest_mass_(smallest_mass), pores_(std::move(pores)) {}

  /// Angular frequency after some `iterations`, at least 2 [1/s], from the cells of `state` and the stress points of
  /// the bodies. Not a number where no cell is filled. Collective.
  PetscErrorCode find(FilledGrid<dim> &grid, const SoilState<dim> &state,
                      const std::vector<std::unique_ptr<Body<dim>>> &bodies, const std::vector<PointSet> &points,
                      int iterations, double *omega);
  void serialize(Archive &archive);

 private:
  static constexpr int fluids = fields - 1;
  struct Elasticity {
    double lame = 0, shear = 0;  ///< of the skeleton [Pa]
    [[no_unique_address]] If<fluids != 0, double> porosity{};
    std::array<double, fluids> pore_modulus{}, inertia{};  ///< K_a / n [Pa], n rho_a [kg/m3]
  };
  void measure_elasticity(const FilledGrid<dim> &grid, const SoilState<dim> &state,
                          const std::vector<std::unique_ptr<Body<dim>>> &bodies, const std::vector<PointSet> &points);
  PetscErrorCode measure_fluid_mass(FilledGrid<dim> &grid, const SoilState<dim> &state);
  PetscErrorCode start(const FilledGrid<dim> &grid);
  double elastic_force(const FilledGrid<dim> &grid, const SoilState<dim> &state);

  const BackgroundMesh<dim> &mesh_;
  double smallest_mass_;
  std::vector<PoreStiffness> pores_;
  std::vector<Vec<dim>> mode_[fields];                  ///< [mesh node] [m]; empty before the first search
  std::vector<Vec<dim>> wave_, force_;                  ///< [field][node] [m], [N]
  std::array<std::vector<double>, fluids> fluid_mass_;  ///< [node] [kg]
  std::vector<Elasticity> elasticity_;                  ///< [cell]
};

}  // namespace talus
