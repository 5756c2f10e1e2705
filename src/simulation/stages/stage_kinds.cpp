/// The list of the kinds of stages: one line to add one, as in scene/stage.h.
#include "scene/stage.h"
#include "simulation/stages/consolidation.h"
#include "simulation/stages/dynamic.h"
#include "simulation/stages/equilibrium.h"
#include "simulation/stages/factor_of_safety.h"
#include "simulation/stages/seepage.h"

namespace talus {

template <int dim>
DynamicStage<dim> runner_of(const DynamicKeys &);
template <int dim>
EquilibriumStage<dim> runner_of(const QuasiStaticKeys &);
template <int dim>
SeepageStage<dim> runner_of(const SeepageKeys &);
template <int dim>
ConsolidationStage<dim> runner_of(const ConsolidationKeys &);
template <int dim>
FactorStage<dim> runner_of(const FactorKeys &);

template <int dim>
std::unique_ptr<StageRunner<dim>> make_stage_runner(Run<dim> &run) {
  return std::visit(
      [&](const auto &keys) -> std::unique_ptr<StageRunner<dim>> {
        return std::make_unique<decltype(runner_of<dim>(keys))>(run, keys);
      },
      run.stage().kind);
}

template std::unique_ptr<StageRunner<2>> make_stage_runner(Run<2> &);
template std::unique_ptr<StageRunner<3>> make_stage_runner(Run<3> &);

}  // namespace talus
