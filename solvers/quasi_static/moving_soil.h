#pragma once
/// The soil that a mechanism of failure moves, by cells, docs/theory/finite_elements.md section 5.
#include "solvers/quasi_static/factor_of_safety.h"
#include "solvers/quasi_static/soil_elements.h"

namespace talus {

/// Some cells of this rank: 1 for those that belong to it [cells].
using CellSet = std::vector<char>;

/// The pieces of soil that moved in the last accepted increment, the largest first: cells whose middle has moved by
/// more than a tenth of the largest displacement, joined by nodes. Pieces of less than a twentieth of the largest are
/// left out. Collective.
template <int dim>
PetscErrorCode moving_pieces(const SoilElements<dim> &soil, std::vector<CellSet> *pieces);

/// Volume of the cells [m3]. Collective.
template <int dim>
double volume_of(const SoilElements<dim> &soil, const CellSet &cells);

CellSet both(const CellSet &a, const CellSet &b);
CellSet either(const CellSet &a, const CellSet &b);

/// Takes in the soil around the cells, layer by layer. Collective.
template <int dim>
PetscErrorCode grow(const SoilElements<dim> &soil, int layers, CellSet *cells);
/// The same to about a distance [m], but at least one layer. Collective.
template <int dim>
PetscErrorCode grow_by(const SoilElements<dim> &soil, double distance, CellSet *cells);

/// Share of the shear strain of a piece, and of the soil on its edge, that takes place in `cells` or not more than two
/// cells away from them [-]. Collective.
template <int dim>
PetscErrorCode shear_beside(const SoilElements<dim> &soil, const CellSet &piece, const CellSet &cells, double *share);

/// Volume, extent and, in plane strain, slip surface of one of the pieces. The slip surface has one point for each
/// strip of the width of an element in which the piece lies: the Gauss point that shears most. Collective.
template <int dim>
void describe_motion(const SoilElements<dim> &soil, const CellSet &piece, Mechanism *mechanism);

}  // namespace talus
