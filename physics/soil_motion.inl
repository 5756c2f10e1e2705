// Implementation of SoilMotion; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>

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
      transfer_(parts.scene.transfer),
      total_mass_(parts.total_mass),
      smallest_mass_(1e-12 * parts.total_mass / static_cast<double>(parts.particles)),
      grid_(parts.mesh),
      next_grid_(parts.mesh),
      points_(parts.bodies.size()),
      next_points_(parts.bodies.size()),
      accepted_(parts.mesh.cell_count(), parts.bodies.size()),
      velocities_(parts.mesh.node_count(), parts.relaxation_time, parts.scene.transfer.remap_interval > 0),
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
  force_.resize(nodes), scratch_.resize(nodes * fields);
  if constexpr (Phases::liquid) pore_strain_.resize(cells);
  update_.velocity.assign(nodes, Quad{}), update_.displacement.assign(nodes, Quad{});
  for (int a = 0; a < fluids; ++a) update_.fluid[a].assign(nodes, Quad{});
  for (auto *field : {&blend_, &filling_, &volume_strain_, &slenderness_}) field->assign(cells, 0);
  increment_.resize(cells), cell_stress_.resize(cells), impedance_.resize(cells);
  patch_weight_.assign(mesh.patch_count, 0), patch_sum_.assign(mesh.patch_count, 0);
  nodal_.assign(static_cast<size_t>(nodes) * (dim + 2), 0);
  for (const auto &body : bodies) {
    const double length = body->source().averaging_length;
    nonlocal_.push_back(length > 0 ? std::make_unique<NonlocalStrain<dim>>(
                                         mesh, length, plastic_strain_field(body->law()), body->history_count())
                                   : nullptr);
  }
  for (auto *all : {&points_, &next_points_})
    for (size_t b = 0; b < bodies.size(); ++b) {
      PointSet &points = (*all)[b];
      points.of_cell.assign(cells, -1);
      if (!transfer_.average_stress) continue;
      points.own_cell.resize(cells), points.own_volume.resize(cells), points.own_limit.resize(cells),
          points.start_volume.resize(cells);
      if (reads_shares(bodies[b]->law()))
        points.own_cohesion_share.resize(cells), points.own_friction_share.resize(cells);
      points.own_stress.resize(static_cast<size_t>(cells) * components);
      points.own_history.resize(static_cast<size_t>(cells) * bodies[b]->history_count());
      points.start_history.resize(points.own_history.size());
      change_.resize(std::max(change_.size(), static_cast<size_t>(cells) * (1 + fluids + bodies[b]->history_count())));
    }
}

}  // namespace talus

#include "physics/soil_motion/deformation.inl"
#include "physics/soil_motion/forces.inl"
#include "physics/soil_motion/remap.inl"
#include "physics/soil_motion/reports.inl"
#include "physics/soil_motion/velocities.inl"
