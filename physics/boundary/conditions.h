#pragma once
/// The action of the boundaries of a scene on the skeleton at the nodes, docs/theory section 6. Prescribed directions
/// are orthonormalised per node once. A contact has one constraint per patch of facets at a node. Loads and dashpots
/// act where facets have soil behind them.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/archive.h"
#include "meshes/background_mesh.h"
#include "physics/boundary/boundary.h"
#include "physics/boundary/prescribed_directions.h"
#include "physics/boundary/surface_loads.h"
#include "transfer/filled_grid.h"

namespace talus {

template <int dim>
class Conditions {
 public:
  struct Source {
    std::string name;
    std::vector<std::string> groups;
    Boundary kind;
  };
  /// Collects nodes and normals of all groups, also of facets that only a neighbouring rank has. Collective.
  PetscErrorCode setup(const BackgroundMesh<dim> &mesh, std::vector<Source> sources);
  /// Picks the nodes and facets of the filled grid. `impedance` [filled cells] holds rho c_p and rho c_s. Collective.
  PetscErrorCode begin(FilledGrid<dim> &grid, const std::vector<std::array<double, 2>> &impedance,
                       const std::vector<double> &filling);

  /// In stages that freeze loads (`hold_loads`), supports stand in for dashpots. Takes effect at the next `begin`.
  void use_stand_ins(bool use) { stand_ins_ = use; }
  bool uses_stand_ins() const { return stand_ins_; }
  /// Stores the reactions of those supports to the nodal forces (summed over ranks) as a dead load.
  void freeze_reactions(const FilledGrid<dim> &grid, const Vec<dim> *force);
  /// Adds the frozen reactions to nodal forces summed over ranks.
  void add_reactions(Vec<dim> *force) const;

  /// Imposes prescribed velocities and keeps nodes from entering a base. With `sticking`, nodes that stuck in the last
  /// `resolve` do not slide.
  void constrain(double t, const FilledGrid<dim> &grid, Vec<dim> *v, bool sticking) const;
  /// Subtracts from nodal forces the forces of dashpots and friction at velocities `v`, and the parts that supports and
  /// bases bear.
  void project(const FilledGrid<dim> &grid, const Vec<dim> *v, Vec<dim> *force) const;
  /// The part of the pore fluids in contact at a node; empty where fluids do not move.
  struct Pores {
    std::function<Square<dim>(int node)> inertia;  ///< of the node against supports, in place of the grid's mass [kg]
    std::function<double(int node, const Vec<dim> &normal)>
        thrust;  ///< force of the pores on a base, which takes no part in friction [N]
  };
  /// Applies dashpots, contact with friction and prescribed velocities, implicitly over a step gamma, and sums up the
  /// reactions.
  void resolve(double t, double gamma, const FilledGrid<dim> &grid, Vec<dim> *v, const Pores &pores = {});

  /// Adds the work of the boundaries in an accepted step with nodal displacements `u`, and what bases remember of it.
  void add_work(const Vec<dim> *u);
  /// Work of each source on the soil, on this rank [J].
  const std::vector<double> &work() const { return work_; }

  /// A force by which soil presses on a base at a vertex of the mesh.
  struct NormalForce {
    int source;
    Vec<dim> position, normal;  ///< [m]; of the base, pointing out of the soil
    double force;               ///< [N]
  };
  /// Bases are pressed on by these forces of this rank and of the others since long, so that friction has adapted to
  /// them at time t, and by no others. Collective.
  PetscErrorCode set_normal_forces(const BackgroundMesh<dim> &mesh, std::vector<NormalForce> forces, double t);

  /// Mean depth of the soil in the cells `filled` [cells] on bases: its volume over the area of their facets beside it,
  /// and no more than the soil is long; 0 without bases [m]. Collective.
  PetscErrorCode depth_on_bases(const BackgroundMesh<dim> &mesh, const std::vector<char> &filled, double *depth) const;
  /// Time over which friction adapts to the normal force, docs/theory (6.2) [s].
  void set_friction_delay(double delay) { friction_delay_ = delay; }

  /// Do slip and heat of bases count from now on? Otherwise bases keep the strength that they have.
  void remember_slip(bool remember) { remembers_ = remember; }
  /// All bases are fresh and cold again.
  void forget_slip();

  SurfaceLoads<dim> &surface_loads() { return surface_loads_; }
  /// Saves or loads the state that `begin` cannot find again: the state of contacts, frozen reactions, impulses and
  /// work. Loading calls `begin`. Collective.
  PetscErrorCode serialize(Archive &archive, FilledGrid<dim> &grid, const std::vector<std::array<double, 2>> &impedance,
                           const std::vector<double> &filling);

  const std::vector<Source> &sources() const { return sources_; }
  /// Facets of the bases of this rank, with the source that they belong to.
  const std::vector<std::pair<int, std::vector<Facet<dim>>>> &bases() const { return bases_; }
  bool has_dashpots() const { return !dashpots_.empty(); }
  bool loads(int source) const { return sources_[source].kind.in_motion == OnSoil::load; }
  /// A base as the soil finds it that touches it now: means over its area, per source.
  struct BaseReport {
    double slip = 0;                      ///< [m]
    double friction = 0;                  ///< sum of friction over sum of total normal forces since the last call
    double temperature = 0, hottest = 0;  ///< rise in the shear zone, its mean and that of the hottest place [K]
    double pressure = 0;                  ///< excess pressure in the shear zone [Pa]
    double heat = 0;                      ///< that friction has left in and beside the shear zone, in all [J]
  };
  /// Collective.
  PetscErrorCode take_bases(MPI_Comm comm, std::vector<BaseReport> &reports);
  /// Impulse on the soil by each boundary since the last call, per source [N s]; collective.
  PetscErrorCode take_impulses(MPI_Comm comm, std::vector<Vec<dim>> &impulse);

 private:
  using Prescribed = PrescribedDirections<dim>;
  struct Contact {     // one patch of a base at a node
    int node, source;  // mesh node
    Vec<dim> normal;
    double area;
    double capacity;       // friction impulse that normal impulses of the recent past still allow [N s]
    double gathered;       // time since which `capacity` gathers, where soil was at the start; elsewhere `never` [s]
    double since_pressed;  // time since the node last pressed on the base [s]
    bool rests;            // in equilibrium as finite elements have found it, until the next `resolve`
    double slip;           // along the base since the start [m]
    int zone;              // place of its shear zone in zone_state_; -1: none
    bool warm;             // the shear zone has been heated
  };
  struct ActivePrescribed {
    int node;  // compact
    const Prescribed *condition;
    Vec<dim> change;  // of the velocity of the node by it, while contacts are resolved [m/s]
  };
  struct ActiveContact {
    int node;
    Contact *contact;
    double area;           // with soil behind it [m2]
    double force;          // friction against sliding in the last `resolve` [N]
    bool presses, sticks;  // in the last `resolve`
    Vec<dim> rubbed;       // impulse of friction in the last `resolve` [N s]
    // Of the step that is being resolved:
    Vec<dim> change;       // of the velocity of the node by this contact [m/s]
    double pressed, rubs;  // normal impulse and impulse of friction [N s]
    double capacity;       // that the contact will have
  };
  class Barred;
  struct Dashpot {
    int node, source;
    Square<dim> matrix;  // [kg/s]
  };
  struct Reaction {
    int node, source;
    Vec<dim> value;  // impulse of the last `resolve` [N s], or dead load [N]
  };
  struct PrescribedSet {
    std::vector<int> of_node;  // mesh node -> entry, -1: none
    std::vector<Prescribed> entry;
  };
  void add_direction(PrescribedSet &set, int node, int source, const Vec<dim> &direction);
  void add_contact(int node, int source, const Vec<dim> &normal, double area);
  size_t last_at_node(size_t first) const;
  Vec<dim> respond(ActiveContact &c, double t, double gamma, const Vec<dim> &x, const Square<dim> &mass,
                   const Pores &pores, const Vec<dim> &before);
  void settle_node(double t, double gamma, const Vec<dim> &x, const Square<dim> &mass, const Pores &pores, size_t first,
                   size_t last, ActivePrescribed *support, Vec<dim> &v);
  void impose(const ActivePrescribed &p, int k, double t, const Vec<dim> &x, Vec<dim> &v) const;
  void commit(ActiveContact &c, double gamma);
  void serialize_contacts(Archive &archive, const FilledGrid<dim> &grid);
  void serialize_zones(Archive &archive, const BackgroundMesh<dim> &mesh);
  ShearZoneGrid &grid_of(const Contact &c) { return *zone_grids_[c.source]; }
  double *zone_of(const Contact &c) { return &zone_state_[c.zone]; }
  void spread_heat(double gamma);
  double left_by_pressure(const ActiveContact &c, double rubbing, double adhering, double slope, double gamma,
                          double speed);
  void add_slip(ActiveContact &c, const Vec<dim> &u);
  double target(const Prescribed &c, int k, const Vec<dim> &x, double t) const;

  std::vector<Source> sources_;
  std::vector<int> first_contact_of_node_;
  std::array<PrescribedSet, 2> prescribed_;  ///< directions beside dashpots; with the supports that stand in for them
  std::vector<std::vector<Contact>> contacts_;
  std::vector<std::pair<int, std::vector<Facet<dim>>>> dashpots_, bases_;
  std::vector<ActivePrescribed> active_prescribed_;
  std::vector<ActiveContact> active_contacts_;
  std::vector<Dashpot> active_dashpots_;
  std::vector<double> nodal_;
  double friction_delay_ = 0, resolved_step_ = 0;
  bool stand_ins_ = false, remembers_ = true;
  std::vector<std::unique_ptr<ShearZoneGrid>> zone_grids_;   ///< of each source; null: no shear zone
  std::vector<Contact *> zoned_;                             ///< contacts that have one
  std::vector<double> zone_state_;                           ///< of all of them
  std::vector<std::array<double, 2>> rubbed_;                ///< impulses since the last report: friction, normal [N s]
  std::vector<Reaction> frozen_, active_frozen_, impulses_;  ///< by mesh node; by compact node; of the last `resolve`
  std::vector<double> work_;
  std::vector<Vec<dim>> impulse_;
  SurfaceLoads<dim> surface_loads_;
  std::vector<char> counted_;  // [compact] this rank counts the node in global sums
};

}  // namespace talus
