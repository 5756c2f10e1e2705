/// The list of stop criteria: one line to add one, as in scene/stops/stops.h.
#include "scene/stage.h"
#include "simulation/stops/duration.h"
#include "simulation/stops/equilibrium.h"
#include "simulation/stops/failure.h"
#include "simulation/stops/rest.h"

namespace talus {

template <int dim>
StopAtDuration<dim> criterion_of(const AtDuration &);
template <int dim>
StopAtEquilibrium<dim> criterion_of(const AtEquilibrium &);
template <int dim>
StopAtRest<dim> criterion_of(const AtRest &);
template <int dim>
StopAtFailure<dim> criterion_of(const AtFailure &);

template <int dim>
std::unique_ptr<StopCriterion<dim>> make_stop_criterion(const Stage &stage) {
  if (!stage.motion()) return nullptr;
  return std::visit(
      [&](const auto &keys) -> std::unique_ptr<StopCriterion<dim>> {
        return std::make_unique<decltype(criterion_of<dim>(keys))>(stage, keys);
      },
      stage.motion()->until);
}

template std::unique_ptr<StopCriterion<2>> make_stop_criterion<2>(const Stage &);
template std::unique_ptr<StopCriterion<3>> make_stop_criterion<3>(const Stage &);

}  // namespace talus
