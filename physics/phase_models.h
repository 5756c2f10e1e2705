#pragma once
/// From the scene's choice of phases to the type that the kernel is compiled for: the only run-time branch on it.
#include <stdexcept>

#include "base/phases.h"
#include "scene/phase_model.h"

namespace talus {

/// Calls visit(Dry{}), visit(Drained{}) and so on.
template <class Visit>
auto visit_phases(PhaseModel model, Visit &&visit) {
  switch (model) {
    case PhaseModel::dry:
      return visit(Dry{});
    case PhaseModel::drained:
      return visit(Drained{});
    case PhaseModel::saturated:
      return visit(Saturated{});
    case PhaseModel::unsaturated:
      return visit(Unsaturated{});
    case PhaseModel::three_phase:
      return visit(ThreePhase{});
  }
  throw std::logic_error("phase model without a kernel");
}

inline PhaseTraits phase_traits(PhaseModel model) {
  return visit_phases(model, [](auto phases) { return traits_of<decltype(phases)>; });
}

}  // namespace talus
