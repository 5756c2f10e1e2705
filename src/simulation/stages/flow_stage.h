#pragma once
/// What stages in which pore water flows have in common, docs/theory/seepage.md.
#include "scene/quasi_static_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation/changing_loads.h"
#include "simulation/stages/static_stage.h"
#include "solvers/quasi_static/flow_path.h"
#include "solvers/quasi_static/undrained_strength.h"

namespace talus {

template <int dim>
class FlowStage : public StaticStage<dim> {
 public:
  using StaticStage<dim>::StaticStage;

 protected:
  using typename StaticStage<dim>::Path;
  /// Is the flow that of the loads at the end, which lasts?
  virtual bool steady() const { return false; }
  void follow(Path &path) final {
    const Stage &stage = this->stage_;
    Statics<dim> &statics = this->run_.statics;
    FlowPath flow{stage.duration,
                  steady(),
                  this->keys_.load_steps,
                  stage.softening,
                  [this](double share) { return this->load_at(share); },
                  [this](double share) { this->done(share); },
                  events(),
                  {}};
    if (this->soil_moves() && !statics.problem().supports().moves())
      flow.find_failure = [&](double share, StepOutcome *outcome) {
        return find_undrained_failure(statics.problem(), statics.flow(), this->run_.world.laws, this->load_at(share),
                                      this->run_.clock.time, outcome);
      };
    const FluidBooks &books = this->run_.recorder.fluids();
    const double seeped = books.seeped(), handed = books.handed(0);
    require(follow_flow(this->run_.world.comm, this->soil_moves() ? &statics.problem() : nullptr, statics.flow(),
                        *this->run_.scene.quasi_static, flow, &path.share, &path.last, &path.iterations));
    entered_ = books.seeped() - seeped, handed_ = books.handed(0) - handed;
    if (this->run_.world.phases.liquid) water_ = this->run_.fluids()[0].stored;
  }
  /// Water that entered, and what of it particles hold where water moves with them.
  void describe_water(std::ostream &text) const {
    if (!this->run_.world.phases.liquid) return;
    const double took = entered_ + handed_;
    const auto digits = text.precision(6);
    text << "; " << std::abs(entered_) << " kg of water " << (entered_ < 0 ? "left" : "entered")
         << ", and particles hold " << std::abs(took) << " kg " << (took < 0 ? "less" : "more") << " than before";
    text.precision(digits);
    if (std::abs(handed_) > visible * std::abs(entered_) && std::abs(handed_) > visible / 100 * water_)
      text << " (water_handed_kg of the history; smaller cells lose or gain less at fronts of the water)";
  }

 private:
  /// Shares of the stage at which what acts changes.
  std::vector<double> events() const {
    const Stage &stage = this->stage_;
    if (stage.hold_loads || steady()) return {};
    const auto &[low, high] = this->run_.world.mesh_box;
    const double begin = this->load_at(0), end = this->load_at(1);
    std::vector<double> shares = load_events(this->run_.scene, low, high, begin, end);
    for (double &t : shares) t = (t - begin) / (end - begin);
    return shares;
  }

  static constexpr double visible = 0.1;         ///< of the water that enters
  double entered_ = 0, handed_ = 0, water_ = 0;  ///< water_: in the soil [kg]
};

}  // namespace talus
