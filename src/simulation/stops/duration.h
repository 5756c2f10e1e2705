#pragma once
/// The stage takes its duration.
#include "scene/stage.h"
#include "simulation/run.h"

namespace talus {

template <int dim>
class StopAtDuration final : public StopCriterion<dim> {
 public:
  StopAtDuration(const Stage &, const AtDuration &) {}

  bool met(Run<dim> &, const Verdict &) override { return false; }
};

}  // namespace talus
