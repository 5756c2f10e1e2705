#pragma once
/// The largest stable step 2 / omega_max of an explicit integrator, from the eigenvalue bound of the filled cells: with
/// lumped mass the largest frequency of the assembled mesh is at most the largest of any one cell (Irons & Treharne
/// 1971; Belytschko, Liu & Moran 2000, sec. 6.2). MUSL keeps light nodes from lowering it (docs/theory, section 5.2).
#include <cmath>
#include <limits>
#include <vector>

#include "base/room.h"
#include "meshes/background_mesh.h"
#include "physics/laws/law.h"
#include "physics/pores/pore_stiffness.h"

namespace talus {

/// Largest eigenfrequency squared of a cell of a uniform elastic material [1/s2], with pore fluids that no drag holds
/// back: implicit drag lowers frequencies. `density` is that of the soil, or of the skeleton per volume of soil where
/// fluids move on their own.
template <int dim>
double cell_frequency_squared(const Cell<dim> &cell, const Law &law, double density, const PoreStiffness &pores = {});

/// Largest stable step where drag or damping enters forces from the velocities at the start of the step, omega^2 dt^2 +
/// 2 r dt = 4, docs/theory/pores.md (6.1a) [s]. `critical`: 2 / omega without it [s]; `rate`: r, the largest of the
/// drag [1/s]. With the damping ratio xi = r / (2 omega) this is 2 / omega (sqrt(1 + xi^2) - xi) (Belytschko, Liu &
/// Moran 2000, eq. (6.2.23)).
inline double with_explicit_drag(double critical, double rate) {
  const double r = rate * critical;
  return 4 * critical / (r + std::sqrt(r * r + 16));
}

/// Critical steps of one body's cells, computed when a cell is first filled.
template <int dim>
class CriticalStep {
 public:
  CriticalStep(const BackgroundMesh<dim> &mesh, const Law &law, double density, PoreStiffness pores = {})
      : mesh_(&mesh), law_(&law), density_(density), pores_(std::move(pores)) {
    make_room(step_, mesh.cell_count());
    if (!pores_.fluids.empty()) make_room(empty_, mesh.cell_count());
  }
  double operator()(int mesh_cell) { return find(step_[mesh_cell], mesh_cell, pores_); }
  /// Of the skeleton, without the fluids in its pores.
  double skeleton(int mesh_cell) {
    return empty_.empty() ? (*this)(mesh_cell) : find(empty_[mesh_cell], mesh_cell, PoreStiffness{});
  }

 private:
  double find(double &step, int mesh_cell, const PoreStiffness &pores) {
    if (step == 0) step = 2 / std::sqrt(cell_frequency_squared(mesh_->cells[mesh_cell], *law_, density_, pores));
    return step;
  }

  const BackgroundMesh<dim> *mesh_;
  const Law *law_;
  double density_;
  PoreStiffness pores_;
  std::vector<double> step_, empty_;
};

}  // namespace talus
