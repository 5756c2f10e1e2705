#pragma once
/// Equilibrium of the soil and flow of its pore water together in time.
#include "simulation/stages/flow_stage.h"

namespace talus {

template <int dim>
class ConsolidationStage final : public FlowStage<dim> {
 public:
  using FlowStage<dim>::FlowStage;

 private:
  using typename StaticStage<dim>::Path;
  void describe(const Path &path, std::ostream &text) override {
    this->describe_equilibrium(path, text), this->describe_water(text);
  }
};

}  // namespace talus
