#pragma once
/// Every key of a scene, with those of laws, curves, boundaries and integrators.
#include "scene/describe.h"

namespace talus {

/// One block for each table of a scene, and for each kind of which a table may be.
Describer scene_keys();

}  // namespace talus
