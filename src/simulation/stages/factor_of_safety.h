#pragma once
/// Factor of safety by reduction of strength from the state of the stage before, docs/theory/finite_elements.md section
/// 5. The soil is afterwards as it was.
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation/stages/stage_runner.h"

namespace talus {

/// Refuses soil whose strength cannot be divided.
template <int dim>
void check_strength(const World<dim> &world);

template <int dim>
class FactorStage final : public StageRunner<dim> {
 public:
  FactorStage(Run<dim> &run, const FactorKeys &) : run_(run), stage_(run.stage()) {}
  void run() override;

 private:
  void begin();
  const Stage *stage_before() const;
  FactorOfSafety search();
  void report(const FactorOfSafety &found);
  void show_mechanism();
  /// Of the files with its results, without their endings; empty: none are written.
  std::string results() const;

  Run<dim> &run_;
  const Stage &stage_;
};

}  // namespace talus
