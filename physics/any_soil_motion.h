#pragma once
/// The motion of the soil as the run sees it, whatever fills the pores: what SoilMotion (soil_motion.h) is compiled for
/// once per phase model, behind one interface per dimension. Virtual calls are per step or per output, never in a loop
/// of the kernel.
#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/archive.h"
#include "earthquake/shaking.h"
#include "physics/boundary/conditions.h"
#include "physics/laws/present_strength.h"
#include "physics/motion.h"
#include "physics/pores/pore_report.h"
#include "physics/pores/pressure_solves.h"
#include "physics/prescribed_pressure.h"
#include "physics/soil_motion/step_measures.h"
#include "physics/soil_motion/work_ledger.h"
#include "transfer/transfer.h"

namespace talus {

struct Scene;

/// Loading of the soil, set by the time loop before each step and read by the motion.
template <int dim>
struct Loading {
  Vec<dim> gravity{};                      ///< once the ramp of the stage is over [m/s2]
  const GroundShaking *shaking = nullptr;  ///< of the ground; null: it is at rest
  double shaken_since = 0;                 ///< time of the run at which the motion begins [s]
  bool in_frame_of_base = false;           ///< the soil is computed in the frame of the base, which shakes whole; else
                                           ///< the motion comes in as a wave
  double ramp = 1;                         ///< of the stage: gravity and with it pore pressure grow from 0 to 1
  double time = 0;                         ///< load time: the t of the scene's functions [s]
  double set_at = 0;     ///< time of the run at which ramp and load time have these values [s], and their rates:
  double ramp_rate = 0;  ///< [1/s]
  double time_rate = 1;  ///< 0 in a stage that holds loads
  double damping = 0;    ///< local damping factor
  std::array<double, 2> damping_frequencies{};  ///< of Rayleigh damping [Hz]; 0: none
  bool pore_flow = true;                        ///< pore fluids move; otherwise their pressures are prescribed
  bool softening = true;  ///< plastic strain is recorded; otherwise soil keeps the strength it has

  /// Gravity, and the inertia of what is at rest on the base, per mass [m/s2].
  Vec<dim> gravity_at(double t) const {
    Vec<dim> total = gravity;
    for (double &g : total) g *= ramp_at(t);
    if (!shaking || !in_frame_of_base) return total;
    const std::array<double, 3> base = shaking->acceleration(t - shaken_since);
    for (int d = 0; d < dim; ++d) total[d] -= base[d];
    return total;
  }
  /// Of an outcrop of the rock from which the wave comes in [m/s].
  Vec<dim> ground_velocity_at(double t) const {
    Vec<dim> velocity{};
    if (!shaking || in_frame_of_base) return velocity;
    const std::array<double, 3> ground = shaking->velocity(t - shaken_since);
    std::copy_n(ground.begin(), dim, velocity.begin());
    return velocity;
  }
  double ramp_at(double t) const { return std::min(1., ramp + ramp_rate * (t - set_at)); }
  double time_at(double t) const { return time + time_rate * (t - set_at); }
};

/// Sums over all ranks, for the ledger and the stop criteria.
struct Balance {
  double unbalanced = 0, applied = 0;  ///< sums of nodal force magnitudes [N]
  double kinetic = 0, strain = 0;      ///< [J]
  std::array<double, 3> moment{};      ///< mass times place, of the particles [kg m]
  double moving = 0;                   ///< mass times the square of the velocity at which the particles move [J]
  /// Unbalanced over applied force; 0 where no force acts at all [-].
  double ratio() const { return unbalanced == 0 ? 0 : unbalanced / applied; }
};

template <int dim>
class AnySoilMotion : public Motion {
 public:
  /// Pore pressures of the state that a step ending at t has left, where no remap comes first. Collective.
  virtual PetscErrorCode update_pore_pressures(double t) = 0;
  /// Ends the Lagrangian part: moves the particles by what the nodes received since the last remap, and clears the
  /// grid. The particles in `movers[body]` have left their cells.
  virtual PetscErrorCode update_particles(double t, std::vector<std::vector<int>> &movers) = 0;
  /// The same when `begin` follows as soon as the movers have found their new cells: particles that stay in their cell
  /// are gathered in the same sweep, `begin` adds what `movers` lists by then. In between particles have their places,
  /// but no stress and no fluids.
  virtual PetscErrorCode update_particles_and_gather(double t, std::vector<std::vector<int>> &movers) = 0;

  /// Saves or loads the state between two steps, also in the middle of a Lagrangian part, so that it does not matter
  /// to a run where it was saved. After the bodies; collective.
  virtual PetscErrorCode serialize(Archive &archive) = 0;

  Loading<dim> loading;
  virtual const StepMeasures &measures() const = 0;
  virtual bool gathered() const = 0;
  virtual const FilledGrid<dim> &grid() const = 0;
  virtual const std::vector<PointSet> &points() const = 0;
  /// Place of a node without a finite velocity on this rank; false when there is none.
  virtual bool find_broken(Vec<dim> *where) const = 0;
  /// Place and cause of the first call in which a law of this rank went wrong; false when there is none.
  virtual bool find_trouble(Vec<dim> *where, std::string *cause) const = 0;

  /// Position of a particle within the Lagrangian part, and the velocity of its momentum, docs/theory (4.10a).
  virtual void present(const Body<dim> &body, int particle, Vec<dim> *position, Vec<dim> *velocity) const = 0;
  /// `begin`, then finds the velocities at which the nodes move, docs/theory (4.9), for results. Collective.
  virtual PetscErrorCode begin_results(double t) = 0;
  /// Velocity at which a particle moves, docs/theory (4.12a); after `begin_results` of the same state.
  virtual Vec<dim> moving_velocity(const Body<dim> &body, int particle) const = 0;
  /// Stress [stress_size], history and volume of a particle within the Lagrangian part.
  virtual void state(int body, int particle, double *stress, double *history, double *volume) const = 0;
  /// By what the law has softened the strength to which this stress belongs.
  virtual SofteningInput softened_by(int body, int particle) const = 0;
  virtual const WorkDone &work() const = 0;
  /// Freezes the reactions of supports that stand in for dashpots. Collective.
  virtual PetscErrorCode freeze_reactions(double t) = 0;
  /// Sums of the present state; collective.
  virtual PetscErrorCode balance(double t, Balance *sums) = 0;

  // What only some phase models have; the others answer with nothing.

  /// Prescribed pore pressure at a place of a mesh cell [Pa]: by [water] or water of the soil's own, and the ramp, in
  /// drained scenes.
  virtual double pore_pressure(int cell, const Vec<dim> &x) const = 0;
  /// Pore pressures, suction and saturation of a particle within the Lagrangian part, where fluids move.
  virtual PoreReport pores(const Body<dim> &body, int particle) const = 0;
  /// Masses of each fluid that moves, of all ranks; collective.
  virtual PetscErrorCode fluid_ledger(FluidLedger *sums) = 0;
  /// What solves for implicit pore pressure have done; of none: no steps.
  virtual PressureSolves pressure_solves() const = 0;
  /// Of explicit drag, on this rank [1/s].
  virtual double drag_rate() const = 0;
  /// Pressure of the liquid that [water] asks for at a place, where it moves [Pa].
  virtual double initial_pressure(const Vec<dim> &x, double t) const = 0;
  /// Prepares the pores of the particles once they are seeded; with `fill` to the pressures that [water] asks for.
  virtual PetscErrorCode setup_pores(bool fill) = 0;
  /// Fills the pores of the particles, which must be off the grid, to the pressures of `liquid`(cell, place) [Pa].
  virtual void fill_pores(const std::function<double(int, const Vec<dim> &)> &liquid) = 0;
  /// Largest frequency of elastic motion of the filled mesh [1/s] by power iteration, which comes from below,
  /// docs/theory (5.7). Goes on from the mode that it found last. After `begin`; collective.
  virtual PetscErrorCode largest_frequency(int iterations, double *omega) = 0;
};

/// What a motion is made of. The references must outlive it.
template <int dim>
struct MotionParts {
  const BackgroundMesh<dim> &mesh;
  std::vector<std::unique_ptr<Body<dim>>> &bodies;
  Conditions<dim> &conditions;
  const Scene &scene;
  const PrescribedPressure<dim> &pressure;  ///< of drained soil
  double relaxation_time;                   ///< [s]
  double total_mass;                        ///< of the particles of all ranks [kg]
  long long particles;                      ///< of all ranks
  bool implicit_pressure = false;           ///< of the pores, in time
};

/// The motion for the scene's phase model (src/variants).
template <int dim>
std::unique_ptr<AnySoilMotion<dim>> make_soil_motion(const MotionParts<dim> &parts);

}  // namespace talus
