#include "simulation/work.h"

#include "scene/transfer_source.h"

namespace talus {

WorkRates::WorkRates(const Transfer &settings) {
  if (settings.remap_interval == 0) usual_steps_ = 1;
  if (!settings.average_stress) step_of_cell_ = 2, step_of_particle_ = 1.5;
}

}  // namespace talus
