#pragma once
/// Velocities of the nodes of one Lagrangian part, of the solid and behind it of the fluids that move: [field][node],
/// where `fields` is their number. docs/theory sections 4.6 and 4.7.
#include <cmath>
#include <vector>

#include "base/phases.h"
#include "base/room.h"
#include "transfer/mass_matrix.h"

namespace talus {

template <int dim, int fields>
struct NodalVelocities {
  using Field = std::vector<Vec<dim>>;

  /// `relaxation_time` is tau of docs/theory (4.10) [s], 0: none; `between_remaps`: nodes relax in each step; `kept`:
  /// share of its own velocity, which the nodes did not receive, that a particle has once they have received the rest.
  NodalVelocities(int nodes, double relaxation_time, bool between_remaps, double kept)
      : relaxation_time(relaxation_time), relaxes(between_remaps && relaxation_time > 0), kept(kept), own_share(kept) {
    for (Field *field : {&start, &now, &unmapped_start}) make_room(*field, static_cast<size_t>(nodes) * fields);
    make_room(moving, nodes);
    if constexpr (fields > 1) make_room(before_step, static_cast<size_t>(nodes) * fields);
  }

  Field start;           ///< v^0, what the nodes received of the particles, which keep the rest [m/s]
  Field now;             ///< v [m/s]
  Field moving;          ///< at which the nodes of the solid move, w of docs/theory (4.9), once results need it [m/s]
  Field unmapped_start;  ///< (I - S) v^0, where nodes relax in each step [m/s]
  [[no_unique_address]] If<(fields > 1), Field> before_step;  ///< v at the start of a step, where fluids move [m/s]

  double relaxation_time;  ///< tau [s]
  bool relaxes;            ///< nodes relax in each step; otherwise only a remap relaxes
  double kept;             ///< 1 - beta of docs/theory (4.10a), for the whole part
  double remap_time = 0;   ///< [s]
  double own_share;        ///< own_share_at of the accepted state

  /// Share of its own velocity, which the nodes did not receive, that a particle has at time t: a of docs/theory
  /// (4.10a).
  double own_share_at(double t) const {
    return relaxation_time > 0 ? kept * std::exp(-(t - remap_time) / relaxation_time) : kept;
  }
  /// Share of `start` that nodes do not map back with the rest, docs/theory (4.9).
  double share_not_mapped(double t) const { return relaxes ? own_share_at(t) : kept; }
  /// Share by which nodes relax in a step [s], docs/theory (4.10).
  double relaxed_in(double step) const { return 1 - std::exp(-step / relaxation_time); }
  /// Once `start` is known: what of it mapping to particles and back, `map(in, out)`, loses on so many nodes.
  /// Collective.
  template <class Map>
  PetscErrorCode find_unmapped_start(int nodes, Map &&map) {
    PetscFunctionBeginUser;
    if (!relaxes) PetscFunctionReturn(0);
    PetscCall(map(start.data(), unmapped_start.data()));
    for (int i = 0; i < nodes * fields; ++i)
      for (int d = 0; d < dim; ++d) unmapped_start[i][d] = start[i][d] - unmapped_start[i][d];
    PetscFunctionReturn(0);
  }
};

}  // namespace talus
