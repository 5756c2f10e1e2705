#pragma once
/// Quasi-static equilibrium along a path of loads.
#include "scene/quasi_static_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/start_from.h"
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
    std::vector<Law> laws;
    for (size_t b = 0; b < this->run_.world.laws.size(); ++b) laws.push_back(this->run_.statics.law_in(stage, b));
    const double tolerance = this->run_.scene.quasi_static->tolerance, &time = this->run_.clock.time;
    const bool may_creep = problem.may_creep(stage.softening), at_once = may_creep && first();
    const auto advance = [&](double from, double to, StepOutcome *outcome) -> PetscErrorCode {
      const double before = this->load_at(from), after = this->load_at(to);
      PetscFunctionBeginUser;
      PetscCall(problem.advance(to, after, before, after - before, stage.softening, outcome));
      const bool ended = outcome->converged || outcome->stopped || !outcome->moving.empty();
      if (ended || !may_creep || at_once) PetscFunctionReturn(0);
      PetscCall(creep_to(problem, to, after, time, tolerance, outcome));
      PetscFunctionReturn(0);
    };
    std::function<PetscErrorCode(StepOutcome *)> decide;
    if (at_once)
      decide = [&](StepOutcome *outcome) -> PetscErrorCode {
        PetscFunctionBeginUser;
        PetscCall(settle(problem, laws, this->load_at(1), time, tolerance, &this->run_.statics.dilated, outcome));
        if (outcome->converged) left_at_ = path.share;
        PetscFunctionReturn(0);
      };
    else if (this->run_.leads_to_factor() && !on_base())  // friction of a base has no bound by psi = phi
      decide = [&](StepOutcome *outcome) { return find_failure(problem, laws, this->load_at(1), time, outcome); };
    require(follow_path(
        1. / this->keys_.load_steps, this->run_.scene.quasi_static->smallest_step, advance, decide,
        [&](double share, const StepOutcome &) { this->done(share); }, &path.share, &path.last, &path.iterations));
  }
  bool on_base() const {
    return std::ranges::any_of(this->run_.world.conditions.sources(),
                               [](const auto &source) { return source.kind.quasi_static == OnSoil::contact; });
  }
  /// In the first stage the share of gravity that was reached says nothing of the soil, and so long as no strength is
  /// lost, another way to the state under all of it will do. Later stages end where their loads find no equilibrium.
  bool first() const {
    const bool may_go_on = this->keys_.when_lost != WhenLost::stop && !this->run_.leads_to_factor();
    return this->run_.progress.number == 0 && this->run_.scene.start_from->folder.empty() && !may_go_on;
  }
  void describe(const Path &path, std::ostream &text) override {
    this->describe_equilibrium(path, text);
    if (left_at_ >= 0)
      text << "; its load steps ended at " << 100 * left_at_ << " %, and the rest came at once, "
           << (this->run_.statics.dilated
                   ? "against an elastic prop that was then taken away, in soil that moved with psi = phi: it bears "
                     "this stress with its own psi too, but lateral stress and displacements are those of soil that "
                     "dilates"
                   : "under which the soil crept to rest: displacements depend on this way more than stresses do")
           << ". Other load_steps (here " << this->keys_.load_steps
           << ") may do without, and so may initial_stress = \"k0\"";
  }
  double left_at_ = -1;  ///< share of the loads where Newton's iterations ended before; -1: they did not
};

}  // namespace talus
