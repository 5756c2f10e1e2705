#pragma once
/// Work of a step, by which ranks share the mesh. The unit is what a remap costs for a particle that stays in its cell.
/// Soil that flows costs more than soil that stands: its particles change cell, which takes as long as to remap seven
/// that stay, and between two sorts they scatter in memory, so that each sequence of them that lie in one cell, a run,
/// reads the nodes of its cell anew. Rates were measured once, docs/scaling.md, and not by the clock of this run, which
/// therefore does the same whenever it is repeated.
#include <cmath>

namespace talus {

struct Transfer;

/// What causes work, of a cell or of a rank.
struct WorkCounts {
  double particles = 0;
  double runs = 0;    ///< sorted particles have one run in each cell
  double cells = 0;   ///< that are filled
  double movers = 0;  ///< particles that changed cell at the last remap
};

class WorkRates {
 public:
  explicit WorkRates(const Transfer &settings);
  /// Of a step where there are `steps` of them from one remap to the next.
  double of(const WorkCounts &c, double steps) const {
    return (c.particles + of_run * c.runs + of_cell * c.cells + of_mover * c.movers) / steps + step_of_cell_ * c.cells +
           step_of_particle_ * c.particles;
  }
  /// The same before the first remap.
  double of(const WorkCounts &c) const { return of(c, usual_steps_); }
  /// To a multiple of 1/16, so that sums over cells are the same in any order.
  static double without_round_off(double work) { return std::ceil(16 * work) / 16; }

 private:
  static constexpr double of_run = 3.8, of_cell = 3.8, of_mover = 7;  // in a remap
  double step_of_cell_ = 4.4, step_of_particle_ = 0;
  double usual_steps_ = 5;
};

}  // namespace talus
