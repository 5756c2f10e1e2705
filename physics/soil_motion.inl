// Implementation of SoilMotion; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>

#include "base/room.h"
#include "physics/pores/pore_fluid.inl"
#include "physics/soil_motion.h"

namespace talus {

template <int dim, class Phases>
std::vector<PoreStiffness> SoilMotion<dim, Phases>::pores_of_bodies(const MotionParts<dim> &parts) {
  std::vector<PoreStiffness> pores;
  for (const auto &body : parts.bodies) pores.push_back(pore_stiffness(parts.scene, body->source(), fluids));
  return pores;
}

template <int dim, class Phases>
SoilMotion<dim, Phases>::SoilMotion(const MotionParts<dim> &parts)
    : mesh_(parts.mesh),
      bodies_(parts.bodies),
      conditions_(parts.conditions),
      transfer_(*parts.scene.transfer),
      total_mass_(parts.total_mass),
      smallest_mass_(1e-12 * parts.total_mass / static_cast<double>(parts.particles)),
      grid_(parts.mesh),
      next_grid_(parts.mesh),
      points_(parts.bodies.size()),
      next_points_(parts.bodies.size()),
      accepted_(parts.mesh.cell_count(), parts.bodies.size()),
      velocities_(parts.mesh.node_count(), parts.relaxation_time, parts.scene.transfer->remap_interval > 0,
                  parts.scene.transfer->velocity == Velocity::flip ? 1 - parts.scene.transfer->pic_fraction : 0),
      water_(parts.mesh, parts.bodies, parts.pressure),
      work_(parts.mesh.node_count(),
            Phases::prescribed ||
                std::any_of(parts.bodies.begin(), parts.bodies.end(),
                            [](const auto &body) { return !body->source().body_acceleration.empty(); })),
      fastest_mode_(parts.mesh, smallest_mass_, pores_of_bodies(parts)),
      fluid_(parts.mesh, parts.bodies, parts.scene) {
  const BackgroundMesh<dim> &mesh = parts.mesh;
  const auto &bodies = parts.bodies;
  const int nodes = mesh.node_count(), cells = mesh.cell_count();
  make_room(force_, nodes), make_room(scratch_, static_cast<size_t>(nodes) * fields);
  if constexpr (Phases::liquid) make_room(pore_strain_, cells);
  make_room(update_.velocity, nodes), make_room(update_.displacement, nodes);
  for (int a = 0; a < fluids; ++a) make_room(update_.fluid[a], nodes);
  for (auto *field : {&blend_, &filling_, &volume_strain_, &slenderness_}) make_room(*field, cells);
  make_room(increment_, cells), make_room(cell_stress_, cells), make_room(impedance_, cells);
  make_room(patch_weight_, mesh.patch_count), make_room(patch_sum_, mesh.patch_count);
  make_room(nodal_, static_cast<size_t>(nodes) * (dim + 2));
  for (const auto &body : bodies) {
    const double length = body->source().averaging_length;
    nonlocal_.push_back(length > 0 ? std::make_unique<NonlocalStrain<dim>>(
                                         mesh, length, plastic_strain_field(body->law()), body->history_count())
                                   : nullptr);
  }
  for (auto *all : {&points_, &next_points_})
    for (size_t b = 0; b < bodies.size(); ++b) {
      PointSet &points = (*all)[b];
      points.make_room_in(cells);
      if (!transfer_.average_stress) continue;
      const size_t history = static_cast<size_t>(cells) * bodies[b]->history_count();
      make_room(points.own_cell, cells);
      for (auto *field : {&points.own_volume, &points.own_limit, &points.start_volume}) make_room(*field, cells);
      if (reads_shares(bodies[b]->law()))
        make_room(points.own_cohesion_share, cells), make_room(points.own_friction_share, cells);
      make_room(points.own_stress, static_cast<size_t>(cells) * components);
      make_room(points.own_history, history), make_room(points.start_history, history);
      make_room(change_, std::max(change_.size(), static_cast<size_t>(cells) * (1 + fluids) + history));
    }
}

}  // namespace talus

#include "physics/soil_motion/deformation.inl"
#include "physics/soil_motion/forces.inl"
#include "physics/soil_motion/remap.inl"
#include "physics/soil_motion/reports.inl"
#include "physics/soil_motion/velocities.inl"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/transfer_source.h"
