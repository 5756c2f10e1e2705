#include "physics/pores/pore_stiffness.h"

#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/water_source.h"

namespace talus {

PoreStiffness pore_stiffness(const Scene &scene, const BodySource &body, int fluids) {
  PoreStiffness pores{body.porosity, {}};
  const bool implicit = scene.water->pressure == PoreIntegration::at_end;
  if (fluids > 0) pores.fluids.push_back({scene.water->density, implicit ? 0 : scene.water->bulk_modulus});
  if (fluids > 1) pores.fluids.push_back({scene.gas->density, scene.gas->bulk_modulus});
  return pores;
}

}  // namespace talus
