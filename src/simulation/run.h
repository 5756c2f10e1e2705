#pragma once
/// The parts of a run, which its stages act on, and how far it is. None of the parts knows this one.
#include <cmath>

#include "output/deal.h"
#include "simulation/recorder.h"
#include "simulation/stops/stop_criterion.h"

namespace talus {

/// How far the present stage is.
struct StageProgress {
  int number = -1;      ///< -1: before the first
  double begin = 0;     ///< [s]
  bool met = false;     ///< its stop criterion is met, or its path followed
  bool told = false;    ///< it was said how it ended
  bool resets = false;  ///< its end sets displacements to zero
};

template <int dim>
struct Run {
  /// Throws SceneError for a scene that does not fit its mesh or its phase model. The scene must outlive the run.
  /// Collective.
  Run(MPI_Comm comm, const Scene &scene, const RunOptions &options, const std::string &mesh_file);

  const Stage &stage() const;
  bool last_stage() const;
  /// Does the run end with a factor of safety, and no motion before it? A factor does not depend on the stress from
  /// which its search starts: then the run goes on from where stages lose equilibrium, unless their soil softens.
  bool leads_to_factor() const;
  /// Has the present stage lasted longer than its duration, which a resumed run may shorten?
  bool is_past_stage() const;
  void begin_next_stage();
  /// Sums of the present state. Collective.
  Balance balance();
  /// Root mean square speed of all soil [m/s].
  double rms_speed(const Balance &sums) const { return std::sqrt(sums.moving / world.total_mass); }

  /// Particles take over the state of the finite elements.
  void hand_to_particles();
  std::vector<FluidLedger> fluids();  ///< as motion has counted them; collective

  void write_checkpoint();
  /// Goes on from the checkpoint in the directory. Throws std::invalid_argument where that cannot be. Collective.
  void resume();
  /// Displacements, velocities and plastic strain are zero from now on.
  void reset_displacement();
  /// The present stage ends by that: warns if soil has moved further than elastic soil would. Collective.
  void end_by_reset();
  /// Divides the mesh among the ranks in another way, if soil has moved so far that it is worth it: the state goes
  /// through memory as it would through a checkpoint that is resumed on another partition. Motion goes on up to time
  /// `end` at least, as far as is known. Collective.
  void balance_ranks(double end);
  /// Ends the run with checkpoint, history and snapshot if a signal has asked for it.
  void heed(const Verdict &verdict);

  const Scene &scene;
  const RunOptions options;
  const IntegratorSettings integrator;
  Clock clock;
  World<dim> world;
  TrackedPoints<dim> points;
  FollowedLines<dim> lines;
  Dynamics<dim> dynamics;
  Statics<dim> statics;
  EnergyLedger<dim> energies;
  Recorder<dim> recorder;
  StageProgress progress;
  std::unique_ptr<StopCriterion<dim>> stop;  ///< of the present stage
  std::vector<FactorOfSafety> factors;       ///< of the stages that have looked for one since the program started
  std::string moved_before;                  ///< what `end_by_reset` has warned of last
  std::string motion_left;                   ///< at the end of the last stage; empty where soil is at rest
  std::vector<std::string> start_notes;      ///< where the state at the start is from, if not from the scene
  std::string start_warning;                 ///< what was wrong with it, or ""

 private:
  /// Takes the state of another run's last checkpoint (scene.start_from). Throws SceneError where that cannot be.
  /// Collective.
  void start_from_other_run();
  /// The state of this rank, dealt out to the present partition if it was saved on another one. Throws
  /// std::invalid_argument where the mesh was another one. Collective.
  Archive state_of(Checkpoint found) const;
  Holdings holdings() const;
  PetscErrorCode serialize_state(Archive &archive);
  PetscErrorCode serialize(Archive &archive);
};

}  // namespace talus
