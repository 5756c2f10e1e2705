#pragma once
/// What a Soil takes from the tables of its scene.
#include <string>
#include <vector>

#include "physics/boundary/boundary.h"
#include "physics/laws/laws.h"

namespace talus {

struct BodySource;
struct Scene;

struct SoilTables {
  const BodySource &body;
  std::string region;
  Law law;
  double density;  ///< of particles, with full pores unless fluids move on their own [kg/m3]
  std::vector<NamedBoundary> boundaries;
};
SoilTables tables_of(const Scene &scene, bool fluids_move);

}  // namespace talus
