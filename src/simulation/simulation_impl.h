#pragma once
/// The time loop, docs/theory section 5; compiled once per dimension.
#include <petsctime.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "output/checkpoint.h"
#include "output/history.h"
#include "output/pictures.h"
#include "output/progress.h"
#include "output/snapshots.h"
#include "physics/any_soil_motion.h"
#include "physics/phase_models.h"
#include "physics/prescribed_pressure.h"
#include "simulation.h"
#include "solvers/critical_step.h"
#include "solvers/integrators.h"
#include "solvers/quasi_static/flow_step.h"
#include "solvers/quasi_static/strength_reduction.h"

namespace talus {

/// Turns a PETSc error into an exception, where no PETSc function stands between thrower and catcher.
inline void require(PetscErrorCode error) {
  if (error) throw RunError("PETSc reported error " + std::to_string(error) + " (its message stands above)");
}

/// Four digits, for messages.
inline std::string rounded(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

template <int dim>
class Simulation final : public AnySimulation {
 public:
  Simulation(MPI_Comm comm, Scene &scene, const RunOptions &options, const std::string &mesh_file);

  void run() override;
  void advance_to(double t) override;
  double single_step() override;
  double time() const override { return time_; }
  long long steps() const override { return steps_; }
  long long remaps() const override { return remaps_; }
  long long particles() const override { return particle_count_; }
  double mass() const override { return total_mass_; }
  double critical_step() override;
  MeshReport mesh_report() const override { return mesh_.report(); }
  std::vector<BodyReport> bodies() override;
  Snapshot snapshot() override;
  const HistoryTable &history() const override { return history_; }
  const std::vector<Event> &events() const override { return events_; }
  const Breakdown &breakdown() const override { return breakdown_; }
  void nodal_field(const std::string &name, const std::function<void(PetscInt, const double *)> &put) override;
  FactorOfSafety factor_of_safety() override;

 private:
  struct Followed {  // a named point's particle, known on the rank that has it
    std::string name;
    int body = -1;
    PetscInt id = -1;
    int index = -1;
  };
  struct Results {  // files of a run
    RunFile file;
    History history;
    Progress progress;
  };
  /// How far a stage is, and what its stop criterion has seen.
  struct StageState {
    int number = -1;                 // -1: before the first
    double begin = 0;                // [s]
    bool met = false, told = false;  // the criterion is met; it was said how the stage ended
    int quiet_checks = 0;
    double failure_time = -1, failure_load_time = 0, last_rise_time = 0, last_rise_speed = 0;
  };
  /// What all ranks learn from one another after a step.
  struct Verdict {
    double moved = 0, shrink = 1, speed_squared = 0, watched_speed = -1;
    bool inverted = false, broken = false, interrupted = false;
  };

  // setup
  void check_bodies() const;
  void check_boundaries(const std::vector<typename Conditions<dim>::Source> &sources) const;
  void check_seeded(const Body<dim> &body, const std::string &path) const;
  void check_step();
  void check_pictures();
  void seed_bodies();
  double soil_density(const BodySource &source, const Vec<dim> &x, double t) const;
  void follow_points();
  bool explicit_drag() const { return scene_.water.drag == PoreDrag::at_start; }
  // time loop
  PetscErrorCode hold_supports(bool held);
  void run_stage();
  void start_stage();
  void set_loading(const Stage &stage, double stage_time);
  PetscErrorCode step(double until);  ///< time that it must not pass
  PetscErrorCode release(bool to_next);
  PetscErrorCode remap();
  PetscErrorCode check_conservation();
  Verdict agree();
  void refuse(const Verdict &verdict);
  void heed_interrupt(const Verdict &verdict);
  bool stage_ends(const Stage &stage, double stage_time, const Verdict &verdict);
  void reset_displacement();
  // quasi-static stages
  void run_quasi_static(const Stage &stage);
  void make_statics();
  PetscErrorCode activate();
  bool flow_stages() const {
    return std::any_of(scene_.stage.begin(), scene_.stage.end(), [](const Stage &s) { return water_flows(s.kind); });
  }
  void follow_water(const Stage &stage, const std::function<double(double)> &load_at,
                    const std::function<void(double)> &done, double *share, StepOutcome *outcome, int *iterations);
  void start_stress();
  void choose_bodies(const Stage &stage);
  void count_particles();
  void to_particles();
  void to_gauss_points();
  void fill_pores();
  void pressure_from_particles();
  Snapshot gauss_points() const;
  std::vector<Vec<dim>> nodal_displacement();  ///< of mesh nodes; only nodes of the filled grid have one
  // output
  void open_results();
  void resume_results();
  void name_columns();
  double longest_duration() const;
  void write_snapshot();
  void write_history();
  void write_checkpoint();
  CheckpointHeader header() const;
  void check_header(const CheckpointHeader &found) const;
  unsigned long long mesh_fingerprint() const;
  PetscErrorCode serialize(Archive &archive);
  void note(const std::string &text);
  void note_steps();
  int find(Followed &point);
  std::string place_of(bool mine, const Vec<dim> &where) const;
  std::string nearest_particle(const Vec<dim> &where) const;
  std::string text_of(bool mine, std::string text) const;  ///< that of the first rank which has one
  [[noreturn]] void fail(const std::string &text);

  MPI_Comm comm_;
  Scene &scene_;
  const PhaseTraits phases_;
  RunOptions options_;
  std::vector<Law> laws_;
  IntegratorSettings integrator_settings_;
  std::unique_ptr<Integrator> integrator_;
  BackgroundMesh<dim> mesh_;
  PrescribedPressure<dim> pressure_;
  std::vector<std::unique_ptr<Body<dim>>> bodies_;
  Conditions<dim> conditions_;
  std::unique_ptr<AnySoilMotion<dim>> motion_;
  std::vector<CriticalStep<dim>> critical_;
  std::vector<std::vector<int>> movers_;
  std::vector<Followed> points_;
  std::unique_ptr<PoreFlow<dim>> flow_;  ///< where pore fluids move
  std::unique_ptr<QuasiStatic<dim>> statics_;
  std::vector<char> present_;  ///< bodies that are there now
  bool in_statics_ = false, moved_since_statics_ = false;
  double strength_factor_ = 1;  ///< by which quasi-static stages divide strength

  std::string stage_name_;
  double time_ = 0, load_time_ = 0, critical_step_ = 0, shrink_ = 1, impulse_time_ = 0, last_step_ = 0;
  double omega_max_ = 0;  ///< of the filled mesh, at step omega_step_ [1/s]
  long long omega_step_ = -1;
  long long steps_ = 0, remaps_ = 0, particle_count_ = 0, since_sort_ = 0;
  double total_mass_ = 0, first_energy_ = 0;
  std::vector<double> first_ledger_;  ///< fluid masses at the start [kg]
  bool hold_loads_ = false, remap_due_ = false;
  std::string watched_;
  StageState stage_;

  std::unique_ptr<Results> results_;
  long long last_row_step_ = -1, checkpoints_ = 0;
  double last_row_time_ = -1, last_snapshot_time_ = -1, checkpoint_time_ = -1;  ///< [s]
  HistoryTable history_;
  std::vector<Event> events_;
  Breakdown breakdown_;
};

}  // namespace talus
