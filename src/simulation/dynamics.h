#pragma once
/// Motion in time: an integrator, the clock and one cycle of steps, docs/theory section 5.
#include <functional>
#include <memory>

#include "simulation/balancing.h"
#include "simulation/step_bound.h"
#include "simulation/world.h"
#include "solvers/integrators.h"

namespace talus {

/// What all ranks learn from one another after a step.
struct Verdict {
  double moved = 0;           ///< largest displacement of a node since the last remap, over its mean edge
  double shrink = 1;          ///< largest factor by which cells have cut the critical step since then
  Vec<3> watched_velocity{};  ///< what Dynamics::watch found [m/s]
  bool inverted = false;      ///< a cell is nearly empty
  bool broken = false;        ///< a velocity, a law or a function has failed
  bool interrupted = false;   ///< a signal asks the run to end
};

/// The integrator that a scene asks for. Throws SceneError where the phase model does not go with it.
IntegratorSettings choose_integrator(const Scene &scene);

template <int dim>
class Dynamics {
 public:
  /// Throws SceneError for a fixed step that the first state already forbids. The references must outlive it.
  /// Collective.
  Dynamics(World<dim> &world, Clock &clock, const IntegratorSettings &settings);

  /// A stage begins: the fastest motion of the mesh is estimated anew.
  void begin_stage() { omega_step_ = -1; }
  /// The loads are others than at the end of the last step.
  void restart() { integrator_->restart(); }
  /// What acts on the soil from now on, `stage_time` after the begin of the stage.
  void set_loading(const Stage &stage, double stage_time);
  /// One step, that does not pass the time `until`, and the remap if it is due. Throws RunFailure. Collective.
  Verdict cycle(double until);
  /// Largest stable step of the present state [s]; under Rayleigh damping with these frequencies [Hz], if there is any.
  /// Collective.
  double critical_step(const std::array<double, 2> &damping_frequencies);

  const StepBound &step_bound() const { return bound_; }
  bool fixed_step() const { return step_rule(settings_).fixed > 0; }
  long long remaps() const { return remaps_; }
  /// Was the last step followed by a remap?
  bool just_remapped() const { return just_remapped_; }
  Balancing &balancing() { return balancing_; }
  const Balancing &balancing() const { return balancing_; }
  const StepStatistics &statistics() const { return integrator_->statistics(); }
  void serialize(Archive &archive);

  /// Looked at after each step, before a remap: the velocity [m/s] of a point that a stage watches. Says whether the
  /// point is on this rank.
  std::function<bool(Vec<3> *velocity)> watch;

 private:
  void check_incoming_wave() const;
  void check_fixed_step();
  bool explicit_drag() const;
  void notice_release();
  double critical_step();
  double stable_step();
  void refuse_obstacle();
  Verdict agree();
  void refuse_broken();

  World<dim> &world_;
  Clock &clock_;
  const StepBound bound_;
  const IntegratorSettings settings_;
  std::unique_ptr<Integrator> integrator_;
  double critical_step_ = 0;                     ///< at the last remap; 0: not known [s]
  std::array<double, 2> damping_frequencies_{};  ///< for which it is known [Hz]
  double shrink_ = 1;                            ///< of the critical step since then
  double omega_max_ = 0;                         ///< of the filled mesh, at step omega_step_ [1/s]
  double moved_since_estimate_ = 0;              ///< by nodes, in mean edges, up to the last remap
  long long omega_step_ = -1, remaps_ = 0, since_sort_ = 0, known_releases_ = 0;
  bool remap_due_ = false, just_remapped_ = false;
  double work_of_rank_ = 0;  ///< in the last step
  Balancing balancing_;
};

}  // namespace talus
