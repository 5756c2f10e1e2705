#pragma once
/// The slip surface of a mechanism of failure and the soil that moves with it.
#include "solvers/quasi_static/factor_of_safety.h"
#include "solvers/quasi_static/soil_elements.h"

namespace talus {

/// Finds both in soil whose last accepted increment was a mechanism. The moving volume is that of the Gauss points that
/// move by more than a tenth of the largest displacement. The slip surface, in plane strain only, has one point for
/// each strip of the soil of the width of an element in which soil moves: the Gauss point that shears most. Collective.
template <int dim>
void find_slip_surface(const SoilElements<dim> &soil, FactorOfSafety *result);

}  // namespace talus
