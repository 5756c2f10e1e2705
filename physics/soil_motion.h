#pragma once
/// The right-hand side of the material point method on simplices, docs/theory sections 2 to 4: stress and volume live
/// at stress points, gradients at cells, momentum at nodes. One class for plane strain and 3D and for every phase
/// model. The folder soil_motion/ holds its parts: the two states of the soil, how it fills its cells, their increments
/// and stress, the velocities of the nodes, what a remap carries on, what softening reads, prescribed pore water, the
/// work done, the fastest mode, the measures of a step.
#include <algorithm>
#include <memory>

#include "base/phases.h"
#include "physics/any_soil_motion.h"
#include "physics/boundary/conditions.h"
#include "physics/boundary/soil_contact.h"
#include "physics/laws/update_stress.h"
#include "physics/pores/pore_fluid.h"
#include "physics/soil_motion/cell_filling.h"
#include "physics/soil_motion/cell_increments.h"
#include "physics/soil_motion/cell_motion.h"
#include "physics/soil_motion/cell_stress.h"
#include "physics/soil_motion/fastest_mode.h"
#include "physics/soil_motion/nodal_velocities.h"
#include "physics/soil_motion/prescribed_pore_water.h"
#include "physics/soil_motion/rayleigh_damping.h"
#include "physics/soil_motion/remap.h"
#include "physics/soil_motion/softening_strain.h"
#include "physics/soil_motion/soil_state.h"
#include "physics/soil_motion/step_measures.h"
#include "physics/soil_motion/work_ledger.h"
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
  bool inverted() const override { return measures_.inverted; }
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
  const StepMeasures &measures() const override { return measures_; }
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
  PressureSolves pressure_solves() const override {
    if constexpr (Phases::liquid) return implicit_.done;
    return {};
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
  static constexpr int nodal_sums = dim + 2;  ///< mass, momentum, volume
  using Velocities = NodalVelocities<dim, fields>;
  using State = SoilState<dim>;

  static std::vector<PoreStiffness> pores_of_bodies(const MotionParts<dim> &parts);
  Archive::Rows serialize_points(Archive &archive, size_t body);
  PoreReport pore_report(const Body<dim> &body, int particle) const requires Phases::liquid;
  PetscErrorCode start_pores(bool fill) requires Phases::liquid;
  Pores<dim> pores_of([[maybe_unused]] size_t body) {
    if constexpr (Phases::liquid) return fluid_.pores(static_cast<int>(body));
    return {};
  }
  Pores<dim> next_pores_of([[maybe_unused]] size_t body) {
    if constexpr (Phases::liquid) return fluid_.next_pores(static_cast<int>(body));
    return {};
  }
  // particles to nodes and back
  PetscErrorCode sum_particles();
  PetscErrorCode start_part(double t);
  void refer_to_points(size_t body);
  void admit_mean_stress();
  PetscErrorCode end_part(double t);
  void clear_grid();
  // deformation
  PetscErrorCode deform(double t, const Vec<dim> *u, State &to);
  StressPoints<dim> stress_points(size_t body, double *stress_out, double *history_out);
  void keep_history(size_t body);
  void update_volumes(size_t body, const double *history, State &to);
  const double *find_suction(size_t body);
  bool is_trial(const State &state) const { return &state != &accepted_; }
  /// How a cell has moved since the last remap; not at all before `begin`.
  CellMotion<dim> cell_motion(int mesh_cell) const;
  PetscErrorCode find_moving(double t, const Vec<dim> *v, double own, bool mapped);
  PetscErrorCode meet_boundaries(double load_time);
  // forces
  void add_body_forces(double load_time);
  PetscErrorCode total_force(double t, const State &state, bool damped = false);
  PetscErrorCode add_viscous_forces(const State &state);
  PetscErrorCode accelerate(double t, const double *u, const double *v, double *a);
  bool damped() const { return rayleigh_.acts(loading.damping_frequencies); }
  const double *extra_mass() const {
    if constexpr (Phases::prescribed) return water_.extra_mass().data();
    return nullptr;
  }
  // velocities
  typename Conditions<dim>::Pores contact(double t, double gamma);
  void constrain(double t, Vec<dim> *v);
  PetscErrorCode map_change(double gamma, const Vec<dim> *velocity, Vec<dim> *mapped) requires Phases::liquid;
  PetscErrorCode find_strain_of_step(double t, const StepStart<dim> &at,
                                     const Vec<dim> *velocity) requires Phases::liquid;
  PetscErrorCode add_implicit_pressure(double t, double gamma, Vec<dim> *velocity) requires Phases::liquid;
  PetscErrorCode to_particles_and_back(const Vec<dim> *in, Vec<dim> *out);
  typename PoreFluid<dim, Phases>::Frame pore_frame(double t, const State &state) requires Phases::liquid;

  const BackgroundMesh<dim> &mesh_;
  std::vector<std::unique_ptr<Body<dim>>> &bodies_;
  Conditions<dim> &conditions_;
  const Transfer &transfer_;
  double total_mass_, smallest_mass_;
  FilledGrid<dim> grid_;
  std::vector<PointSet> points_;
  Remap<dim, fluids> remap_;
  SofteningStrain<dim> softening_;
  CellFilling<dim> filling_;
  PatchMeans patches_;
  CellIncrements<dim> increments_;
  CellStress<dim> stress_;
  AcceptedState<dim> accepted_;
  TrialState<dim> trial_;
  Velocities velocities_;
  [[no_unique_address]] If<Phases::prescribed, PrescribedPoreWater<dim>> water_;
  WorkLedger<dim> work_;
  FastestMode<dim, fields> fastest_mode_;
  RayleighDamping<dim> rayleigh_;

  std::vector<Vec<dim>> force_;    ///< of the nodes [N]
  std::vector<Vec<dim>> scratch_;  ///< [field][node], for velocities or forces
  std::vector<double> nodal_;      ///< scratch for sums over ranks
  std::vector<double> forgotten_;  ///< history of the points of one body that a stage without softening discards
  // fluids that move
  [[no_unique_address]] If<Phases::liquid, PoreFluid<dim, Phases>> fluid_;
  [[no_unique_address]] If<Phases::liquid, ImplicitPressure<dim>> implicit_;
  [[no_unique_address]] If<Phases::liquid, PoreConditions<dim>> pore_conditions_;
  [[no_unique_address]] If<Phases::liquid, std::vector<double>> pore_strain_;  ///< volume strain of the pores in cells

  bool gathered_ = false;
  double accepted_time_ = 0;
  StepMeasures measures_;
};

}  // namespace talus
