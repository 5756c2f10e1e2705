#include "physics/prescribed_pressure.h"

#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/water_source.h"

namespace talus {

template <int dim>
PrescribedPressure<dim>::PrescribedPressure(const Scene &scene)
    : table_(&scene.water->table),
      level_(&scene.water->level),
      excess_(&scene.water->excess),
      open_water_load_(scene.water->open_water_load),
      density_(scene.water->density),
      vertical_(scene.vertical()),
      unit_weight_(density_ * scene.gravity_size()),
      ratio_(scene.body.size()) {
  for (const BodySource &body : scene.body) table_of_.push_back(&body.water_table);
}

template <int dim>
double PrescribedPressure<dim>::saturation(const BodySource &body, const Vec<dim> &x, double t, int soil) const {
  if (below_table(x, t, soil)) return 1;
  const double drained = seeped_saturation_ ? seeped_saturation_(body, x.data()) : NAN;
  return std::isnan(drained) ? body.saturation : drained;
}

template class PrescribedPressure<2>;
template class PrescribedPressure<3>;

}  // namespace talus
