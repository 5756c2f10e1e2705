#pragma once
/// Where the mesh ends beside and above the soil, and which of these ends moving soil has come to: from then on the
/// run-out is that of the mesh.
#include <string>
#include <vector>

#include "simulation/world.h"

namespace talus {

template <int dim>
class MeshEnds {
 public:
  /// Ends are the faces of the mesh in the planes of the box around it, without the lower one. Collective.
  explicit MeshEnds(const World<dim> &world);
  /// A sentence for each plane whose cells contain, for the first time, soil that has moved towards it by more than the
  /// size of its cell. Collective.
  std::vector<std::string> newly_reached(const std::string &stage);
  /// Saves or loads which ends have been told of. The mesh may be divided in another way when it is loaded. Collective.
  void serialize(Archive &archive);

 private:
  void find_faces();

  static constexpr int planes = 2 * dim;  ///< of the box, two of each axis
  struct Face {
    int cell, plane;
    int group;     ///< number among all names, or -1
    double depth;  ///< of its cell [m]
  };
  struct Found {
    long long id = -1;  ///< particle with the smallest number there; -1: none
    int group = -1;
    double place[3]{};
  };

  const World<dim> &world_;
  std::vector<Face> faces_;  ///< by cell
  std::vector<char> told_;   ///< of each plane
};

}  // namespace talus
