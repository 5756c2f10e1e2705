#include "physics/laws/laws.h"

#include "scene/reader.h"

namespace talus {

Law read_law(const DeferredTable &table) {
  Law law;
  read_one_of(table, "law", law);
  return law;
}

}  // namespace talus
