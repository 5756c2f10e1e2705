#pragma once
/// Motion of the nodes between two remaps: the interface between integrators and physics. No integrator contains
/// physics, and no physics knows an integrator's name. Virtual calls are per stage of a step, never per particle.
#include <mpi.h>
#include <petscsys.h>

namespace talus {

/// The state is nodal: `u` displacement since the last accepted state [m], `v` velocity [m/s], of all phases, each
/// `size()` doubles, node-major. Stress is a pure function of the accepted history and `u`.
///
/// The time loop calls `begin`; then the integrator takes one step from t to t + h by these calls, in this order:
///
///   1. `acceleration` or `rates`, as often as it likes, at any time and state. They change neither the accepted state
///      nor a velocity; the motion remembers only the forces of the last call, whose work `accept` counts.
///      `apply_drag` may be called between them, for implicit stages.
///   2. `apply_boundaries_and_drag`, exactly once, at t + h and over the whole step h; or `apply_boundaries` in its
///      place where the stages have applied drag. It changes `v`, the impulses on the boundaries and the memory of
///      contacts with friction, which is why a second call would count twice.
///   3. `map_back`, once, at t + h, by integrators that take displacements from mapped velocities; those that use
///      `rates` have mapped in the stages and leave it out. It changes `v`, and with pore fluids the velocity from
///      which particles count their own.
///   4. `accept`, exactly once, at t + h.
///
/// Every boundary is asked for its velocity, flux or limit at the end of the step. Forces (gravity, loads, body
/// accelerations, pressures on faces) are asked at the time of the evaluation that they enter.
class Motion {
 public:
  virtual ~Motion() = default;
  /// Gathers mass and momentum from the particles and fixes their cells, if particles have moved since the last call;
  /// `velocity()` is then that at the start of a step.
  virtual PetscErrorCode begin(double t) = 0;
  /// Accelerations [m/s2] from the divergence of stress, gravity, loads and local damping. `u` = null stands for the
  /// accepted state.
  virtual PetscErrorCode acceleration(double t, const double *u, const double *v, double *a) = 0;
  /// Both rates of the state, for integrators with stages: `du` is the velocity of places, w of docs/theory (4.9), `dv`
  /// the acceleration less the relaxation (4.10). `u` = null as above.
  virtual PetscErrorCode rates(double t, const double *u, const double *v, double *du, double *dv) = 0;
  /// Implicit in a step `gamma` [s] that ends at t, node by node: supports, contact with friction, dashpots, and drag
  /// between phases.
  virtual PetscErrorCode apply_boundaries_and_drag(double t, double gamma, double *v) = 0;
  /// Drag between phases alone: v = v0 + gamma D v, solved in place.
  virtual PetscErrorCode apply_drag(double, double, double *) { return 0; }
  /// Boundaries alone.
  virtual PetscErrorCode apply_boundaries(double t, double gamma, double *v) {
    return apply_boundaries_and_drag(t, gamma, v);
  }
  /// `w` is what the nodes would receive if the particles took `v` and were mapped back (MUSL), docs/theory (4.9), at
  /// the end t of a step `gamma` [s]; `v` relaxes towards it (4.10).
  virtual PetscErrorCode map_back(double t, double gamma, double *v, double *w) = 0;
  /// Commits stress, history and volumes for displacement `u`, moves the nodes, keeps `v`.
  virtual PetscErrorCode accept(double t, const double *u, const double *v) = 0;
  /// Did the last trial state turn a cell of this rank inside out?
  virtual bool inverted() const = 0;

  virtual int size() const = 0;
  virtual int capacity() const = 0;  ///< that `size()` never exceeds
  virtual double *velocity() = 0;
  /// Sum of m_p |x_p|^2 over the particles of this rank, where x_p is the nodal field `x` at particle p: the weight of
  /// errors.
  virtual double seen_square(const double *x) const = 0;
  virtual double mass() const = 0;  ///< of all particles of all ranks [kg]
  virtual MPI_Comm comm() const = 0;
};

}  // namespace talus
