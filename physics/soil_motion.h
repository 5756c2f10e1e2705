#pragma once
/// The right-hand side of the material point method on simplices, docs/theory sections 2 to 4: stress and volume live
/// at stress points, gradients at cells, momentum at nodes. One class for plane strain and 3D and for every phase
/// model.
#include <algorithm>
#include <limits>
#include <memory>

#include "base/phases.h"
#include "physics/boundary/conditions.h"
#include "physics/kinematics.h"
#include "physics/laws/update_stress.h"
#include "physics/motion.h"
#include "physics/pores/pore_fluid.h"
#include "physics/prescribed_pressure.h"
#include "transfer/nonlocal_strain.h"
#include "transfer/transfer.h"

namespace talus {

/// What acts on the soil at a time: set by the time loop, read by the motion.
template <int dim>
struct Loading {
  Vec<dim> gravity{};     ///< once the ramp of the stage is over [m/s2]
  double ramp = 1;        ///< of the stage: gravity and with it pore pressure grow from 0 to 1
  double time = 0;        ///< time that functions of the scene see [s]
  double set_at = 0;      ///< time of the run at which ramp and time are these [s]; a step looks ahead from there:
  double ramp_rate = 0;   ///< [1/s]
  double time_rate = 1;   ///< 0 in a stage that holds loads
  double damping = 0;     ///< local damping factor
  bool pore_flow = true;  ///< pore fluids move; otherwise their pressures are given
  bool softening = true;  ///< plastic strain is remembered; otherwise soil keeps the strength it has

  double ramp_at(double t) const { return std::min(1., ramp + ramp_rate * (t - set_at)); }
  double time_at(double t) const { return time + time_rate * (t - set_at); }
};

/// Sums over all ranks, for the ledger and the stop criteria.
struct Balance {
  double unbalanced = 0, applied = 0;  ///< sums of nodal force magnitudes [N]
  double kinetic = 0, strain = 0;      ///< [J]
};

/// What has been done to the soil since the start, docs/theory (6.6); of this rank, beside the work of boundaries
/// (Conditions::work) [J].
struct WorkDone {
  double gravity = 0;
  double imposed = 0;  ///< by body accelerations and given pore pressure
  double damping = 0;  ///< by local damping: negative
};

template <int dim, class Phases>
class SoilMotion final : public Motion {
 public:
  SoilMotion(const BackgroundMesh<dim> &mesh, std::vector<std::unique_ptr<Body<dim>>> &bodies,
             Conditions<dim> &conditions, const Scene &scene, double relaxation_time, double total_mass,
             long long particles, double gravity);

  PetscErrorCode begin(double t) override;
  PetscErrorCode acceleration(double t, const double *u, const double *v, double *a) override;
  PetscErrorCode drag(double t, double gamma, double *v) override;
  PetscErrorCode resist(double t, double gamma, double *v) override;
  PetscErrorCode hold(double t, double gamma, double *v) override;
  PetscErrorCode map_back(double t, double gamma, double *v, double *w) override;
  PetscErrorCode accept(double t, const double *u, const double *v) override;
  PetscErrorCode rates(double t, const double *u, const double *v, double *du, double *dv) override;
  double seen_square(const double *x) const override;
  bool inverted() const override { return inverted_; }
  int capacity() const override { return static_cast<int>(velocity_.size()) * dim; }
  double mass() const override { return total_mass_; }
  MPI_Comm comm() const override { return mesh_.comm(); }
  int size() const override { return grid_.node_count() * dim * velocity_fields<Phases>; }
  double *velocity() override { return velocity_.empty() ? nullptr : velocity_[0].data(); }

  /// Pore pressures of the state that a step has left, where no remap comes first. Collective.
  PetscErrorCode settle();
  /// Hands particles what the nodes learned and frees the grid; the particles in `movers[body]` have left their cells.
  PetscErrorCode release(double t, std::vector<std::vector<int>> &movers);
  /// The same when `begin` follows as soon as the movers have found their new cells: particles that stay are gathered
  /// in the same sweep, `begin` adds what `movers` lists by then. In between particles have their places, but no stress
  /// and no fluids.
  PetscErrorCode release_to_next(double t, std::vector<std::vector<int>> &movers);

  /// The state between two steps, also in the middle of a Lagrangian part, so that it does not matter to a run where it
  /// was kept. After the bodies; collective.
  PetscErrorCode serialize(Archive &archive);

  Loading<dim> loading;
  /// Largest displacement of a node of this rank since the last remap, over its mean edge.
  double moved() const { return moved_; }
  /// Smallest cell volume of this rank over its volume in the mesh.
  double smallest_volume_ratio() const { return smallest_ratio_; }
  /// How much the critical step has shrunk with the cells of this rank since the last remap (at most 1).
  double step_ratio() const { return step_ratio_; }
  /// Largest nodal speed squared of this rank; NaN when a node has no finite velocity.
  double speed_squared() const { return speed_squared_; }
  bool gathered() const { return gathered_; }
  const FilledGrid<dim> &grid() const { return grid_; }
  const std::vector<PointSet> &points() const { return points_; }
  /// Place of a node without a finite velocity on this rank; false when there is none.
  bool find_broken(Vec<dim> *where) const;
  /// Place and cause of the first call in which a law of this rank went wrong; false when there is none.
  bool find_trouble(Vec<dim> *where, std::string *cause) const;

  /// Position and velocity of a particle within the Lagrangian part.
  void present(const Body<dim> &body, int particle, Vec<dim> *position, Vec<dim> *velocity) const;
  /// Stress [stress_size], history and volume of a particle within the Lagrangian part.
  void state(int body, int particle, double *stress, double *history, double *volume) const;
  /// Given pore pressure at a place [Pa].
  double pore_pressure(const Vec<dim> &x) const requires Phases::prescribed {
    return loading.ramp * pressure_(x, loading.time);
  }
  /// Pore pressures, suction and saturation of a particle within the Lagrangian part.
  PoreReport pores(const Body<dim> &body, int particle) const requires Phases::liquid;
  /// Masses of liquid and gas of all ranks; collective.
  PetscErrorCode fluid_ledger(FluidLedger *sums) requires Phases::liquid { return fluid_.ledger(gathered_, sums); }
  /// Of explicit drag, on this rank [1/s].
  double drag_rate() const requires Phases::liquid { return fluid_.drag_rate(grid_); }
  const PoreFluid<dim, Phases> &fluid() const requires Phases::liquid { return fluid_; }
  PetscErrorCode setup_pores(bool fill) requires Phases::liquid;
  const WorkDone &work() const { return work_; }
  /// Keeps what supports bear that stand in for dashpots. Collective.
  PetscErrorCode freeze_reactions(double t);
  /// Fills the pores of the particles, which must have been released, to the pressures of `liquid`(cell, place) [Pa].
  void fill_pores(const std::function<double(int, const Vec<dim> &)> &liquid) requires Phases::liquid {
    fluid_.fill(liquid);
  }
  /// Sums of the present state; collective.
  PetscErrorCode balance(double t, Balance *sums);
  /// Largest frequency of elastic motion of the filled mesh [1/s] by power iteration, which comes from below,
  /// docs/theory (5.7). Goes on from the mode that it found last. After `begin`; collective.
  PetscErrorCode largest_frequency(int iterations, double *omega) requires(!Phases::liquid);

 private:
  static constexpr int components = stress_size<dim>, fluids = velocity_fields<Phases> - 1;

  template <bool averaged, bool apic>
  void gather();
  double relaxed(double t) const;
  PetscErrorCode end(double t, double *flip);
  void forget();
  void attach(size_t body);
  PetscErrorCode finish_gather(double t);
  PetscErrorCode gather_pore_water() requires Phases::prescribed;
  PetscErrorCode total_force(double load_time, double ramp, bool trial);
  void measure_impedance();
  void set_weights(const std::vector<double> &nodal_volume);
  PetscErrorCode deform(double t, const Vec<dim> *u, bool trial);
  PetscErrorCode smooth_volume_strain(const Shape<dim> *shape);
  const double *seen_history(size_t body) {
    return nonlocal_[body] ? nonlocal_[body]->averaged(points_[body]) : points_[body].history;
  }
  const double *softening_size(size_t body) const {
    return nonlocal_[body] ? nonlocal_[body]->size() : grid_.size.data();
  }
  PetscErrorCode internal_force(bool trial);
  void add_body_forces(double t);
  void add_up_work(const Vec<dim> *u);
  PetscErrorCode add_pore_pressure(double load_time, double ramp, bool trial) requires Phases::prescribed;
  void sample_pressure(double t) requires Phases::prescribed;
  std::array<double, 2> sample_shares(double t, double ramp) const;
  const double *find_suction(size_t body);
  /// Does velocity relax between remaps? Otherwise only remaps relax it.
  bool relaxes() const { return transfer_.remap_interval > 0 && relaxation_time_ > 0; }
  typename Conditions<dim>::Pores contact(double gamma);
  PetscErrorCode back_and_forth(const Vec<dim> *in, Vec<dim> *out);
  double elastic_force(const Vec<dim> *x, Vec<dim> *force) const;
  void constrain(double t, Vec<dim> *v);
  typename PoreFluid<dim, Phases>::Frame pore_frame(bool trial) requires Phases::liquid;

  const BackgroundMesh<dim> &mesh_;
  std::vector<std::unique_ptr<Body<dim>>> &bodies_;
  Conditions<dim> &conditions_;
  const Transfer &transfer_;
  PrescribedPressure<dim> pressure_;
  double relaxation_time_, total_mass_, smallest_mass_;
  FilledGrid<dim> grid_, next_grid_;
  std::vector<PointSet> points_, next_points_;
  std::vector<std::unique_ptr<NonlocalStrain<dim>>>
      nonlocal_;  ///< per body; null: the law softens by the strain of its point
  const std::vector<std::vector<int>> *movers_ = nullptr;  ///< when all but these are gathered

  // nodes
  std::vector<Vec<dim>> start_velocity_, velocity_, force_, scratch_, trial_position_;
  std::vector<Vec<dim>>
      mapped_start_;           ///< start velocity less its own mapping to particles and back, where it relaxes [m/s]
  std::vector<double> nodal_;  ///< room for sums over ranks
  std::vector<double> extra_mass_;  ///< pore water gained since seeding, weighs but is not inert [kg]
  NodalUpdate update_;
  std::vector<Vec<dim>> imposed_;    ///< force of body accelerations and pore pressure, of this rank [N]
  std::vector<Vec<dim>> held_back_;  ///< force of local damping in the last evaluation [N]
  WorkDone work_;
  bool imposes_ = Phases::prescribed;
  // cells
  std::vector<double> particle_volume_, weight_, blend_, volume_strain_;
  std::vector<double> filling_;      ///< integration volume over cell volume at the remap
  std::vector<double> slenderness_;  ///< sum of squared shape-function gradients at the remap [1/m2]
  std::vector<Increment<dim>> increment_;
  std::vector<std::array<double, components>> cell_stress_;
  std::vector<std::array<double, 2>> impedance_;
  std::vector<double> patch_weight_, patch_sum_;
  std::vector<double> affine_;
  std::vector<double> change_;     ///< what the points of one body pass on to its particles
  std::vector<double> forgotten_;  ///< history that a stage without softening does not keep
  // the trial state of integrators that look ahead
  std::vector<Shape<dim>> trial_shape_;
  std::vector<double> trial_particle_volume_, trial_weight_;
  std::vector<std::vector<double>> trial_stress_, trial_history_, trial_volume_;
  // given pore pressure, sampled now and then and linear in between
  struct Sample {
    std::vector<Vec<dim>> gradient;
    std::vector<double> value, nodal, suction;
  };
  [[no_unique_address]] If<Phases::prescribed, std::array<Sample, 2>> sample_;
  double sample_time_[2] = {0, 0}, last_pressure_time_ = 0;
  bool water_moved_ = false;      ///< since pore water was counted
  bool suction_matters_ = false;  ///< a law reads it: pressure below zero is suction, not stress
  std::vector<double> suction_;   ///< at the stress points of one body [Pa]
  // the fastest mode, where a scene asks for it
  std::vector<Vec<dim>> mode_;  ///< of mesh nodes
  std::vector<Vec<dim>> wave_, wave_force_;
  std::vector<std::array<double, 2>> elasticity_;  ///< Lame's constant and shear modulus of cells [Pa]
  // fluids that move
  [[no_unique_address]] If<Phases::liquid, PoreFluid<dim, Phases>> fluid_;
  [[no_unique_address]] If<Phases::liquid, PoreConditions<dim>> pore_conditions_;
  [[no_unique_address]] If<Phases::liquid, std::vector<Vec<dim>>>
      before_;  ///< velocities of all phases before the step [m/s]
  [[no_unique_address]] If<Phases::liquid, std::vector<const double *>> point_volume_;
  [[no_unique_address]] If<Phases::liquid, std::vector<double>> pore_strain_;  ///< volume strain of the pores in cells

  bool gathered_ = false, inverted_ = false;
  double remap_time_ = 0, accepted_time_ = 0, own_share_ = 1, moved_ = 0, smallest_ratio_ = 1, step_ratio_ = 1,
         speed_squared_ = 0;
};

}  // namespace talus
