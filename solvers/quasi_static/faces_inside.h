#pragma once
/// Faces of named groups inside the ground, with soil on both sides that no stage adds or removes: drains and wells.
/// Where a stage takes the soil of one side away, or puts it there, a face belongs to the surface of the other side,
/// and no boundary acts on it while both are there.
#include <vector>

#include "meshes/background_mesh.h"

namespace talus {

struct Scene;

template <int dim>
class FacesInside {
 public:
  /// Collective. The mesh must outlive it.
  FacesInside(const BackgroundMesh<dim> &mesh, const Scene &scene);
  bool holds(const Facet<dim> &facet) const {
    const int across = mesh_.cells[facet.cell].neighbour[facet.face];
    return lasting_[facet.cell] && across != boundary &&
           (across >= 0 ? lasting_[across] : lasting_across_[-2 - across]) != 0;
  }

 private:
  const BackgroundMesh<dim> &mesh_;
  std::vector<char> lasting_, lasting_across_;  ///< of cells, and of those across faces of the partition
};

}  // namespace talus
