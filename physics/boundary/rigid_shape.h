#pragma once
/// The shape of a rigid body: a closed polygon of the section, or in 3D a closed surface of triangles.
#include <string>
#include <vector>

#include "base/vec.h"

namespace talus {

/// What is wrong with the corners of a polygon, as a sentence that goes on from its key; empty if nothing is.
std::string problem_of_polygon(const std::vector<std::vector<double>> &corners);

template <int dim>
class RigidShape {
 public:
  RigidShape() = default;
  /// Corners of a polygon in either sense of rotation, or three of each triangle, all in one sense.
  explicit RigidShape(const std::vector<std::vector<double>> &corners);

  /// Distance of a place from the surface, negative inside [m], and the unit vector along which it grows fastest, out
  /// of the body.
  double distance(const Vec<dim> &x, Vec<dim> &outward) const;
  void move(const Vec<dim> &by);

  double volume() const { return volume_; }  ///< [m3], in 2D per metre of width [m2]
  Vec<dim> centre() const { return centre_; }
  double square_radius() const {
    return square_radius_;
  }                      ///< moment of inertia about the centre over the mass, 2D [m2]
  double reach() const;  ///< largest distance of a corner from the origin [m]
  const std::vector<Vec<dim>> &corners() const { return corner_; }

 private:
  Vec<dim> nearest(std::size_t side, const Vec<dim> &x) const;
  bool inside(const Vec<dim> &x) const;

  std::vector<Vec<dim>> corner_;
  std::vector<Vec<dim>> normal_;  ///< of each side, the one behind each corner in 2D, outward
  double volume_ = 0, square_radius_ = 0;
  Vec<dim> centre_{};
};

}  // namespace talus
