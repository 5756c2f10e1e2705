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
    const FluidBooks &books = this->run_.recorder.fluids();
    const double seeped = books.seeped(), handed = books.handed(0);
    require(follow_flow(this->run_.world.comm, this->soil_moves() ? &statics.problem() : nullptr, statics.flow(),
                        this->run_.scene.quasi_static, flow, &path.share, &path.last, &path.iterations));
    entered_ = books.seeped() - seeped, handed_ = books.handed(0) - handed;
  }
  /// Water that entered, and what of it particles hold where water moves with them.
  void describe_water(std::ostream &text) const {
    if (!this->run_.world.phases.liquid) return;
    text << "; " << std::abs(entered_) << " kg of water " << (entered_ < 0 ? "left" : "entered")
         << ", and particles hold " << std::abs(entered_ + handed_) << " kg "
         << (entered_ + handed_ < 0 ? "less" : "more");
  }

 private:
  double entered_ = 0, handed_ = 0;  ///< [kg]
};

}  // namespace talus
