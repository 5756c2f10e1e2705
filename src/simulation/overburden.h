#pragma once
/// Weight of the soil above a place: the total vertical stress of level strata, without arching.
#include <array>
#include <vector>

#include "base/vec.h"
#include "petscsys.h"

namespace talus {

template <int dim>
class Overburden {
 public:
  /// A simplex of soil.
  struct Block {
    std::array<Vec<dim>, dim + 1> corner;
    double unit_weight;  ///< total [N/m3]
  };
  /// From the blocks of this rank; every rank sees all of them. `vertical` is the component of a place that is its
  /// elevation. Collective.
  Overburden(MPI_Comm comm, const std::vector<Block> &mine, int vertical);

  /// Weight per area of the soil on the vertical above x [Pa]. `top` receives the elevation of its upper end, that of x
  /// where no soil is above it [m].
  double above(const Vec<dim> &x, double *top) const;

 private:
  int strip_of(double x) const;

  int vertical_;
  std::vector<Block> blocks_;
  std::vector<std::vector<int>> in_strip_;  ///< blocks that reach into a strip of x
  Vec<dim> low_{}, high_{};                 ///< of the blocks [m]
};

}  // namespace talus
