#pragma once
/// What Talus asks of the DMPlex of a host program.
#include <petscdmplex.h>

#include <string>
#include <vector>

#include "base/owned.h"
#include "meshes/mesh_part.h"

namespace talus {

/// DMPlex's own labels name no groups.
bool is_reserved_label(const std::string &name);

/// Points of a host's DMPlex.
struct HostPoints {
  std::vector<PetscInt> vertex;   ///< of the nodes of its part
  std::vector<long long> number;  ///< of points; no two points of all ranks have the same
};
/// The part of this rank in a host's DMPlex, without patches. Labels on cells name regions, labels on facets groups.
/// Collective.
template <int dim>
PetscErrorCode part_of_plex(DM plex, MeshPart<dim> &part, HostPoints &points);

}  // namespace talus
