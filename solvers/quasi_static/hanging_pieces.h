#pragma once
/// Pieces of soil that hang: they have no face in common with the rest, only edges or corners, about which they turn
/// like a door. Cells that belong to a body because their middle does leave such pieces along its rim, and a rough
/// base does not always hold them, docs/theory/finite_elements.md section 2.1.
#include "solvers/quasi_static/moving_soil.h"

namespace talus {

constexpr double most_left_out = 0.01;  ///< of the volume of the soil

/// Soil that has no stress in a problem because it cannot stand.
template <int dim>
struct LeftOut {
  int pieces = 0;
  double volume = 0, share = 0;     ///< [m3], of all soil [-]
  double largest = 0;               ///< volume of the largest piece [m3]
  std::array<double, dim> place{};  ///< centre of the largest [m]
};

/// The pieces to which cells in `moving` belong, if all of these cells are in pieces that hang and that together are
/// not more than `most_left_out`; else none. The same on any partition. Collective.
template <int dim>
PetscErrorCode hanging_pieces(const SoilElements<dim> &soil, const CellSet &moving, CellSet *hanging,
                              LeftOut<dim> *found);

}  // namespace talus
