#include "simulation/scene_keys.h"

#include "earthquake/sources.h"
#include "physics/boundary/kinds.h"
#include "physics/laws/drainage.h"
#include "physics/laws/laws.h"
#include "physics/pores/permeability.h"
#include "physics/pores/retention.h"
#include "solvers/integrators.h"

namespace talus {

Describer scene_keys() {
  Describer keys;
  describe_scene(keys);
  describe_one_of<Laws>(keys, "body.NAME", "law");
  keys.add({"[body.NAME] drainage", "body.NAME", "Drainage of a soil, beside its law.", "", {}}, Drainage{});
  describe_one_of<Retention>(keys, "body.NAME.retention", "curve");
  describe_one_of<RelativePermeability>(keys, "body.NAME.relative_permeability", "curve");
  describe_one_of<BoundaryKinds>(keys, "boundary.NAME", "kind");
  describe_one_of<MotionSource>(keys, "earthquake.N", "kind");
  describe_one_of<IntegratorSettings>(keys, "integrator", "kind");
  return keys;
}

}  // namespace talus
