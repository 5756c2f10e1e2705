#pragma once
/// The right-hand side of the material point method on simplices, docs/theory sections 2 to 4: stress and volume live
/// at stress points, gradients at cells, momentum at nodes. One class for plane strain and 3D and for every phase
/// model. The folder soil_motion/ holds its parts: the two states of the soil, the velocities of the nodes, prescribed
/// pore water, the work done, the fastest mode.
#include <algorithm>
#include <limits>
#include <memory>

#include "base/phases.h"
#include "physics/any_soil_motion.h"
#include "physics/boundary/conditions.h"
#include "physics/kinematics.h"
#include "physics/laws/update_stress.h"
#include "physics/pores/pore_fluid.h"
#include "physics/soil_motion/cell_motion.h"
#include "physics/soil_motion/fastest_mode.h"
#include "physics/soil_motion/nodal_velocities.h"
#include "physics/soil_motion/prescribed_pore_water.h"
#include "physics/soil_motion/soil_state.h"
#include "physics/soil_motion/work_ledger.h"
#include "transfer/nonlocal_strain.h"
#include "transfer/transfer.h"

namespace talus {

template <int dim, class Phases>
class SoilMotion final : public AnySoilMotion<dim> {
 public:
  explicit SoilMotion(const MotionParts<dim> &parts);

  PetscErrorCode begin(double t) override;
  PetscErrorCode acceleration(double t, const double *u, const double *v, double *a) override;
  PetscErrorCode rates(double t, const double *u, const double *v, double *du, double *dv) override;
  PetscErrorCode apply_boundaries_and_drag(double t, double gamma, double *v) override;
  PetscErrorCode apply_drag(double t, double gamma, double *v) override;
  PetscErrorCode apply_boundaries(double t, double gamma, double *v) override;
  PetscErrorCode map_back(double t, double gamma, double *v, double *w) override;
  PetscErrorCode accept(double t, const double *u, const double *v) override;
  bool inverted() const override { return inverted_; }
  int size() const override { return grid_.node_count() * dim * fields; }
  int capacity() const override { return static_cast<int>(velocities_.now.size()) * dim; }
  double *velocity() override { return velocities_.now.empty() ? nullptr : velocities_.now[0].data(); }
  double seen_square(const double *x) const override {
    return talus::seen_square<dim, fields>(grid_, reinterpret_cast<const Vec<dim> *>(x));
  }
  double mass() const override { return total_mass_; }
  MPI_Comm comm() const override { return mesh_.comm(); }

  using AnySoilMotion<dim>::loading;
  PetscErrorCode update_pore_pressures(double t) override;
  PetscErrorCode update_particles(double t, std::vector<std::vector<int>> &movers) override;
  PetscErrorCode update_particles_and_gather(double t, std::vector<std::vector<int>> &movers) override;
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
  PetscErrorCode begin_results(double t) override;
  Vec<dim> moving_velocity(const Body<dim> &body, int particle) const override;
  void state(int body, int particle, double *stress, double *history, double *volume) const override;
  SofteningInput softened_by(int body, int particle) const override;
  const WorkDone &work() const override { return work_.done(); }
  PetscErrorCode freeze_reactions(double t) override;
  PetscErrorCode balance(double t, Balance *sums) override;
  double pore_pressure([[maybe_unused]] int cell, [[maybe_unused]] const Vec<dim> &x) const override {
    if constexpr (Phases::prescribed)
      return loading.ramp * water_.pressure()(x, loading.time, water_.pressure().soil_of(cell));
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
  PetscErrorCode largest_frequency(int iterations, double *omega) override {
    return fastest_mode_.find(grid_, accepted_, bodies_, points_, iterations, omega);
  }

 private:
  static constexpr int components = stress_size<dim>, fields = velocity_fields<Phases>, fluids = fields - 1;
  using Velocities = NodalVelocities<dim, fields>;
  using State = SoilState<dim>;

  static std::vector<PoreStiffness> pores_of_bodies(const MotionParts<dim> &parts);
  Archive::Rows serialize_points(Archive &archive, size_t body);
  PoreReport pore_report(const Body<dim> &body, int particle) const requires Phases::liquid;
  PetscErrorCode start_pores(bool fill) requires Phases::liquid;
  // particles to nodes and back
  template <bool averaged>
  void gather();
  PetscErrorCode finish_gather(double t);
  void average_shares(size_t body);
  void refer_to_points(size_t body);
  void measure_impedance();
  void set_weights(const std::vector<double> &nodal_volume);
  void admit_mean_stress();
  double prepare_update(double t);
  Lagrangian<dim> end_of_part(size_t body, double share, const Pores<dim> &pores) {
    return {.grid = grid_,
            .nodes = update_,
            .flip = share,
            .points = points_[body],
            .pores = pores,
            .change = change_.data()};
  }
  void clear_grid();
  // deformation
  PetscErrorCode deform(double t, const Vec<dim> *u, State &to);
  void move_nodes(const Vec<dim> *u, State &to);
  PetscErrorCode smooth_volume_strain(const Shape<dim> *shape);
  void update_points(double t, size_t body, State &to);
  const double *history_seen_by_law(size_t body) {
    return nonlocal_[body] ? nonlocal_[body]->averaged(points_[body]) : points_[body].history;
  }
  const double *softening_size(size_t body) const {
    return nonlocal_[body] ? nonlocal_[body]->size() : grid_.size.data();
  }
  const double *find_suction(size_t body);
  bool is_trial(const State &state) const { return &state != &accepted_; }
  /// How a cell has moved since the last remap; not at all before `begin`.
  CellMotion<dim> cell_motion(int mesh_cell) const;
  PetscErrorCode find_moving(double t);
  PetscErrorCode meet_boundaries(double load_time);
  // forces
  void internal_force(const State &state);
  void add_body_forces(double load_time);
  PetscErrorCode total_force(double t, const State &state);
  const double *extra_mass() const {
    if constexpr (Phases::prescribed) return water_.extra_mass().data();
    return nullptr;
  }
  // velocities
  typename Conditions<dim>::Pores contact(double t, double gamma);
  void constrain(double t, Vec<dim> *v);
  PetscErrorCode to_particles_and_back(const Vec<dim> *in, Vec<dim> *out);
  typename PoreFluid<dim, Phases>::Frame pore_frame(double t, const State &state) requires Phases::liquid;

  const BackgroundMesh<dim> &mesh_;
  std::vector<std::unique_ptr<Body<dim>>> &bodies_;
  Conditions<dim> &conditions_;
  const Transfer &transfer_;
  double total_mass_, smallest_mass_;
  FilledGrid<dim> grid_, next_grid_;
  std::vector<PointSet> points_, next_points_;
  std::vector<std::unique_ptr<NonlocalStrain<dim>>>
      nonlocal_;  ///< per body; null: the law softens by the strain of its point
  AcceptedState<dim> accepted_;
  TrialState<dim> trial_;
  Velocities velocities_;
  [[no_unique_address]] If<Phases::prescribed, PrescribedPoreWater<dim>> water_;
  WorkLedger<dim> work_;
  FastestMode<dim, fields> fastest_mode_;

  // nodes
  std::vector<Vec<dim>> force_;    ///< [N]
  std::vector<Vec<dim>> scratch_;  ///< [field][node], for velocities or forces
  std::vector<double> nodal_;      ///< scratch for sums over ranks
  // cells
  std::vector<double> blend_;          ///< b of docs/theory (4.4)
  std::vector<double> filling_;        ///< integration volume over cell volume at the remap
  std::vector<double> slenderness_;    ///< sum of squared shape-function gradients at the remap [1/m2]
  std::vector<double> volume_strain_;  ///< of the step under way
  std::vector<Increment<dim>> increment_;
  std::vector<std::array<double, components>> cell_stress_;  ///< [Pa]
  std::vector<std::array<double, 2>> impedance_;             ///< rho c_p, rho c_s [kg/(m2 s)]
  std::vector<double> patch_weight_, patch_sum_;
  std::vector<double> forgotten_;  ///< history of the points of one body that a stage without softening discards
  // remap
  const std::vector<std::vector<int>> *movers_ = nullptr;  ///< set while all particles but these are gathered
  NodalUpdate update_;
  std::vector<double> change_;  ///< Lagrangian::change
  // fluids that move
  [[no_unique_address]] If<Phases::liquid, PoreFluid<dim, Phases>> fluid_;
  [[no_unique_address]] If<Phases::liquid, PoreConditions<dim>> pore_conditions_;
  [[no_unique_address]] If<Phases::liquid, std::vector<double>> pore_strain_;  ///< volume strain of the pores in cells

  bool gathered_ = false, inverted_ = false;
  double accepted_time_ = 0, moved_ = 0, smallest_ratio_ = 1, step_ratio_ = 1, speed_squared_ = 0;
};

}  // namespace talus
