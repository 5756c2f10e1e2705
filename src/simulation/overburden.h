#pragma once
/// Weight of the soil above a place: the total vertical stress of level strata, without arching.
#include <array>
#include <vector>

#include "meshes/near_parts.h"

namespace talus {

template <int dim>
class Overburden {
 public:
  /// A simplex of soil.
  struct Block {
    std::array<Vec<dim>, dim + 1> corner;
    double unit_weight;  ///< total [N/m3]
  };
  /// From the blocks of this rank, which are cells of its part of the mesh. `vertical` is the component of a place that
  /// is its elevation. Ranks whose parts lie above each other exchange their blocks. Collective.
  Overburden(const BackgroundMesh<dim> &mesh, const std::vector<Block> &mine, int vertical);

  /// Weight per area of the soil on the vertical above a place x in this rank's part of the mesh [Pa]. `top` receives
  /// the elevation of its upper end, that of x where no soil is above it [m].
  double above(const Vec<dim> &x, double *top) const;

 private:
  int strip_of(double x) const;

  int vertical_;
  std::vector<Block> blocks_;               ///< above this rank's part of the mesh or in it
  std::vector<std::vector<int>> in_strip_;  ///< blocks that reach into a strip of x
  Box<dim> extent_;                         ///< of the blocks of all ranks [m]
};

}  // namespace talus
