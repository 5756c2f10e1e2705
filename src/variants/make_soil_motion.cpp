#include "physics/phase_models.h"
#include "physics/soil_motion.h"
#include "scene/scene.h"

namespace talus {

template <int dim>
std::unique_ptr<AnySoilMotion<dim>> make_soil_motion(const MotionParts<dim> &parts) {
  return visit_phases(parts.scene.phases, [&](auto phases) -> std::unique_ptr<AnySoilMotion<dim>> {
    return std::make_unique<SoilMotion<dim, decltype(phases)>>(parts);
  });
}

template std::unique_ptr<AnySoilMotion<2>> make_soil_motion(const MotionParts<2> &);
template std::unique_ptr<AnySoilMotion<3>> make_soil_motion(const MotionParts<3> &);

}  // namespace talus
