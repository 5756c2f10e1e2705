#pragma once
/// The list of boundary kinds: one line to add one. A kind says what it prescribes through the members it has: `directions` (and
/// `value`) prescribe velocities, `load` is a traction; conditions.h acts on them.
#include <variant>

#include "physics/boundary/fixed.h"
#include "physics/boundary/friction.h"
#include "physics/boundary/non_reflecting.h"
#include "physics/boundary/prescribed_velocity.h"
#include "physics/boundary/roller.h"
#include "physics/boundary/traction.h"
#include "scene/deferred.h"

namespace talus {

using Boundary = std::variant<Fixed, Roller, PrescribedVelocity, Traction, Friction, NonReflecting>;

Boundary read_boundary(DeferredTable &table);

}  // namespace talus
