#pragma once
/// What a mesh and its particles will need, known before edges are halved: numbers, and memory.
#include <mpi.h>

#include <string>
#include <utility>
#include <vector>

namespace talus {

/// The particles that a mesh is to hold.
struct SeedCounts {
  std::vector<std::pair<std::string, double>> per_cell;  ///< a region, and particles in each of its cells
  int numbers_per_cell = 0;                              ///< numbers of particles that each cell of the mesh takes up
};

/// What speaks against a mesh of so many cells, and of particles once its edges are halved: numbers of particles that
/// PetscInt cannot hold, or more memory than this machine has left for its share of the ranks. Rough, by what
/// docs/scaling.md has measured. Collective; the answer is that of this rank.
template <int dim>
std::string complaint_about_needs(MPI_Comm comm, double cells, double particles, int numbers_per_cell, int halvings);

}  // namespace talus
