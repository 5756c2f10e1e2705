#pragma once
/// A table of the scene whose keys belong to a room further on (laws, boundaries, integrators): kept with its place in
/// the file until that room reads it through `read_one_of` (scene/reader.h).
#include <memory>

namespace talus {

class TableReader;
struct DeferredTable {
  std::shared_ptr<TableReader> reader;  ///< empty when the scene does not have the table
};

}  // namespace talus
