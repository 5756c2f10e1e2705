#pragma once
/// The action of the boundaries of a scene on the skeleton at the nodes, docs/theory section 6. Prescribed directions
/// are orthonormalised per node once. A contact has one constraint per patch of facets at a node. Loads and dashpots
/// act where facets have soil behind them.
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/archive.h"
#include "meshes/background_mesh.h"
#include "physics/boundary/boundary.h"
#include "physics/boundary/prescribed_motion.h"
#include "physics/boundary/rigid_bases.h"
#include "physics/boundary/sides.h"
#include "physics/boundary/surface_loads.h"
#include "transfer/filled_grid.h"

namespace talus {

template <int dim>
class RigidBodies;  // physics/boundary/rigid_bodies.h
template <int dim>
class SoilContact;  // physics/boundary/soil_contact.h
template <int dim>
class StructuresInMotion;  // physics/structures/structures_in_motion.h

template <int dim>
class Conditions {
 public:
  using Source = NamedBoundary;
  Conditions();
  Conditions &operator=(Conditions &&) noexcept;
  ~Conditions();
  /// Collects nodes and normals of all groups, also of facets that only a neighbouring rank has. Collective.
  PetscErrorCode setup(const BackgroundMesh<dim> &mesh, std::vector<Source> sources);
  /// Rigid bodies that the soil meets, after `setup`.
  void take_rigid_bodies(std::unique_ptr<RigidBodies<dim>> bodies);
  /// Groups of bodies that meet in contact, after `take_rigid_bodies`.
  void take_soil_contact(std::unique_ptr<SoilContact<dim>> contact);
  /// What is built into the soil, after `setup`.
  void take_structures(std::unique_ptr<StructuresInMotion<dim>> structures);
  bool structures() const { return structures_ != nullptr; }  ///< has the scene any?
  /// Adds this rank's part of the forces of structures on the nodes [N]; `stress` is the mean effective stress of a
  /// filled cell [Pa]. Collective.
  using StressOf = std::function<Eigen::Matrix3d(int cell)>;
  void add_structures(const FilledGrid<dim> &grid, const StressOf &stress, Vec<dim> *force);
  /// Picks the nodes and facets of the filled grid. `impedance` [filled cells] holds rho c_p and rho c_s. Collective.
  PetscErrorCode begin(FilledGrid<dim> &grid, const std::vector<std::array<double, 2>> &impedance,
                       const std::vector<double> &filling);

  /// In stages that freeze loads (`hold_loads`), supports stand in for dashpots and ties. Takes effect at the next
  /// `begin`.
  void use_stand_ins(bool use) { stand_ins_ = use; }
  bool uses_stand_ins() const { return stand_ins_; }
  /// Stores the reactions of those supports to the nodal forces (summed over ranks) as a dead load.
  void freeze_reactions(const FilledGrid<dim> &grid, const Vec<dim> *force);
  /// Adds the frozen reactions to nodal forces summed over ranks.
  void add_reactions(Vec<dim> *force) const;
  /// Adds the tractions of columns on the sides that they stand beside to nodal forces summed over ranks; `traction`
  /// gives the force per area on the soil in a filled cell of this rank through a face of outward normal n [Pa].
  /// Collective.
  using Traction = std::function<Vec<dim>(int cell, const Vec<dim> &n)>;
  PetscErrorCode add_columns(FilledGrid<dim> &grid, const Traction &traction, Vec<dim> *force);

  /// Imposes prescribed velocities and keeps nodes from entering a base. With `sticking`, nodes that stuck in the last
  /// `resolve` do not slide.
  void constrain(double t, const FilledGrid<dim> &grid, Vec<dim> *v, bool sticking);
  /// Gives nodes with dashpots that end in rock or nothing the velocity `v` in place of the mapped one, `w`. Particles
  /// lie on one side of them: where soil moves against a dashpot, which strains it, a mean of theirs is that of a place
  /// half a cell inside.
  void keep_dashpots(const Vec<dim> *v, Vec<dim> *w) const {
    for (const Dashpot &d : active_dashpots_)
      if (!sources_[d.source].kind.has_column) w[d.node] = v[d.node];
  }
  /// Lets nodes that pressed on rigid bodies or on another group in the last `resolve` go on with these, in velocities
  /// by which places move.
  void follow_contacts(Vec<dim> *w) const;
  /// Gives nodes of groups that are bonded their common velocity.
  void join_bonded(Vec<dim> *v) const;
  /// Takes from velocities what goes into a base.
  void leave_base(Vec<dim> *v) { bases_.leave_base(prescribed_, v); }
  /// Subtracts from nodal forces the forces of dashpots and friction at velocities `v`, and the parts that supports and
  /// bases bear.
  void project(const Vec<dim> *v, Vec<dim> *force);
  using Pores = PoresInContact<dim>;
  /// Velocity from now on at the other end of dashpots through which a wave comes in [m/s].
  void move_ground(const Vec<dim> &velocity) {
    ground_velocity_ = velocity;
    for (Dashpot &d : active_dashpots_)
      if (sources_[d.source].kind.incoming_wave) d.beyond = velocity;
  }
  /// Applies contact between groups, dashpots, contact with friction, prescribed velocities and rigid bodies,
  /// implicitly over a step gamma, and sums up the reactions. Collective.
  PetscErrorCode resolve(double t, double gamma, const FilledGrid<dim> &grid, Vec<dim> *v, const Pores &pores = {});

  /// What `resolve` would do to velocities that are not final, with dashpots and supports: nothing is summed up.
  void foresee(double t, double gamma, const FilledGrid<dim> &grid, Vec<dim> *v, const Pores &pores);
  /// Calls use(node, R) for nodes with dashpots, of whose velocity a step gamma leaves R v.
  template <class Use>
  void each_damped(double gamma, const FilledGrid<dim> &grid, const Pores &pores, Use &&use) const {
    for (const Dashpot &d : active_dashpots_) {
      const Square<dim> mass = pores.mass(grid, d.node), system = mass + gamma * d.matrix;
      use(d.node, Square<dim>(system.inverse() * mass));
    }
  }

  /// Adds the work of the boundaries in an accepted step with nodal displacements `u`, and what bases remember of it;
  /// rigid bodies and structures move. Collective.
  void add_work(const FilledGrid<dim> &grid, const Vec<dim> *u);
  /// Work of each source, and behind them of each rigid body and each contact between groups, on the soil, on this rank
  /// [J].
  const std::vector<double> &work() const { return work_; }

  SurfaceLoads<dim> &surface_loads() { return surface_loads_; }
  RigidBases<dim> &bases() { return bases_; }
  const RigidBases<dim> &bases() const { return bases_; }
  RigidBodies<dim> *rigid_bodies() { return rigid_.get(); }  ///< null: the scene has none
  const RigidBodies<dim> *rigid_bodies() const { return rigid_.get(); }
  SoilContact<dim> *soil_contact() { return contact_.get(); }  ///< null: all bodies are of one group
  const SoilContact<dim> *soil_contact() const { return contact_.get(); }
  /// Saves or loads the state that `begin` cannot find again: the state of contacts, frozen reactions, impulses and
  /// work. Loading calls `begin`. Collective.
  PetscErrorCode serialize(Archive &archive, FilledGrid<dim> &grid, const std::vector<std::array<double, 2>> &impedance,
                           const std::vector<double> &filling);

  const std::vector<Source> &sources() const { return sources_; }
  const PrescribedMotion<dim> &prescribed() const { return prescribed_; }
  bool has_dashpots() const { return !dashpots_.empty(); }
  bool has_stand_ins() const {
    return std::ranges::any_of(sources_, [](const Source &source) { return source.kind.stands_in(); });
  }
  bool loads(int source) const { return sources_[source].kind.in_motion == OnSoil::load; }
  /// Impulse on the soil by each boundary since the last call, per source [N s]; collective.
  PetscErrorCode take_impulses(MPI_Comm comm, std::vector<Vec<dim>> &impulse);

 private:
  using ActivePrescribed = typename PrescribedMotion<dim>::Active;
  struct Dashpot {
    int node, source;
    Square<dim> matrix;  // [kg/s]
    Vec<dim> beyond;     // velocity of its other end [m/s]
  };
  void damp(const Dashpot &d, double gamma, const Square<dim> &mass, Vec<dim> &v) const {
    const Square<dim> system = mass + gamma * d.matrix;
    map<dim>(v) = system.inverse() * (mass * map<dim>(v) + gamma * d.matrix * map<dim>(d.beyond));
  }
  void see_columns(const Vec<dim> *v);
  struct Reaction {
    int node, source;
    Vec<dim> value;  // impulse of the last `resolve` [N s], or dead load [N]
  };

  std::vector<Source> sources_;
  PrescribedMotion<dim> prescribed_;
  RigidBases<dim> bases_;
  std::unique_ptr<RigidBodies<dim>> rigid_;
  std::unique_ptr<SoilContact<dim>> contact_;
  std::unique_ptr<StructuresInMotion<dim>> structures_;
  struct DashpotFace {
    int source, column;  // the column at its other end, -1: none
    std::vector<Facet<dim>> facets;
  };
  std::vector<DashpotFace> dashpots_;  ///< those with a column are the last ones
  std::vector<Dashpot> active_dashpots_;
  std::vector<SideColumn<dim>> columns_;
  std::vector<std::vector<int>> column_nodes_;  ///< compact, of each column
  std::vector<int> first_dashpot_;              ///< active one of each column, and behind them the number of all
  std::vector<double> nodal_;
  Vec<dim> ground_velocity_{};
  double resolved_step_ = 0;
  bool stand_ins_ = false;
  std::vector<Reaction> frozen_, active_frozen_, impulses_;  ///< by mesh node; by compact node; of the last `resolve`
  std::vector<Reaction> pulls_;                              ///< of columns, last added
  std::vector<double> work_;
  std::vector<Vec<dim>> impulse_;
  SurfaceLoads<dim> surface_loads_;
  std::vector<char> counted_;  // [compact] this rank counts the node in global sums
};

}  // namespace talus
