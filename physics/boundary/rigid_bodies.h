#pragma once
/// Rigid bodies that soil meets, docs/theory (6.12) to (6.14): contact at the nodes near their surfaces, by impulses
/// without a stiffness. In plane strain. Bodies do not meet one another, nor the ends of the mesh.
#include <array>
#include <memory>
#include <unordered_map>
#include <vector>

#include "base/archive.h"
#include "meshes/background_mesh.h"
#include "particles/body.h"
#include "physics/boundary/friction_memory.h"
#include "physics/boundary/prescribed_motion.h"
#include "physics/boundary/rigid_bases.h"
#include "physics/boundary/rigid_shape.h"
#include "transfer/filled_grid.h"

namespace talus {

struct RigidSource;

template <int dim>
class RigidBodies {
 public:
  static constexpr int freedoms = dim * (dim + 1) / 2;  ///< translations, then rotations
  /// Place or velocity of a body in its freedoms, or force and moment on it.
  using Freedoms = Vec<freedoms>;
  using Soil = std::vector<std::unique_ptr<Body<dim>>>;

  /// The references must outlive it. Collective.
  RigidBodies(const BackgroundMesh<dim> &mesh, const Soil &soil, const std::vector<RigidSource> &sources);

  const std::vector<RigidSource> &sources() const { return sources_; }
  /// Acceleration of free bodies from now on [m/s2].
  void set_gravity(const Vec<dim> &gravity) { gravity_ = gravity; }

  /// A particle that lies deeper in a body than `share` of the cell size, on this rank; false if there is none.
  bool find_overlap(double share, int *body, Vec<dim> *where) const;
  /// Finds the nodes near bodies, and how far the particles around them are away. Collective.
  PetscErrorCode search(const FilledGrid<dim> &grid);

  /// A step gamma that ends at load time t, between supports and bases of the filled grid that have acted already.
  struct Step {
    double t, gamma;
    const FilledGrid<dim> &grid;
    PrescribedMotion<dim> &prescribed;
    const RigidBases<dim> &bases;
  };
  /// Applies the impulses of a step to the nodes' velocities, and finds the velocities of the bodies at its end.
  /// Collective.
  PetscErrorCode resolve(const Step &step, Vec<dim> *v);
  /// Lets nodes that pressed or stuck in the last `resolve` go on with their bodies.
  void follow(Vec<dim> *w) const;
  /// Subtracts from nodal forces what bodies bear at velocities `v`.
  void project(const Vec<dim> *v, Vec<dim> *force) const;
  /// The step of the last `resolve` was accepted with nodal displacements `u`: bodies move; adds their `work` on the
  /// soil [body] [J].
  void advance(const Vec<dim> *u, double *work);

  struct Report {
    Freedoms place, velocity;  ///< of the centre, and of the rotation [m], [rad], [m/s], [rad/s]
    Freedoms impulse;          ///< on the body, and about its centre, since the last call [N s], [N m s]
  };
  /// Collective.
  PetscErrorCode take_reports(std::vector<Report> &reports);
  /// Saves or loads places, velocities and contacts. After the grid.
  void serialize(Archive &archive, const FilledGrid<dim> &grid);

 private:
  struct Moving {
    RigidShape<dim> shape;     // about the centre, as it lies at the start
    Freedoms mass;             // infinite where the motion is prescribed [kg], [kg m2]
    Freedoms place, velocity;  // now
    Freedoms searched;         // place at the last search
  };
  struct Contact {
    long long global;                // number of the node
    int body, node, at;              // mesh node, and compact node
    Vec<dim> normal;                 // into the body
    PrescribedDirections<dim> held;  // in which supports and bases hold the node
    double gap;                      // at the last search [m] ...
    Vec<dim> place;                  // ... where the node was then
    double area;                     // of the soil's surface at the node [m2]
    FrictionMemory memory;
    // Of the last `resolve`:
    bool presses, sticks;
    double force;      // friction against sliding [N]
    double follows;    // least normal velocity with which the node enters the body [m/s]
    Vec<dim> with;     // velocity of the body at the node [m/s]
    Vec<dim> gained;   // of that in the step [m/s]
    Vec<dim> impulse;  // on the body [N s]
  };
  /// A contact within a step.
  struct Meeting {
    bool counted;            // this rank counts the node in global sums
    Square<dim> mobility;    // velocity that an impulse gives the node [1/kg]
    double light, least;     // mobility below which supports hold the node; what a normal impulse meets there [1/kg]
    double closing;          // normal velocity at which the gap closes in the step [m/s]
    double slope, adhering;  // coefficient of friction [-], impulse of adhesion [N s]
    double share;            // of the capacity that the step spends [-]
    Vec<dim> before;         // velocity of the node [m/s]
  };
  struct Response {
    Vec<dim> impulse;       // on the body [N s]
    Square<dim> stiffness;  // its derivative by the velocity of the node against the body [kg]
    double capacity, most;  // friction impulse that the past allows, and the step [N s]
    bool presses, sticks;
  };
  struct Candidate {
    long long global;
    int body, node;
    double gap, area;  // of the soil's surface, as the integral of the node's gradient has it
    Vec<dim> outward;
  };
  using Arm = Eigen::Matrix<double, dim, freedoms>;
  using System = Eigen::Matrix<double, freedoms, freedoms + 1>;

  static Moving moving_of(const RigidSource &source);
  ConstMap<dim> centre(const Moving &body) const;
  Square<dim> orientation(const Freedoms &place) const;
  Vec<dim> carried(const Moving &body, const Vec<dim> &x) const;
  Arm arm(const Moving &body, const Vec<dim> &x) const;
  double distance(const Moving &body, const Vec<dim> &x, Vec<dim> &outward) const;
  void add_candidates(const FilledGrid<dim> &grid, const Body<dim> &soil, int particle);
  void merge_candidates();
  PetscErrorCode share_candidates();
  Contact contact_of(const Candidate &found, const FilledGrid<dim> &grid) const;
  bool search_due() const;
  Freedoms predicted(int body, double t, double gamma) const;
  PrescribedDirections<dim> held_at(int node, const Step &step) const;
  Meeting meeting(const Contact &c, const Step &step, const Vec<dim> *v) const;
  Vec<dim> velocity_at(const Moving &body, const Freedoms &motion, const Vec<dim> &x) const;
  Response respond(size_t contact, const Step &step, const Freedoms &motion) const;
  PetscErrorCode sum_responses(int body, const Step &step, const Freedoms &motion, System *sums) const;
  PetscErrorCode solve(int body, const Step &step, Freedoms *motion) const;
  Freedoms exchange(size_t contact, const Step &step, const Freedoms &motion, Vec<dim> *v);
  PetscErrorCode apply(int body, const Step &step, const Freedoms &motion, Vec<dim> *v);
  size_t first_contact(int body) const;

  const BackgroundMesh<dim> &mesh_;
  const Soil &soil_;
  const std::vector<RigidSource> &sources_;
  std::vector<Moving> bodies_;
  std::vector<Contact> contacts_, before_;  ///< by body and global number; and those of the search before
  std::vector<Meeting> meetings_;           ///< of the contacts
  std::vector<Candidate> candidates_;
  std::unordered_map<long long, int> shared_;  ///< nodes that other ranks have too, by global number
  std::vector<Freedoms> impulse_;              ///< on bodies since the last report, of this rank [N s]
  Vec<dim> gravity_{};
  double smallest_edge_ = 0, resolved_step_ = 0;
  bool searched_ = false;
};

}  // namespace talus
