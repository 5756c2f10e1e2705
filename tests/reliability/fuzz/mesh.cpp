// Fuzz target: Gmsh files, read as meshes of dimension 2 and 3.
#include <cstdlib>

#include "input.h"
#include "meshes/gmsh_file.h"

namespace talus {
namespace {

/// What later parts rely on: places in lists exist.
void check(const GmshMesh &mesh) {
  const auto within = [](const std::vector<int> &places, std::size_t count) {
    for (const int place : places)
      if (place < 0 || static_cast<std::size_t>(place) >= count) std::abort();
  };
  const std::size_t nodes = mesh.position.size() / mesh.dimension, cells = mesh.cells.size() / (mesh.dimension + 1);
  within(mesh.cells, nodes);
  for (const auto &[name, members] : mesh.regions) within(members, cells);
  for (const auto &[name, members] : mesh.groups) within(members, mesh.facet_number.size());
}

}  // namespace
}  // namespace talus

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  const std::string file = talus::file_of(data, size);
  for (const int dimension : {2, 3}) talus::take_or_refuse([&] { talus::check(talus::read_gmsh(file, dimension)); });
  return 0;
}
