#pragma once
/// Pore pressure that is implicit in time, docs/theory/pores.md section 8: what its solve keeps at nodes and cells.
#include <vector>

#include "base/room.h"
#include "physics/pores/conjugate_gradients.h"

namespace talus {

template <int dim>
struct ImplicitPressure {
  using Array = std::vector<double>;

  ImplicitPressure(bool acts, int nodes, int cells, int fields) : acts(acts), gradients(acts ? nodes : 0) {
    if (!acts) return;
    for (Array *field : {&volume, &increment, &start, &residual, &stiffness, &diagonal, &strain, &given, &correction,
                         &mobility})
      make_room(*field, nodes);
    make_room(sums, 3 * static_cast<size_t>(nodes));
    for (Array *field : {&modulus, &unbounded}) make_room(*field, cells);
    for (auto *field : {&before_drag, &after_drag, &mapped}) make_room(*field, static_cast<size_t>(nodes) * fields);
    make_room(push, nodes);
  }

  bool acts;
  ConjugateGradients gradients;
  // cells
  Array modulus;    ///< dP over the volume strain of pores that are squeezed: K / n [Pa]
  Array unbounded;  ///< pressure by the content, also below that of cavitation [Pa]
  // nodes
  Array volume;      ///< sum of w / (d + 1) [m3]
  Array start;       ///< pressure at the start of the step [Pa]
  Array increment;   ///< that acts beside it [Pa]
  Array residual;    ///< pressure after the strain of the step, minus that which acts [Pa]
  Array stiffness;   ///< - dP over strain, of the cells that do not cavitate [Pa]
  Array strain;      ///< of the pores in the step
  Array given;       ///< strain by what supports prescribe
  Array correction;  ///< of the increment [Pa]
  Array mobility;    ///< velocity of water and grains against an impulse of the pressure [1/kg]
  Array diagonal, sums;
  std::vector<Vec<dim>> push;                             ///< sum of w p grad N [N]
  std::vector<Vec<dim>> before_drag, after_drag, mapped;  ///< velocities [field][node] [m/s]
};

}  // namespace talus
