#pragma once
/// Named points of the scene's output: in motion the particle that was nearest at the start, wherever it goes; in
/// stages by finite elements the place itself. So are the places along lines.
#include <array>
#include <string>
#include <vector>

#include "simulation/world.h"

namespace talus {

template <int dim>
class TrackedPoints {
 public:
  struct Point {
    std::string name;
    Vec<dim> place{};  ///< as the scene gives it [m]
    int body = -1;
    PetscInt id = -1;  ///< of its particle
    int index = -1;    ///< of its particle on this rank when it was last found
  };
  /// The points of the scene's output, which like the mesh count from this corner on a map. Throws SceneError for one
  /// that is not near any soil. Collective.
  explicit TrackedPoints(const World<dim> &world, std::array<double, 2> corner = {});
  /// Points without names at these places; those beside the soil are left out. Collective.
  TrackedPoints(const World<dim> &world, const std::vector<Vec<dim>> &places);

  /// A sentence for each point whose particle is further away than half a cell. The same on all ranks.
  const std::vector<std::string> &far_off() const { return far_off_; }

  std::vector<Point> &all() { return points_; }
  const std::vector<Point> &all() const { return points_; }
  /// Index of a point's particle in its body, -1 where another rank has it.
  int find(Point &point) const;
  /// Names of the points that have no soil now: their particle has left the mesh, or its body is not there. Collective.
  std::vector<std::string> without_soil();
  /// Present velocity of the point of that name [m/s]; false where another rank has it.
  bool velocity(const std::string &name, Vec<3> *v);

 private:
  struct Found {
    Point point;
    Vec<dim> at;                ///< place of its particle [m]
    double distance;            ///< of its particle [m]
    double cell_size, spacing;  ///< of the particle's cell, and of the particles there [m]
    /// A point at the surface may be meant a little above it.
    bool near_soil() const { return distance <= 2 * cell_size; }
    /// Places in a cell, if that is not slender, are nearer to a particle than particles to one another.
    bool in_soil() const { return distance <= spacing; }
  };
  Found nearest_particle(const std::string &name, const Vec<dim> &place) const;

  const World<dim> &world_;
  std::vector<Point> points_;
  std::vector<std::string> far_off_;
};

}  // namespace talus
