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
    for (Array *field :
         {&volume, &particle_volume, &acting, &held, &strain, &given, &residual, &stiffness, &correction, &mobility, &diagonal})
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
  Array particle_volume;  ///< sum of that of the particles over d + 1 [m3]
  Array acting;      ///< pressure that acts in the step [Pa]
  Array held;        ///< strain of the pores that has this pressure
  Array strain;      ///< that of the step
  Array given;       ///< that by what supports prescribe
  Array residual;    ///< what the strain of the step lacks, times the volume [m3]
  Array stiffness;   ///< - dP over strain [Pa]
  Array correction;  ///< of the pressure that acts [Pa]
  Array mobility;    ///< velocity of water and grains against an impulse of the pressure [1/kg]
  Array diagonal, sums;
  std::vector<Vec<dim>> push;                             ///< sum of w p grad N [N]
  std::vector<Vec<dim>> before_drag, after_drag, mapped;  ///< velocities [field][node] [m/s]
};

}  // namespace talus
