#pragma once
/// Pore pressure of a `drained` scene as a function of place (prescribed_pressure.h), linear in cells: what seepage has
/// left there, or a share of the overburden. Every rank knows all of it, since particles wander.
#include <petscsys.h>

#include <array>
#include <string>
#include <vector>

#include "base/vec.h"

namespace talus {

template <int dim>
class CellPressure {
 public:
  /// From the cells of this rank: for each vertex of each cell its coordinates [m] and pressure [Pa]. Collective.
  CellPressure(MPI_Comm comm, const std::vector<double> &mine);
  /// Has no rank a cell?
  bool empty() const { return cells_.empty(); }
  /// Comma-separated values with a line for each cell: coordinates and pressure of its vertices.
  std::string table() const;

  /// Pressure at a place x [dim]; not a number outside the cells [Pa].
  double operator()(const double *x) const;

 private:
  static constexpr int width = (dim + 1) * (dim + 1);  ///< numbers of a cell: [vertex][coordinates, pressure]
  void sort_into_bins();

  std::vector<double> cells_;
  std::vector<int> first_, in_bin_;  ///< cells that may reach into a bin of a regular grid
  Vec<dim> low_{}, bin_size_{};
  std::array<int, dim> bins_{};
};

}  // namespace talus
