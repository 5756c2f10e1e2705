#pragma once
/// How the soil fills its cells, as a remap finds it and the Lagrangian part keeps it.
#include <array>
#include <memory>
#include <vector>

#include "base/archive.h"
#include "particles/body.h"
#include "physics/soil_motion/soil_state.h"

namespace talus {

enum class Integration;

template <int dim>
struct CellFilling {
  explicit CellFilling(int cells);

  /// Integration volume: the cell's own where its nodes are well filled, that of its particles at the surface, theory
  /// (4.5). `volume` [node][stride] is that of the particles at the nodes, of all ranks [m3]. Also gives the accepted
  /// state its weights and the volumes of its particles.
  void find(const FilledGrid<dim> &grid, Integration integration, const double *volume, int stride,
            SoilState<dim> &accepted);
  /// Impedances of the cells, means over their points weighted by volume.
  void measure_impedance(const FilledGrid<dim> &grid, const std::vector<std::unique_ptr<Body<dim>>> &bodies,
                         const std::vector<PointSet> &points, const SoilState<dim> &accepted);
  /// Of cells that several groups of bodies fill, each has its own copy: gives each its part of the integration volume.
  void divide_cells(SoilState<dim> &to) const {
    for (const DividedCell &one : divided) {
      const int c = one.cell;
      to.weight[c] = to.particle_volume[c] + blend[c] * (one.part * to.shape[c].volume - to.particle_volume[c]);
    }
  }
  /// Finds these cells; `find` has done so.
  void find_divided(const FilledGrid<dim> &grid);
  void serialize(Archive &archive, const Archive::Rows &cells);

  std::vector<double> blend;        ///< b of docs/theory (4.4)
  std::vector<double> share;        ///< integration volume over cell volume
  std::vector<double> slenderness;  ///< sum of squared shape-function gradients [1/m2]
  struct DividedCell {
    int cell;
    double part;  ///< of the volume of all particles in the cell
  };
  std::vector<DividedCell> divided;
  std::vector<std::array<double, 2>> impedance;  ///< rho c_p, rho c_s [kg/(m2 s)]
};

}  // namespace talus
