#include "physics/boundary/boundary.h"

#include "scene/reader.h"

namespace talus {

Boundary read_boundary(DeferredTable &table) {
  Boundary boundary;
  read_one_of(table, "kind", boundary);
  return boundary;
}

}  // namespace talus
