#pragma once
/// How stiff and how heavy the pores of a soil are at most, for its largest frequency, docs/theory/pores.md (6.1).
#include <vector>

#include "scene/scene.h"

namespace talus {

/// Fluids that move on their own: full pores of each, the stiffest they can be.
struct PoreStiffness {
  double porosity = 0;
  struct Fluid {
    double density, bulk_modulus;
  };
  std::vector<Fluid> fluids;
};

/// The pores of a body at the start, with as many moving `fluids` as its phase model has: liquid, then gas.
inline PoreStiffness pore_stiffness(const Scene &scene, const BodySource &body, int fluids) {
  PoreStiffness pores{body.porosity, {}};
  if (fluids > 0) pores.fluids.push_back({scene.water.density, scene.water.bulk_modulus});
  if (fluids > 1) pores.fluids.push_back({scene.gas.density, scene.gas.bulk_modulus});
  return pores;
}

}  // namespace talus
