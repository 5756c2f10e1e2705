#pragma once
/// Pore pressure of a `drained` scene as a function of place (prescribed_pressure.h), linear in cells: what seepage has
/// left there, or a share of the overburden. Every rank knows all of it, since particles wander.
#include <petscsys.h>

#include <array>
#include <string>
#include <vector>

#include "base/vec.h"

namespace talus {

/// Where a drained run keeps the pore pressure that its last seepage left.
inline std::string seeped_file(const std::string &directory) { return directory + "/pore_pressure.csv"; }

template <int dim>
class CellPressure {
 public:
  /// From the cells of this rank: for each vertex of each cell its coordinates [m] and pressure [Pa]. Collective.
  CellPressure(MPI_Comm comm, const std::vector<double> &mine);
  /// As `save` wrote it. Throws std::runtime_error if the file cannot be read.
  explicit CellPressure(const std::string &file);
  /// One line for each cell: coordinates and pressure of its vertices. Throws std::runtime_error, on all ranks, if it
  /// cannot be written. Collective.
  void save(MPI_Comm comm, const std::string &file) const;

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
