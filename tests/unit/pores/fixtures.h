#pragma once
/// Soils as scenes write them.
#include <string>

#include "physics/pores/soil_pores.h"

namespace talus {

/// The pores of a body with these keys and a porosity of 0.35, in water of 10 kN/m3.
SoilPores soil_of(const std::string &text);

inline const std::string silt =
    "permeability = \"1e-12 m2\"\n[retention]\ncurve = \"van_genuchten\"\nreference_suction = \"100 kPa\"\nshape = "
    "0.3\n"
    "[relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.3\n";

/// One retention curve of each kind with a relative permeability that suits it.
inline const std::string soils[] = {
    silt,
    "[retention]\ncurve = \"brooks_corey\"\nair_entry = \"5 kPa\"\npore_size_index = 1.5\nresidual_saturation = 0.1\n"
    "[relative_permeability]\ncurve = \"brooks_corey\"\npore_size_index = 1.5\n",
    "[retention]\ncurve = \"gardner\"\ndecay_suction = \"10 kPa\"\n[relative_permeability]\ncurve = "
    "\"gardner\"\ndecay_suction = \"10 kPa\"\n",
    "[retention]\ncurve = \"linear\"\ndrying_suction = \"50 kPa\"\n[relative_permeability]\ncurve = \"hillel\"\n",
    "[retention]\ncurve = \"tabulated\"\nsuctions = [0, \"2 kPa\", \"10 kPa\", \"50 kPa\"]\nsaturations = [1, 0.95, "
    "0.5, 0.1]\n",
};

}  // namespace talus
