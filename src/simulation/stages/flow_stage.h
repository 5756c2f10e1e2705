#pragma once
/// What stages in which pore water flows have in common, docs/theory/seepage.md.
#include "simulation/stages/static_stage.h"
#include "solvers/quasi_static/flow_path.h"

namespace talus {

template <int dim>
class FlowStage : public StaticStage<dim> {
 public:
  using StaticStage<dim>::StaticStage;

 protected:
  using typename StaticStage<dim>::Path;
  bool water_flows() const final { return true; }
  void follow(Path &path) final {
    const Stage &stage = this->stage_;
    const FlowPath flow{stage.duration,
                        stage.steady,
                        stage.load_steps,
                        stage.softening,
                        [this](double share) { return this->load_at(share); },
                        [this](double share) { this->done(share); }};
    Statics<dim> &statics = this->run_.statics;
    require(follow_flow(this->run_.world.comm, this->soil_moves() ? &statics.problem() : nullptr, statics.flow(),
                        this->run_.scene.quasi_static, flow, &path.share, &path.last, &path.iterations));
  }
};

}  // namespace talus
