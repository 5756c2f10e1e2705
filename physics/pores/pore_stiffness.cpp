#include "physics/pores/pore_stiffness.h"

#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/water_source.h"

namespace talus {

PoreStiffness pore_stiffness(const Scene &scene, const BodySource &body, int fluids, bool implicit) {
  PoreStiffness pores{body.porosity, {}};
  if (fluids > 0) pores.fluids.push_back({scene.water->density, implicit ? 0 : scene.water->bulk_modulus});
  if (fluids > 1) pores.fluids.push_back({scene.gas->density, scene.gas->bulk_modulus});
  return pores;
}

}  // namespace talus
