/// The list of stop criteria: one line to add one.
#include <stdexcept>

#include "scene/stage.h"
#include "simulation/stops/duration.h"
#include "simulation/stops/equilibrium.h"
#include "simulation/stops/failure.h"
#include "simulation/stops/rest.h"

namespace talus {

template <int dim>
std::unique_ptr<StopCriterion<dim>> make_stop_criterion(const Stage &stage) {
  switch (stage.until) {
    case StopWhen::duration:
      return std::make_unique<StopAtDuration<dim>>();
    case StopWhen::equilibrium:
      return std::make_unique<StopAtEquilibrium<dim>>(stage);
    case StopWhen::rest:
      return std::make_unique<StopAtRest<dim>>(stage);
    case StopWhen::failure:
      return std::make_unique<StopAtFailure<dim>>(stage);
  }
  throw std::logic_error("stop criterion without a class");
}

template std::unique_ptr<StopCriterion<2>> make_stop_criterion<2>(const Stage &);
template std::unique_ptr<StopCriterion<3>> make_stop_criterion<3>(const Stage &);

}  // namespace talus
