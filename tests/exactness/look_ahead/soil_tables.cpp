#include "soil_tables.h"

#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/scene.h"
#include "scene/water_source.h"

namespace talus {

SoilTables tables_of(const Scene &scene, bool fluids_move) {
  const BodySource &body = scene.body[0];
  const double water = fluids_move ? 0 : body.porosity * scene.water->density,
               density = body.density > 0 ? body.density : (1 - body.porosity) * body.grain_density + water;
  SoilTables tables{body, body.region[0], read_law(body.law), density, {}};
  for (const BoundarySource &b : scene.boundary)
    tables.boundaries.push_back({b.name, b.group.empty() ? std::vector{b.name} : b.group, read_boundary(b.kind)});
  return tables;
}

}  // namespace talus
