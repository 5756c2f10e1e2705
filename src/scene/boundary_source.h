#pragma once
/// [boundary.NAME]: a condition on groups of facets.
#include <string>
#include <vector>

#include "scene/deferred.h"

namespace talus {

struct BoundarySource {
  std::string name;                ///< the table's own name, [boundary.NAME]
  std::vector<std::string> group;  ///< physical groups of facets; empty: the table's own name
  DeferredTable kind;              ///< "kind" and its parameters, read by physics/boundary
  template <class Visitor>
  void fields(Visitor &&v) {
    v.texts("group", group, "name (or list of names) of the physical groups of facets; default: the name of the table");
    v.deferred("kind", kind, "kind of boundary; its parameters are keys of the same table");
  }
};

}  // namespace talus
