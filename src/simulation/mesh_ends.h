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
  /// A sentence for each side of the mesh behind, beside or in front of a slide that cuts it off: soil that lay at this
  /// side has moved by more than `cut_share` of the largest displacement since the last reset. A side counts where it
  /// is a roller or no boundary acts on it, and where it faces the slide's way or its rear: sides along the way are
  /// often planes of symmetry. Collective.
  std::vector<std::string> cut_off() const;
  /// The rear of the gallery's selborne moves by 0.03 in cells of 1.4 m, soil that stands by less.
  static constexpr double cut_share = 0.02;
  /// Saves or loads which ends have been told of. The mesh may be divided in another way when it is loaded. Collective.
  void serialize(Archive &archive);

 private:
  void find_faces();

  static constexpr int planes = 2 * dim;  ///< of the box, two of each axis
  struct Face {
    int cell, plane;
    int group;     ///< number among all names, or -1
    double depth;  ///< of its cell [m]
    bool slips;    ///< soil can move along it: a roller, or no boundary
  };
  struct Found {
    long long id = -1;  ///< particle with the smallest number there; -1: none
    int group = -1;
    double place[3]{};
  };

  const World<dim> &world_;
  std::vector<Face> faces_;  ///< by cell
  std::vector<char> told_;   ///< of each plane
  double end_[2 * dim]{};    ///< of each plane, minus its place along the outward normal [m]
};

}  // namespace talus
