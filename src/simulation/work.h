#pragma once
/// Work of a step, by which ranks share the mesh. The unit is a particle whose neighbours in memory lie in its cell.
/// Soil that flows costs more than soil that stands: between two sorts its particles scatter in memory, and each
/// sequence of them that lie in one cell, a run, reads the nodes of its cell anew. Rates were measured once,
/// docs/scaling.md, and not by the clock of this run, which therefore does the same whenever it is repeated.

namespace talus {

struct WorkRates {
  double per_run = 2;   ///< sorted particles have one run in each cell
  double per_cell = 8;  ///< that is filled

  /// With a stress of its own in each particle the cell has little to do.
  static WorkRates with(bool average_stress) { return {.per_cell = average_stress ? 8. : 0.}; }
  /// Of one cell, where it is filled and sorted.
  double of_cell(int particles) const { return particles + per_run + per_cell; }
};

}  // namespace talus
