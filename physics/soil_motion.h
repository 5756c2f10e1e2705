#pragma once
/// The right-hand side of the material point method on simplices, docs/theory sections 2 to 4: stress and volume live
/// at stress points, gradients at cells, momentum at nodes. One class for plane strain and 3D and for every phase
/// model.
#include <algorithm>
#include <limits>
#include <memory>

#include "base/phases.h"
#include "physics/any_soil_motion.h"
#include "physics/boundary/conditions.h"
#include "physics/kinematics.h"
#include "physics/laws/update_stress.h"
#include "physics/pores/pore_fluid.h"
#include "physics/prescribed_pressure.h"
#include "transfer/nonlocal_strain.h"
#include "transfer/transfer.h"

namespace talus {

template <int dim, class Phases>
class SoilMotion final : public AnySoilMotion<dim> {
 public:
  explicit SoilMotion(const MotionParts<dim> &parts);

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

  using AnySoilMotion<dim>::loading;
  PetscErrorCode settle() override;
  PetscErrorCode release(double t, std::vector<std::vector<int>> &movers) override;
  PetscErrorCode release_to_next(double t, std::vector<std::vector<int>> &movers) override;
  PetscErrorCode serialize(Archive &archive) override;
  double moved() const override { return moved_; }
  double smallest_volume_ratio() const override { return smallest_ratio_; }
  double step_ratio() const override { return step_ratio_; }
  double speed_squared() const override { return speed_squared_; }
  bool gathered() const override { return gathered_; }
  const FilledGrid<dim> &grid() const override { return grid_; }
  const std::vector<PointSet> &points() const override { return points_; }
  bool find_broken(Vec<dim> *where) const override;
  bool find_trouble(Vec<dim> *where, std::string *cause) const override;
  void present(const Body<dim> &body, int particle, Vec<dim> *position, Vec<dim> *velocity) const override;
  void state(int body, int particle, double *stress, double *history, double *volume) const override;
  const WorkDone &work() const override { return work_; }
  PetscErrorCode freeze_reactions(double t) override;
  PetscErrorCode balance(double t, Balance *sums) override;
  double pore_pressure([[maybe_unused]] const Vec<dim> &x) const override {
    if constexpr (Phases::prescribed) return loading.ramp * pressure_(x, loading.time);
    return 0;
  }
  PoreReport pores([[maybe_unused]] const Body<dim> &body, [[maybe_unused]] int particle) const override {
    if constexpr (Phases::liquid) return pore_report(body, particle);
    return {};
  }
  PetscErrorCode fluid_ledger([[maybe_unused]] FluidLedger *sums) override {
    if constexpr (Phases::liquid) return fluid_.ledger(gathered_, sums);
    return 0;
  }
  double drag_rate() const override {
    if constexpr (Phases::liquid) return fluid_.drag_rate(grid_);
    return 0;
  }
  double initial_pressure([[maybe_unused]] const Vec<dim> &x, [[maybe_unused]] double t) const override {
    if constexpr (Phases::liquid) return fluid_.prescribed_pressure(x, t);
    return 0;
  }
  PetscErrorCode setup_pores([[maybe_unused]] bool fill) override {
    if constexpr (Phases::liquid) return start_pores(fill);
    return 0;
  }
  void fill_pores([[maybe_unused]] const std::function<double(int, const Vec<dim> &)> &liquid) override {
    if constexpr (Phases::liquid) fluid_.fill(liquid);
  }
  PetscErrorCode largest_frequency([[maybe_unused]] int iterations, [[maybe_unused]] double *omega) override {
    if constexpr (!Phases::liquid) return iterate_to_largest_frequency(iterations, omega);
    return 0;
  }

 private:
  static constexpr int components = stress_size<dim>, fluids = velocity_fields<Phases> - 1;

  PoreReport pore_report(const Body<dim> &body, int particle) const requires Phases::liquid;
  PetscErrorCode start_pores(bool fill) requires Phases::liquid;
  PetscErrorCode iterate_to_largest_frequency(int iterations, double *omega) requires(!Phases::liquid);
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
  const PrescribedPressure<dim> &pressure_;
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
