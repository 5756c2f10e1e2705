#pragma once
/// Named points of the scene's output: each is the particle that was nearest at the start, wherever it goes.
#include <string>
#include <vector>

#include "simulation/world.h"

namespace talus {

template <int dim>
class TrackedPoints {
 public:
  struct Point {
    std::string name;
    int body = -1;
    PetscInt id = -1;  ///< of its particle
    int index = -1;    ///< of its particle on this rank when it was last found
  };
  /// Collective.
  explicit TrackedPoints(const World<dim> &world);

  std::vector<Point> &all() { return points_; }
  const std::vector<Point> &all() const { return points_; }
  /// Index of a point's particle in its body, -1 where another rank has it.
  int find(Point &point) const;
  /// Present speed of the point of that name [m/s], -1 where another rank has it.
  double speed(const std::string &name);

 private:
  const World<dim> &world_;
  std::vector<Point> points_;
};

}  // namespace talus
