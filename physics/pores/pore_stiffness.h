#pragma once
/// How stiff and how heavy the pores of a soil are at most, for its largest frequency, docs/theory/pores.md (6.1).
#include <vector>

namespace talus {

struct BodySource;
struct Scene;

/// Fluids that move on their own: full pores of each, the stiffest they can be.
struct PoreStiffness {
  double porosity = 0;
  struct Fluid {
    double density;
    double bulk_modulus;  ///< 0: its pressure is implicit in time and bounds no step [Pa]
  };
  std::vector<Fluid> fluids;
};

/// The pores of a body at the start, with as many moving `fluids` as its phase model has: liquid, then gas. `implicit`:
/// the pressure of the liquid is.
PoreStiffness pore_stiffness(const Scene &scene, const BodySource &body, int fluids, bool implicit);

}  // namespace talus
