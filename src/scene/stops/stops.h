#pragma once
/// The list of stop criteria, as scenes name them: one name to add one. What they do: simulation/stops.
#include <variant>

#include "scene/stops/duration.h"
#include "scene/stops/equilibrium.h"
#include "scene/stops/failure.h"
#include "scene/stops/rest.h"

namespace talus {

using StopKinds = std::variant<AtDuration, AtEquilibrium, AtRest, AtFailure>;

}  // namespace talus
