#pragma once
/// Flow of pore water through soil at rest.
#include "scene/stage.h"
#include "simulation/stages/flow_stage.h"

namespace talus {

template <int dim>
class SeepageStage final : public FlowStage<dim> {
 public:
  SeepageStage(Run<dim> &run, const SeepageKeys &keys) : FlowStage<dim>(run, keys), seepage_(keys) {}

 private:
  using typename StaticStage<dim>::Path;
  bool steady() const override { return seepage_.steady; }
  void describe(const Path &path, std::ostream &text) override {
    text << "stage " << this->stage_.name
         << (steady() ? " has found the flow that lasts: " : " has followed the water: ") << path.iterations
         << " iterations";
    for (const auto &[name, inflow] : this->run_.statics.flow().own_inflow())
      text << "; " << inflow << " m3/s enter at " << name;
    if (const double inflow = this->run_.statics.flow().unnamed_inflow(); inflow != 0)
      text << "; " << inflow << " m3/s enter by faces that no boundary names";
    this->describe_water(text);
  }

  const SeepageKeys &seepage_;
};

}  // namespace talus
