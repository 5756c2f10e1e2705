#pragma once
/// Equilibrium, seepage and consolidation by finite elements on the world's mesh, laws and boundaries, and what they
/// hand to the particles and take from them, docs/theory/finite_elements.md and seepage.md.
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "output/results.h"
#include "physics/cell_pressure.h"
#include "simulation/output_fields.h"
#include "simulation/world.h"
#include "solvers/quasi_static/strength_reduction.h"

namespace talus {

template <int dim>
class Statics {
 public:
  /// The references must outlive it. Nothing is built before the first quasi-static stage, but what the scene says
  /// about seepage is read: throws SceneError where it cannot be used.
  Statics(World<dim> &world, const Clock &clock);
  Statics(const Statics &) = delete;

  /// Builds the problem with the bodies that are there now, without solving anything; for results at the start.
  void prepare();
  /// Brings state, bodies, laws and supports to those of a stage. `soil_moves`: supports have to hold the soil. Throws
  /// RunFailure. Collective.
  void begin_stage(const Stage &stage, bool soil_moves);
  /// The motion has the soil from now on: results are those of the particles.
  void leave() { current_ = false, moved_since_ = true; }
  /// Nodes of the flow remember by how much they differ from the particles that have their pressure from them, before
  /// these move; `forget_nodes` if the pressure of particles comes from elsewhere. Collective.
  void remember_nodes();
  void forget_nodes();
  /// Displacement counts from here, whoever has the soil. Collective.
  void reset_displacement();

  /// Particles stay where they are and take stress, history and pore water; the displacement moves the place it is
  /// counted from. Stress is linear between the Gauss points of a cell.
  void to_particles();
  /// From now on the pressure of a drained scene is what the flow has found.
  void take_seeped_pressure();
  /// Replaces pore_pressure.csv by what the last seepage has found, or removes it if there was none. Collective.
  void save_seeped_pressure(const std::string &directory) const;
  /// What the state of a run has from it, after that of the world: Gauss points and nodes, and the pressure that the
  /// last seepage left in the cells of this rank. Collective.
  void serialize(Archive &archive);

  /// Lets soil whose [body.NAME.shansep] names the stage take its undrained strength from the present stress. What it
  /// has then, in words; empty if there is none. Collective.
  std::string take_consolidated_strength(const std::string &stage);  // shansep.cpp

  /// Sum over the Gauss points of the plastic strain that takes strength from soil. Collective.
  double softening_strain() const;

  bool made() const { return problem_ != nullptr; }
  bool current() const { return current_; }  ///< the last state is one of finite elements
  QuasiStatic<dim> &problem() { return *problem_; }
  PoreFlow<dim> &flow() { return *flow_; }
  /// Columns of the Gauss points, in place of particles.
  Snapshot gauss_points() const;
  /// Calls visit(place, displacement, mass, shear strain) for each of them, the last two since displacement was reset.
  void each_gauss_point(const std::function<void(const Vec<dim> &, const Vec<dim> &, double, double)> &visit) const;
  /// The state at a place in the soil, or at the nearest place of the soil if it is outside: displacement by the shape
  /// functions, stress and history between the Gauss points of the cell; at rest. Beyond the Gauss points stress goes
  /// on linearly where the soil bears it, else it is that of the nearest place between them. None where another rank
  /// has it. Collective.
  std::optional<ParticleState<dim>> state_at(const Vec<dim> &x) const;
  /// Work of the stages by finite elements so far, and the strain energy of the soil while `current` [J]; the same on
  /// all ranks. Strain energy that a stage begins with or that leaves with a body is imposed. The second is collective.
  PathWork work() const { return made() ? problem_->work() : PathWork{}; }
  double imposed_work() const { return work().imposed() + imposed_; }
  double strain_energy() const;
  /// Volume per time that enters through each boundary of the motion [m3/s]; while motion has the soil not
  /// known, and none where water moves in these stages alone.
  /// Collective.
  std::vector<double> inflow() const;

  /// The law of a body in a stage, whose water may drain there.
  Law law_in(const Stage &stage, size_t body) const;

  /// Elements of first order make factors too large: a scene that looks for one has always those of second order.
  Elements elements() const;
  std::vector<std::string> lost_stages;  ///< names of stages that lost equilibrium, in a run that leads to a factor
  bool dilated = false;                  ///< a stage found its equilibrium with psi = phi, see `settle`
  /// What motion had done to the soil when the stage under way began.
  struct Moved {
    double way = 0, speed = 0;  ///< of the particle that has moved farthest, and of the fastest [m], [m/s]
    double emptied = 0;         ///< share of the cells of the soil, by volume, in which no particle is any more
  };
  const std::optional<Moved> &moved() const { return moved_; }  ///< none if it does not follow motion

 private:
  void make();
  PetscErrorCode activate();
  void choose_laws(const Stage &stage);
  static void let_water_go(GaussPoints<dim> &points);
  void check_supports(bool soil_moves) const;
  void check_structures() const;
  void start_stress();  // initial_stress.cpp
  void to_gauss_points();
  void check_places() const;
  /// Means over the particles around the vertices of elements, weighted by volume and shape function: `value`(body,
  /// particle) has `count` components; [node][count], not a number where there are no particles. Collective.
  template <int count, class Value>
  std::vector<double> mean_of_particles(const ElementNodes<dim> &nodes, Value &&value) const;
  struct AroundNodes;
  AroundNodes around_nodes();
  Vec<dim> moved_since(const ParticleArrays<dim> &p, int i) const;
  void displacement_from_particles();
  void spread(std::vector<double> &way) const;
  void find_what_moved();
  void pressure_from_particles();
  void use_seeped_pressure();
  int cell_at(const Vec<dim> &x) const;
  std::array<double, dim + 1> weights_of_points(const Barycentric<dim> &l, bool between) const;
  StrengthShares shares_at(int cell, const Barycentric<dim> &l) const;
  void shares_to_particles(size_t body);
  void interpolate(int cell, const Barycentric<dim> &l, bool between, double *stress, double *history) const;
  bool bears(int cell, const ParticleState<dim> &state) const;
  SofteningInput softened_by(int cell, int body, const double *history) const;

  World<dim> &world_;
  const Clock &clock_;
  std::unique_ptr<PoreFlow<dim>> flow_;  ///< where pore fluids move
  std::unique_ptr<QuasiStatic<dim>> problem_;
  std::vector<double> seeped_cells_;  ///< of this rank, as CellPressure takes them
  std::shared_ptr<const CellPressure<dim>> seeped_;
  bool current_ = false, moved_since_ = false;
  std::optional<Moved> moved_;
  double imposed_ = 0;  ///< strain energy that stages began with, less what left with bodies [J]
};

}  // namespace talus
