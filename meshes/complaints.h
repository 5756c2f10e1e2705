#pragma once
/// Complaints about meshes: what is wrong, where, and what to do. An empty text is no complaint.
#include <petscdmplex.h>

#include <string>

#include "meshes/cell_tree.h"

namespace talus {

/// Cells of no volume, cells that overlap, and, where each has to have a name, cells in no region. Serial; `source`
/// names the mesh, `tree` is that of the cells.
enum class Names { required, optional };
template <int dim>
std::string complaint_about_cells(const std::string &source, const Simplices<dim> &cells, const CellTree<dim> &tree,
                                  const Regions &regions, Names names);

/// A host's DMPlex that cannot serve: wrong dimension, an overlap, no faces, cells that are not simplices. Local.
std::string complaint_about_plex(DM plex, int dimension);

/// Throws std::invalid_argument on every rank with the complaint of the lowest rank that has one. Collective.
void agree(MPI_Comm comm, const std::string &complaint);

/// Throws std::runtime_error for a PETSc error.
void require(PetscErrorCode error);

}  // namespace talus
