#pragma once
/// [structure.NAME]: what is built into the soil, and the list of kinds: one name to add one.
#include <string>
#include <variant>

#include "scene/structures/anchor.h"
#include "scene/structures/geogrid.h"
#include "scene/structures/nail.h"

namespace talus {

using StructureKinds = std::variant<AnchorKeys, NailKeys, GeogridKeys>;

struct StructureSource {
  std::string name;  ///< the table's own name, [structure.NAME]
  StructureKinds kind;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.one_of("kind", kind, "what the structure is; its properties are keys of the same table");
  }
  /// One bar with all that its kind says of it; of a geogrid, a strip.
  BarKeys bar() const {
    return std::visit([](const auto &one) { return one.bar(); }, kind);
  }
  const char *kind_name() const {
    return std::visit([](const auto &one) { return std::decay_t<decltype(one)>::name; }, kind);
  }
};

}  // namespace talus
