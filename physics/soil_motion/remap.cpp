#include "physics/soil_motion/remap.h"

namespace talus {

template <int dim>
std::vector<PointSet> make_points(const std::vector<std::unique_ptr<Body<dim>>> &bodies, int cells, bool averaged) {
  std::vector<PointSet> all(bodies.size());
  for (size_t b = 0; b < bodies.size(); ++b) {
    PointSet &points = all[b];
    points.make_room_in(cells);
    if (!averaged) continue;
    const size_t history = static_cast<size_t>(cells) * bodies[b]->history_count();
    make_room(points.own_cell, cells);
    for (auto *field : {&points.own_volume, &points.own_limit, &points.start_volume}) make_room(*field, cells);
    if (reads_shares(bodies[b]->law()))
      make_room(points.own_cohesion_share, cells), make_room(points.own_friction_share, cells);
    make_room(points.own_stress, static_cast<size_t>(cells) * stress_size<dim>);
    make_room(points.own_history, history), make_room(points.start_history, history);
  }
  return all;
}

template std::vector<PointSet> make_points(const std::vector<std::unique_ptr<Body<2>>> &, int, bool);
template std::vector<PointSet> make_points(const std::vector<std::unique_ptr<Body<3>>> &, int, bool);

}  // namespace talus
