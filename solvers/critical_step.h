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

/// Largest stable step where drag enters forces from the velocities at the start of the step, omega^2 dt^2 + 2 r dt =
/// 4, docs/theory/pores.md (6.1a) [s]. `critical`: 2 / omega without drag [s]; `rate`: r, the largest of the drag
/// [1/s].
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
  }
  double operator()(int mesh_cell) {
    double &step = step_[mesh_cell];
    if (step == 0) step = 2 / std::sqrt(cell_frequency_squared(mesh_->cells[mesh_cell], *law_, density_, pores_));
    return step;
  }

 private:
  const BackgroundMesh<dim> *mesh_;
  const Law *law_;
  double density_;
  PoreStiffness pores_;
  std::vector<double> step_;
};

}  // namespace talus
