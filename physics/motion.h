#pragma once
/// Motion of the nodes between two remaps: the plug every integrator takes. No integrator contains physics, and no
/// physics knows an integrator's name. Virtual calls are per stage of a step, never per particle.
#include <mpi.h>
#include <petscsys.h>

#include <algorithm>

namespace talus {

/// The state is nodal: `u` displacement since the last accepted state [m], `v` velocity [m/s], `size()` doubles each,
/// node-major, all phases. Stress is a pure function of the accepted history and `u`: call `acceleration` as often as
/// you like; only `accept` changes history.
class Motion {
 public:
  virtual ~Motion() = default;
  /// Gathers mass and momentum and freezes cells, if particles have moved since; `velocity()` is then the start of a
  /// step.
  virtual PetscErrorCode begin(double t) = 0;
  /// Accelerations [m/s2] from the divergence of stress, gravity, loads and local damping. `u` = null stands for the
  /// accepted state.
  virtual PetscErrorCode acceleration(double t, const double *u, const double *v, double *a) = 0;
  /// Node-local implicit part over a step `gamma` [s]: drag between phases, prescribed motion, contact with friction,
  /// dashpots.
  virtual PetscErrorCode drag(double t, double gamma, double *v) = 0;
  /// Its two parts, for integrators that take drag as an implicit partition: drag between phases alone, v = v0 + gamma
  /// D v solved in place, which changes nothing else; and what boundaries do once a step is over.
  virtual PetscErrorCode resist(double, double, double *) { return 0; }
  virtual PetscErrorCode hold(double t, double gamma, double *v) { return drag(t, gamma, v); }
  /// What the nodes would receive if the particles took `v` and were mapped back (MUSL), docs/theory (4.9); `v` itself
  /// relaxes towards it.
  virtual PetscErrorCode map_back(double t, double gamma, double *v, double *w) = 0;
  /// Both rates of the state, for integrators that look ahead: `du` is the velocity of places, w of docs/theory (4.9),
  /// `dv` the acceleration less the relaxation (4.10). `u` = null as above; changes nothing.
  virtual PetscErrorCode rates(double t, const double *u, const double *v, double *du, double *dv) = 0;
  /// `rates` in two parts, for integrators with two clocks: what is slow and dear, such as the skeleton's stress, and
  /// what is fast. Nothing is slow unless a motion says so.
  virtual PetscErrorCode slow_rates(double, const double *, const double *, double *du, double *dv) {
    std::fill_n(du, size(), 0.), std::fill_n(dv, size(), 0.);
    return 0;
  }
  virtual PetscErrorCode fast_rates(double t, const double *u, const double *v, double *du, double *dv) {
    return rates(t, u, v, du, dv);
  }
  /// Did the last trial state turn a cell of this rank inside out?
  virtual bool inverted() const = 0;
  /// Commits stress, history and volumes for displacement `u`, moves the nodes, keeps `v`.
  virtual PetscErrorCode accept(double t, const double *u, const double *v) = 0;

  virtual int size() const = 0;
  virtual int capacity() const = 0;  ///< that `size()` never exceeds
  virtual double *velocity() = 0;
  /// Sum of m_p |x_p|^2 over the particles of this rank, x_p being what they see of the nodal field `x`: the weight of
  /// errors.
  virtual double seen_square(const double *x) const = 0;
  virtual double mass() const = 0;  ///< of all particles of all ranks [kg]
  virtual MPI_Comm comm() const = 0;
};

}  // namespace talus
