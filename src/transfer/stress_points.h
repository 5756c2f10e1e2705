#pragma once
/// Where stress is known during a Lagrangian part: with averaged stress one point per cell and body, otherwise the particles
/// themselves. Both look the same to the kernel (docs/theory, section 4.3).
#include <vector>

namespace talus {

struct PointSet {
  int count = 0;
  const int *cell = nullptr;       ///< [count] compact cell
  double *stress = nullptr;        ///< [count][stress_size] accepted stress [Pa]
  double *history = nullptr;       ///< [count][history]
  double *volume = nullptr;        ///< [count] [m3]
  const double *limit = nullptr;   ///< [count] V_p0: the volume cap is a multiple of it [m3]

  // owned when stress is averaged; else only `own_cell` is used
  std::vector<int> own_cell;
  std::vector<double> own_stress, own_history, own_volume, own_limit;
  std::vector<double> start_history, start_volume;  ///< at the remap: what particles gain is the difference
  std::vector<int> of_cell;                         ///< [mesh cells] point of a cell, -1: none
};

}  // namespace talus
