#pragma once
/// The list of boundary kinds: one line to add one. A kind says what it prescribes through the members it has:
/// `directions` (and `value`) prescribe velocities, always or `while_loads_are_held`, `load` is a traction;
/// conditions.h acts on them. Kinds with `water` concern the pore fluids and leave the soil alone: `outside` is the
/// pressure beyond the face, `supply` what may enter there, `forced` what must, `gas_outside` the pressure of the gas
/// beyond; pore_conditions.h acts on them.
#include <variant>

#include "physics/boundary/fixed.h"
#include "physics/boundary/flux.h"
#include "physics/boundary/friction.h"
#include "physics/boundary/gas_pressure.h"
#include "physics/boundary/head.h"
#include "physics/boundary/impermeable.h"
#include "physics/boundary/non_reflecting.h"
#include "physics/boundary/pore_pressure.h"
#include "physics/boundary/prescribed_velocity.h"
#include "physics/boundary/rainfall.h"
#include "physics/boundary/roller.h"
#include "physics/boundary/suction.h"
#include "physics/boundary/traction.h"
#include "scene/deferred.h"

namespace talus {

using Boundary = std::variant<Fixed, Roller, PrescribedVelocity, Traction, Friction, NonReflecting, GivenPorePressure,
                              GivenSuction, Head, Flux, Impermeable, Rainfall, GivenGasPressure>;

/// Does the kind concern the pore fluids only?
inline bool concerns_water(const Boundary &kind) {
  return std::visit(
      [](const auto &one) {
        return requires { one.water; };
      },
      kind);
}

/// Does it prescribe its directions in quasi-static stages and those that hold loads only, as a support that stands in
/// for something else?
inline bool holds_loads(const Boundary &kind) {
  return std::visit(
      [](const auto &one) {
        return requires { one.while_loads_are_held; };
      },
      kind);
}

/// Does it need a gas that moves?
inline bool concerns_gas(const Boundary &kind) {
  return std::visit(
      [](const auto &one) {
        return requires { one.gas_outside(0., 0., 0., 0.); };
      },
      kind);
}

Boundary read_boundary(DeferredTable &table);

}  // namespace talus
