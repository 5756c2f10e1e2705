#pragma once
/// Which ranks have parts of the mesh near each other: of the others a rank knows no more than a box.
#include <vector>

#include "meshes/background_mesh.h"
#include "meshes/box.h"

namespace talus {

/// Around the parts of all ranks. Collective.
template <int dim>
std::vector<Box<dim>> boxes_of_parts(const BackgroundMesh<dim> &mesh) {
  int ranks;
  MPI_Comm_size(mesh.comm(), &ranks);
  Box<dim> mine;
  for (const Vec<dim> &x : mesh.position) mine.enclose(x);
  std::vector<Box<dim>> boxes(ranks);
  MPI_Allgather(&mine, 2 * dim, MPI_DOUBLE, boxes.data(), 2 * dim, MPI_DOUBLE, mesh.comm());
  return boxes;
}

}  // namespace talus
