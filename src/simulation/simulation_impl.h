#pragma once
/// A simulation of one dimension: its run, stage by stage, and what a host program asks of it.
#include "scene/scene.h"
#include "simulation/drains.h"
#include "simulation/model.h"
#include "simulation/run.h"
#include "simulation/stages/factor_of_safety.h"

namespace talus {

template <int dim>
class Simulation final : public AnySimulation {
 public:
  Simulation(MPI_Comm comm, const Scene &scene, const RunOptions &options, const std::string &mesh_file)
      : run_(comm, scene, options, mesh_file) {
    if (scene.finds_factor()) check_strength(run_.world);
  }

  void run() override;
  void advance_to(double t) override;
  double single_step() override;
  FactorOfSafety factor_of_safety() override;

  double time() const override { return run_.clock.time; }
  long long steps() const override { return run_.clock.steps; }
  long long remaps() const override { return run_.dynamics.remaps(); }
  long long particles() const override { return run_.world.particle_count; }
  double mass() const override { return run_.world.total_mass; }
  double critical_step(const std::array<double, 2> &damping_frequencies) override {
    return run_.dynamics.critical_step(damping_frequencies);
  }
  std::string step_bound() const override { return run_.dynamics.step_bound().sentence(); }
  MeshReport mesh_report() const override {
    MeshReport report = run_.world.mesh.report();
    for (const auto &more : {run_.options.mesh.remarks, regions_without_soil(), water_without_soil(run_.world)})
      report.remarks.insert(report.remarks.end(), more.begin(), more.end());
    return report;
  }
  std::vector<BodyReport> bodies() override { return run_.world.report(); }
  std::vector<SoilFace> surface() const override { return run_.world.surface(); }
  std::vector<std::array<double, 3>> downhill(const std::vector<std::string> &groups) const override {
    return run_.world.downhill(groups);
  }
  std::string model() const override { return model_of(run_.world); }
  Snapshot snapshot() override { return run_.recorder.snapshot(); }
  const HistoryTable &history() const override { return run_.recorder.history(); }
  const std::vector<Event> &events() const override { return run_.recorder.events(); }
  const Breakdown &breakdown() const override { return run_.world.breakdown; }
  void nodal_field(const std::string &name, const std::function<void(PetscInt, const double *)> &put) override;

 private:
  std::vector<std::string> regions_without_soil() const;
  void begin();
  void note_bodies();
  void note_state();
  void note_volumes();
  void note_gaps();
  void note_water_drawn();
  void note_dilation();
  void step_until(double t);
  template <class Act>
  auto told(Act &&act);

  Run<dim> run_;
};

/// What `act` gives; a failure on the way is told by the recorder, with where the run stood.
template <int dim>
template <class Act>
auto Simulation<dim>::told(Act &&act) {
  try {
    return act();
  } catch (const MotionFailure &failure) {
    note_volumes();
    run_.recorder.fail(failure.what());
  } catch (const RunFailure &failure) {
    run_.recorder.fail(failure.what());
  } catch (const RunError &) {
    throw;
  } catch (const std::runtime_error &error) {  // results that cannot be written: say how far the run came
    run_.recorder.fail(error.what());
  }
}

}  // namespace talus
