// Implementation of SoilMotion; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>

#include "base/room.h"
#include "particles/own_acceleration.h"
#include "physics/pores/pore_fluid.inl"
#include "physics/soil_motion.h"
#include "scene/scene.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"

namespace talus {

template <int dim, class Phases>
std::vector<PoreStiffness> SoilMotion<dim, Phases>::pores_of_bodies(const MotionParts<dim> &parts) {
  std::vector<PoreStiffness> pores;
  for (const auto &body : parts.bodies)
    pores.push_back(pore_stiffness(parts.scene, body->source(), fluids, parts.implicit_pressure));
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
      points_(make_points<dim>(parts.bodies, parts.mesh.cell_count(), transfer_.average_stress)),
      remap_(parts.mesh, parts.bodies, transfer_.average_stress),
      softening_(parts.mesh, parts.bodies),
      filling_(parts.mesh.cell_count()),
      patches_(parts.mesh.patch_count),
      increments_(parts.mesh.cell_count()),
      stress_(parts.mesh.cell_count()),
      accepted_(parts.mesh.cell_count(), parts.bodies.size()),
      velocities_(parts.mesh.node_count(), parts.relaxation_time, parts.scene.transfer->remap_interval > 0,
                  parts.scene.transfer->velocity == Velocity::flip ? 1 - parts.scene.transfer->pic_fraction : 0),
      water_(parts.mesh, parts.bodies, parts.pressure),
      work_(parts.mesh.node_count(),
            Phases::prescribed ||
                std::any_of(parts.bodies.begin(), parts.bodies.end(),
                            [](const auto &body) { return !own_acceleration(body->source()).empty(); })),
      fastest_mode_(parts.mesh, smallest_mass_, pores_of_bodies(parts)),
      rayleigh_(parts.mesh, parts.bodies),
      fluid_(parts.mesh, parts.bodies, parts.scene, parts.implicit_pressure),
      implicit_(parts.implicit_pressure, Phases::suction, transfer_.locking == Locking::patches, parts.mesh) {
  const int nodes = parts.mesh.node_count();
  make_room(force_, nodes), make_room(scratch_, static_cast<size_t>(nodes) * fields);
  make_room(nodal_, static_cast<size_t>(nodes) * nodal_sums);
  if constexpr (Phases::liquid) make_room(pore_strain_, parts.mesh.cell_count());
}

}  // namespace talus

#include "physics/soil_motion/deformation.inl"
#include "physics/soil_motion/forces.inl"
#include "physics/soil_motion/implicit_pressure.inl"
#include "physics/soil_motion/remap.inl"
#include "physics/soil_motion/reports.inl"
#include "physics/soil_motion/velocities.inl"
