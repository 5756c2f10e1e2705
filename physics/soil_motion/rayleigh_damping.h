#pragma once
/// Rayleigh damping of the soil, docs/theory/earthquakes.md section 9: a force -alpha m v at the nodes, and in the
/// cells the stress by which beta of the present straining would change that of the law. No stress point stores it.
#include <array>
#include <memory>
#include <vector>

#include "particles/body.h"
#include "physics/soil_motion/cell_increments.h"
#include "physics/soil_motion/cell_stress.h"
#include "physics/soil_motion/patch_means.h"
#include "physics/soil_motion/soil_state.h"
#include "scene/rayleigh.h"

namespace talus {

template <int dim>
class RayleighDamping {
 public:
  /// Takes room only where a body has a damping ratio.
  RayleighDamping(const BackgroundMesh<dim> &mesh, const std::vector<std::unique_ptr<Body<dim>>> &bodies);

  /// Is soil damped in a stage with these frequencies [Hz]?
  bool acts(const std::array<double, 2> &frequencies) const { return !of_body_.empty() && frequencies[1] > 0; }
  /// The factors of the bodies from now on.
  void set(const std::array<double, 2> &frequencies);
  const Rayleigh &of(size_t body) const { return of_body_[body]; }

  /// Rates of strain of the cells from the velocity of their nodes [m/s], cured of locking as increments of strain are.
  /// `nodal` has room for two numbers per node. Collective.
  PetscErrorCode find_rates(FilledGrid<dim> &grid, const Vec<dim> *velocity, const SoilState<dim> &state,
                            Locking locking, PatchMeans &patches, std::vector<double> &nodal);
  /// The strain of a body in beta [cell].
  const Increment<dim> *strain_ahead(size_t body, int cells);
  /// Where its law puts the stress after that strain, and the history, which nobody reads.
  double *stress(size_t body, int points);
  double *history(size_t body, int points);
  /// Takes the stress at present off that ahead; without `present` the body has no such stress.
  void take_off(size_t body, const double *present, int points);
  /// Adds the forces of this rank's cells to `force` [node] [N].
  void add_forces(const FilledGrid<dim> &grid, const std::vector<PointSet> &points, const SoilState<dim> &state,
                  Locking locking, PatchMeans &patches, Vec<dim> *force);
  /// The same that were added last, for the work that they do.
  const Vec<dim> *forces() const { return force_.data(); }

  /// alpha at the nodes, the mean of what they have of each body. Collective.
  PetscErrorCode find_mass_factors(FilledGrid<dim> &grid, const std::vector<PointSet> &points,
                                   const SoilState<dim> &state);
  double mass_factor(int node) const { return mass_factor_[node]; }

 private:
  std::vector<double> ratio_;      ///< of the bodies; empty: none has any
  std::vector<Rayleigh> of_body_;  ///< likewise
  std::vector<int> history_count_;
  CellIncrements<dim> rates_;             ///< per second
  std::vector<Increment<dim>> ahead_;     ///< [cell]
  std::vector<std::vector<double>> own_;  ///< [body] stress ahead, then what it adds to that at present [Pa]
  std::vector<double *> stress_;          ///< [body] the same
  std::vector<double> history_;
  CellStress<dim> mean_;
  std::vector<Vec<dim>> force_;  ///< [node] [N]
  std::vector<double> cell_factor_, mass_factor_;
};

}  // namespace talus
