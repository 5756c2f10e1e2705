#pragma once
/// How a stage is carried out. A kind of stage is one file and one line in stage_kinds.cpp.
#include <memory>

#include "simulation/run.h"

namespace talus {

template <int dim>
class StageRunner {
 public:
  virtual ~StageRunner() = default;
  /// Carries the present stage of the run, or what is left of it, to its end. Throws RunFailure. Collective.
  virtual void run() = 0;
};

/// The runner of a run's present stage.
template <int dim>
std::unique_ptr<StageRunner<dim>> make_stage_runner(Run<dim> &run);

}  // namespace talus
