#pragma once
/// Quasi-static equilibrium along a path of loads.
#include "simulation/stages/static_stage.h"

namespace talus {

template <int dim>
class EquilibriumStage final : public StaticStage<dim> {
 public:
  using StaticStage<dim>::StaticStage;

 private:
  using typename StaticStage<dim>::Path;
  void follow(Path &path) override {
    const Stage &stage = this->stage_;
    QuasiStatic<dim> &problem = this->run_.statics.problem();
    const auto advance = [&](double from, double to, StepOutcome *outcome) {
      const double before = this->load_at(from), after = this->load_at(to);
      return problem.advance(to, after, before, after - before, stage.softening, outcome);
    };
    // a trial of the factor finds it sooner than small steps do; friction of a base has no bound by psi = phi
    std::function<PetscErrorCode(StepOutcome *)> failure;
    if (this->run_.statics.for_factor &&
        std::ranges::none_of(this->run_.world.conditions.sources(),
                             [](const auto &source) { return source.kind.quasi_static == OnSoil::contact; }))
      failure = [&](StepOutcome *outcome) {
        return find_failure(problem, this->run_.world.laws, this->load_at(1), this->run_.clock.time, outcome);
      };
    require(follow_path(
        1. / stage.load_steps, this->run_.scene.quasi_static.smallest_step, advance, failure,
        [&](double share, const StepOutcome &) { this->done(share); }, &path.share, &path.last, &path.iterations));
  }
  void describe(const Path &path, std::ostream &text) override { this->describe_equilibrium(path, text); }
};

}  // namespace talus
