#pragma once
/// Contact of the skeleton with rigid bases that rub, docs/theory (6.1), (6.2), (6.8) to (6.11): one contact per patch
/// of a base at a node.
#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "base/archive.h"
#include "meshes/background_mesh.h"
#include "physics/boundary/boundary.h"
#include "physics/boundary/friction_memory.h"
#include "physics/boundary/prescribed_motion.h"
#include "physics/boundary/take_turns.h"
#include "transfer/filled_grid.h"

namespace talus {

/// The part of the pore fluids in contact at a node; empty where fluids do not move.
template <int dim>
struct PoresInContact {
  std::function<Square<dim>(int node)> inertia;  ///< of the node against supports, in place of the grid's mass [kg]
  std::function<double(int node, const Vec<dim> &normal)>
      thrust;  ///< force of the pores on a base, which takes no part in friction [N]

  Square<dim> mass(const FilledGrid<dim> &grid, int node) const {
    return inertia ? inertia(node) : Square<dim>(grid.mass[node] * Square<dim>::Identity());
  }
};

template <int dim>
class RigidBases {
 public:
  struct Contact {     // one patch of a base at a node
    int node, source;  // mesh node
    Vec<dim> normal;
    double area;
    FrictionMemory memory;
    bool rests;      // in equilibrium as finite elements have found it, until the next `resolve`
    double slip;     // along the base since the start, where soil covers the place [m]
    double beside;   // slip of the rest of the place [m]
    double covered;  // share of the place that soil has covered since it came
    double passed;   // way of the soil since it came [m]
    int zone;        // place of its shear zone in zone_state_; -1: none
    bool warm;       // the shear zone has been heated
  };
  struct Active {
    int node;  // compact
    Contact *contact;
    double area;           // with soil behind it [m2]
    double force;          // friction against sliding in the last `resolve` [N]
    bool presses, sticks;  // in the last `resolve`
    bool counted;          // this rank counts the node in global sums
    Vec<dim> rubbed;       // impulse of friction in the last `resolve` [N s]
    // Of the step that is being resolved:
    Vec<dim> change;       // of the velocity of the node by this contact [m/s]
    double pressed, rubs;  // normal impulse and impulse of friction [N s]
    double capacity;       // that the contact will have
  };

  void setup(int nodes, const std::vector<NamedBoundary> &sources);
  void add_facets(int source, std::vector<Facet<dim>> facets) { facets_.emplace_back(source, std::move(facets)); }
  void add_contact(int node, int source, const Vec<dim> &normal, double area);
  /// To be called after the last contact. Returns their number.
  size_t finish_setup();
  /// Picks the contacts of the filled grid. Collective.
  PetscErrorCode begin(FilledGrid<dim> &grid, const std::vector<double> &filling);

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
  PetscErrorCode find_depth(const BackgroundMesh<dim> &mesh, const std::vector<char> &filled, double *depth) const;
  /// Time over which friction adapts to the normal force, docs/theory (6.2) [s].
  void set_friction_delay(double delay) { friction_delay_ = delay; }
  double friction_delay() const { return friction_delay_; }
  /// Do slip and heat count from now on? Otherwise bases keep the strength that they have.
  void remember_slip(bool remember) { remembers_ = remember; }
  /// All bases are fresh and cold again.
  void forget_slip();

  /// Keeps nodes from entering a base, with what else `prescribed` demands of them. With `sticking`, nodes that stuck
  /// in the last `resolve` do not slide.
  void constrain(double t, const FilledGrid<dim> &grid, PrescribedMotion<dim> &prescribed, Vec<dim> *v, bool sticking);
  /// Takes from velocities what goes into a base.
  void leave_base(PrescribedMotion<dim> &prescribed, Vec<dim> *v);
  bool none() const { return facets_.empty(); }  ///< in the scene
  /// Subtracts from nodal forces the friction at velocities `v`, and what bases and supports bear beside each other.
  void project(PrescribedMotion<dim> &prescribed, const Vec<dim> *v, Vec<dim> *force);
  /// Applies contact with friction, implicitly over a step gamma, and leaves in `change` what each contact did, and
  /// each support beside them.
  void resolve(double t, double gamma, const FilledGrid<dim> &grid, PrescribedMotion<dim> &prescribed,
               const PoresInContact<dim> &pores, Vec<dim> *v);
  /// What bases remember of the step of the last `resolve`, accepted with nodal displacements `u`.
  void add_slip(const Vec<dim> *u);

  const std::vector<Active> &active() const { return active_; }
  /// Calls use(contact) for each active contact of a compact node.
  template <class Use>
  void each_at(int node, Use &&use) const {
    auto c =
        std::lower_bound(active_.begin(), active_.end(), node, [](const Active &a, int of) { return a.node < of; });
    for (; c != active_.end() && c->node == node; ++c) use(*c);
  }
  /// Facets of this rank, with the source that they belong to.
  const std::vector<std::pair<int, std::vector<Facet<dim>>>> &facets() const { return facets_; }

  /// A base as the soil finds it that touches it now: means over its area, per source.
  struct Report {
    double slip = 0;                      ///< [m]
    double friction = 0;                  ///< sum of friction over sum of total normal forces since the last call
    double temperature = 0, hottest = 0;  ///< rise in the shear zone, its mean and that of the hottest place [K]
    double pressure = 0;                  ///< excess pressure in the shear zone [Pa]
    double heat = 0;                      ///< that friction has left in and beside the shear zone, in all [J]
  };
  /// Collective.
  PetscErrorCode take_reports(MPI_Comm comm, std::vector<Report> &reports);

  /// Saves or loads the state of contacts and shear zones, the latter after `begin`.
  void serialize(Archive &archive, const FilledGrid<dim> &grid);

 private:
  template <class AtContact, class AtSupport>
  void take_turns_at_nodes(PrescribedMotion<dim> &prescribed, Vec<dim> *vectors, const AtContact &at_contact,
                           const AtSupport &at_support);
  size_t last_at_node(size_t first) const;
  Vec<dim> respond(Active &c, double t, double gamma, const Vec<dim> &x, const Square<dim> &mass,
                   const PoresInContact<dim> &pores, const Vec<dim> &before);
  void commit(Active &c, double gamma);
  void cover(Contact &c, double share);
  void serialize_contacts(Archive &archive, const BackgroundMesh<dim> &mesh);
  void serialize_zones(Archive &archive, const BackgroundMesh<dim> &mesh);
  ShearZoneGrid &grid_of(const Contact &c) { return *zone_grids_[c.source]; }
  double *zone_of(const Contact &c) { return &zone_state_[c.zone]; }
  void spread_heat(double gamma);
  double left_by_pressure(const Active &c, double rubbing, double adhering, double slope, double gamma, double speed);
  void add_slip(Active &c, const Vec<dim> &u);

  std::vector<Boundary> kinds_;  ///< of the sources
  std::vector<std::pair<int, std::vector<Facet<dim>>>> facets_;
  std::vector<int> first_contact_of_node_;
  std::vector<std::vector<Contact>> contacts_;
  std::vector<Active> active_;  ///< by compact node
  TakeTurns<dim> take_turns_;
  std::vector<double> nodal_;
  double friction_delay_ = 0, resolved_step_ = 0;
  bool remembers_ = true;
  std::vector<std::unique_ptr<ShearZoneGrid>> zone_grids_;  ///< of each source; null: no shear zone
  std::vector<Contact *> zoned_;                            ///< contacts that have one
  std::vector<double> zone_state_;                          ///< of all of them
  std::vector<std::array<double, 2>> rubbed_;               ///< impulses since the last report: friction, normal [N s]
};

}  // namespace talus
