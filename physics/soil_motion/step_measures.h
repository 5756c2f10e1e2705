#pragma once
/// How far the soil of this rank has come in its Lagrangian part, for what the time loop decides after a step.
#include <algorithm>
#include <cmath>

#include "base/archive.h"
#include "physics/soil_motion/cell_deformation.h"

namespace talus {

struct StepMeasures {
  double moved = 0;                  ///< largest displacement of a node since the last remap, over its mean edge
  double smallest_volume_ratio = 1;  ///< smallest volume of a cell over its volume in the mesh
  double step_ratio = 1;     ///< by which the critical step has shrunk with the cells since the remap, at most 1
  double speed_squared = 0;  ///< largest of a node; NaN when a node has no finite velocity [m2/s2]
  bool inverted = false;     ///< a cell of the last state, accepted or trial, has turned inside out

  void begin_part() { moved = 0, smallest_volume_ratio = 1, step_ratio = 1; }
  /// Cells were deformed into a state.
  void deform(const WorstCell &worst, bool trial) {
    inverted = worst.inverted;
    if (!trial) step_ratio = 1 / std::sqrt(worst.slenderness), smallest_volume_ratio = worst.volume;
  }
  /// Nodes were moved into an accepted state, with this velocity [m/s].
  template <int dim>
  void move(const FilledGrid<dim> &grid, const Vec<dim> *velocity) {
    const BackgroundMesh<dim> &mesh = grid.mesh();
    moved = 0, speed_squared = 0;
    for (int i = 0; i < grid.node_count(); ++i) {
      const Vec<dim> &x = grid.position[i], &X = mesh.position[grid.mesh_node[i]];
      double distance = 0, speed = 0;
      for (int d = 0; d < dim; ++d) distance += (x[d] - X[d]) * (x[d] - X[d]), speed += velocity[i][d] * velocity[i][d];
      const double edge = mesh.mean_edge[grid.mesh_node[i]];
      moved = std::max(moved, distance / (edge * edge));
      speed_squared = speed <= speed_squared ? speed_squared : speed;  // a NaN passes through
    }
    moved = std::sqrt(moved);
  }
  void serialize(Archive &archive) {
    double smallest[] = {-smallest_volume_ratio, -step_ratio};
    archive.largest("least of the motion", smallest), archive.largest("motion", moved, speed_squared);
    smallest_volume_ratio = -smallest[0], step_ratio = -smallest[1];
  }
};

}  // namespace talus
