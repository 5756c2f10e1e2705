#include "physics/boundary/boundary.h"

#include "physics/boundary/kinds.h"

namespace talus {

Boundary read_boundary(const DeferredTable &table) { return read_boundary_of<BoundaryKinds>(table); }

}  // namespace talus
