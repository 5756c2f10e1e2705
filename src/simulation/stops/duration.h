#pragma once
/// The stage takes its duration.
#include "simulation/run.h"

namespace talus {

template <int dim>
class StopAtDuration final : public StopCriterion<dim> {
 public:
  bool met(Run<dim> &, const Verdict &) override { return false; }
  bool early() const override { return false; }
};

}  // namespace talus
