#pragma once
/// What a scene may ask of rigid bodies.
#include "simulation/world.h"

namespace talus {

/// Complains of rigid bodies that the scene cannot have: a shape that is none, and what acts beside them.
void check_rigid_bodies(const Scene &scene);
/// Complains of soil that lies in a rigid body at the start. Collective.
template <int dim>
void check_rigid_overlap(const World<dim> &world);

}  // namespace talus
