/// The list of the kinds of stages: one line to add one.
#include "scene/stage.h"
#include "simulation/stages/consolidation.h"
#include "simulation/stages/dynamic.h"
#include "simulation/stages/equilibrium.h"
#include "simulation/stages/seepage.h"

namespace talus {

template <int dim>
std::unique_ptr<StageRunner<dim>> make_stage_runner(Run<dim> &run) {
  switch (run.stage().kind) {
    case StageKind::dynamic:
      return std::make_unique<DynamicStage<dim>>(run);
    case StageKind::quasi_static:
      return std::make_unique<EquilibriumStage<dim>>(run);
    case StageKind::seepage:
      return std::make_unique<SeepageStage<dim>>(run);
    case StageKind::consolidation:
      return std::make_unique<ConsolidationStage<dim>>(run);
  }
  throw std::logic_error("kind of stage without a class");
}

template std::unique_ptr<StageRunner<2>> make_stage_runner(Run<2> &);
template std::unique_ptr<StageRunner<3>> make_stage_runner(Run<3> &);

}  // namespace talus
