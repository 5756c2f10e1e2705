#pragma once
/// Named points of the scene's output: in motion the particle that was nearest at the start, wherever it goes; in
/// stages by finite elements the place itself.
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
  /// Throws SceneError for a point that is not near any soil. Collective.
  explicit TrackedPoints(const World<dim> &world);

  std::vector<Point> &all() { return points_; }
  const std::vector<Point> &all() const { return points_; }
  /// Index of a point's particle in its body, -1 where another rank has it.
  int find(Point &point) const;
  /// Present velocity of the point of that name [m/s]; false where another rank has it.
  bool velocity(const std::string &name, Vec<3> *v);

 private:
  void refuse_far(const std::string &name, double distance, double cell_size) const;

  const World<dim> &world_;
  std::vector<Point> points_;
};

}  // namespace talus
