#pragma once
/// The list of boundary kinds: one line to add one. What a kind states of itself: kind.h.
#include <variant>

#include "physics/boundary/boundary.h"
#include "physics/boundary/fixed.h"
#include "physics/boundary/flux.h"
#include "physics/boundary/free_field.h"
#include "physics/boundary/friction.h"
#include "physics/boundary/gas_pressure.h"
#include "physics/boundary/head.h"
#include "physics/boundary/heated_friction.h"
#include "physics/boundary/impermeable.h"
#include "physics/boundary/non_reflecting.h"
#include "physics/boundary/pore_pressure.h"
#include "physics/boundary/prescribed_velocity.h"
#include "physics/boundary/rainfall.h"
#include "physics/boundary/roller.h"
#include "physics/boundary/suction.h"
#include "physics/boundary/tied.h"
#include "physics/boundary/traction.h"
#include "scene/reader.h"

namespace talus {

using BoundaryKinds =
    std::variant<Fixed, Roller, PrescribedVelocity, Traction, Friction, HeatedFriction, NonReflecting, FreeField, Tied,
                 PrescribedPorePressure, PrescribedSuction, Head, Flux, Impermeable, Rainfall, PrescribedGasPressure>;

/// Reads the kind that the table names, out of a list of kinds. Throws SceneError.
template <class Kinds>
Boundary read_boundary_of(const DeferredTable &table) {
  Kinds kinds;
  read_one_of(table, "kind", kinds);
  return std::visit([](const auto &kind) { return Boundary(kind); }, kinds);
}

}  // namespace talus
