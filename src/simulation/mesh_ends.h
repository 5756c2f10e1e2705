#pragma once
/// Where the mesh ends beside, above and below the soil, which of these ends moving soil has come to, so that the
/// run-out is that of the mesh from then on, and which of them a slide reaches, so that they decide part of its load.
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "simulation/world.h"

namespace talus {

template <int dim>
class MeshEnds {
 public:
  /// Ends are the faces of the mesh in the planes of the box around it, of the lower one those that are fixed.
  /// Collective.
  explicit MeshEnds(const World<dim> &world);
  /// A sentence for each plane whose cells contain, for the first time, soil that has moved towards it by more than the
  /// size of its cell. Collective.
  std::vector<std::string> newly_reached(const std::string &stage);
  /// A point of the soil: where it lay at the last reset, how far it has moved and how much it has sheared since.
  struct Point {
    Vec<dim> start, way;
    double mass, strain;
  };
  /// Calls a function for each point of this rank.
  using Soil = std::function<void(const std::function<void(const Point &)> &)>;
  /// A sentence for each side of the mesh behind or in front of a slide, and for its fixed bottom, that decides part of
  /// the slide. Of a side it is said where soil that lay at it has moved by more than `cut_share` of the largest
  /// displacement since the last reset, or where soil beside it has sheared by more than `reached_share` of the mean of
  /// all that has; of the bottom in the second case. A side counts where it is a roller or no boundary acts on it, and
  /// where it faces the slide's way or its rear: sides along the way are often planes of symmetry. The bottom counts
  /// where soil lies on all of it: a bare one is the ground over which soil runs out. Collective.
  std::vector<std::string> cut_off() const;
  /// The same of a mechanism of finite elements, whose size is free: it reaches an end where cells at this end shear.
  /// The bottom does not count where the ground comes down to it, at the toe of a slope on firm ground.
  std::vector<std::string> cut_off(const Soil &mechanism) const { return sentences(mechanism, true); }
  /// The rear of the gallery's selborne moves by 0.03 in cells of 1.4 m, soil that stands by less.
  static constexpr double cut_share = 0.02;
  /// Soil that moves by less is no part of a mechanism, see moving_pieces: it yields beside it.
  static constexpr double mechanism_share = 0.1;
  /// In cells of 2 to 0.7 m the rear of selborne has 0.08 to 0.14 where the base is deep or not, and its base 0.5 to
  /// 0.7; with both far away 0, and 0.03 to 0.05: to move them farther then changes the load at failure by 1 %.
  static constexpr double reached_share = 0.06;
  /// Saves or loads which ends have been told of. The mesh may be divided in another way when it is loaded. Collective.
  void serialize(Archive &archive);

 private:
  static constexpr int planes = 2 * dim;  ///< of the box, two of each axis

  void find_faces();
  int bottom() const { return 2 * world_.scene.vertical(); }
  /// How far a place lies along the outward normal of a plane [m].
  static double outward(int plane, const Vec<dim> &x) { return plane % 2 ? x[plane / 2] : -x[plane / 2]; }
  std::string name_of(int plane) const {  // "x = 3 m"
    return std::string(1, "xyz"[plane / 2]) + " = " + rounded(plane % 2 ? 0 - end_[plane] : end_[plane]) + " m";
  }
  bool acknowledged() const { return world_.scene.acknowledges("mesh_end"); }
  std::vector<std::string> sentences(const Soil &soil, bool mechanism) const;
  /// Mean plastic strain of the soil within a distance of a plane [m], in the part of the plane, as long as this
  /// distance, where it is largest. Zero at a bottom that soil does not cover, or covers less than `thin` somewhere
  /// [m]: it is that of a slope on firm ground. Collective.
  double shear_beside(const Soil &soil, int plane, double within, double thin) const;

  struct Face {
    int cell, plane;
    double depth;  ///< of its cell [m]
    bool slips;    ///< soil can move along it: a roller, or no boundary
  };

  const World<dim> &world_;
  std::vector<Face> faces_;  ///< by cell
  std::vector<char> told_;   ///< of each plane
  double end_[planes]{};     ///< of each plane, minus its place along the outward normal [m]
};

}  // namespace talus
