#pragma once
/// Contact between groups of bodies, docs/theory (6.15) to (6.17). Each group has nodes and cells of its own, its sheet
/// of the mesh; where two sheets have soil at a node, impulses act between both. Friction follows the normal impulses
/// as on rigid bases (friction_memory.h). No fluids in the pores.
#include <array>
#include <string>
#include <vector>

#include "base/archive.h"
#include "meshes/background_mesh.h"
#include "physics/boundary/friction_memory.h"
#include "physics/boundary/prescribed_motion.h"
#include "physics/boundary/rigid_bases.h"
#include "transfer/filled_grid.h"

namespace talus {

struct ContactSource;

template <int dim>
class SoilContact {
 public:
  /// `pairs` are the two sheets of each source. The references must outlive it.
  SoilContact(const BackgroundMesh<dim> &mesh, const std::vector<ContactSource> &sources,
              const std::vector<std::array<int, 2>> &pairs);

  const std::vector<ContactSource> &sources() const { return sources_; }

  /// At a remap: finds the nodes at which groups meet, their normals and gaps. `volume` [node][stride] is that of the
  /// particles at the nodes, of all ranks [m3]; where sheets meet it becomes that of both. Lighter nodes than
  /// `smallest_mass` do not meet [kg]. Collective.
  PetscErrorCode search(FilledGrid<dim> &grid, double smallest_mass, double *volume, int stride);
  /// Place of a node of this rank at which three groups met in the last search; false: none.
  bool find_crowded(Vec<dim> *where) const;
  /// Of a grid that was searched: bonded groups get their common velocity, and nodes of three groups none at all, which
  /// ends the run.
  void meet(const FilledGrid<dim> &grid, Vec<dim> *v) const;

  /// A step gamma that ends at load time t, before supports and bases act.
  struct Step {
    double t, gamma;
    const FilledGrid<dim> &grid;
    PrescribedMotion<dim> &prescribed;
    const RigidBases<dim> &bases;
  };
  /// Applies the impulses of a step to the nodes' velocities.
  void resolve(const Step &step, Vec<dim> *v);
  /// Lets nodes that pressed, hung together or stuck in the last `resolve` go on together, in velocities by which
  /// places move.
  void follow(Vec<dim> *w) const;
  /// Gives nodes of groups that are bonded their common velocity.
  void join_bonded(Vec<dim> *v) const;
  /// Takes from nodal forces what groups bear between each other at velocities `v`.
  void project(const Vec<dim> *v, Vec<dim> *force) const;
  /// The step of the last `resolve` was accepted with nodal displacements `u`: adds the `work` of each source on the
  /// soil [J].
  void add_work(const Vec<dim> *u, double *work) const;

  /// Of a source since the last call.
  struct Report {
    Vec<dim> impulse{};   ///< on the second group [N s]
    double friction = 0;  ///< sum of friction over sum of normal impulses
    double sliding = 0;  ///< mean velocity of the second group along the first one, weighted with normal impulses [m/s]
  };
  /// Collective.
  PetscErrorCode take_reports(std::vector<Report> &reports);
  /// Saves or loads contacts. After the grid.
  void serialize(Archive &archive, const FilledGrid<dim> &grid);

 private:
  using Held = std::array<PrescribedDirections<dim>, 2>;
  struct Contact {
    int base, source;               // node of the first sheet, and number of the source
    std::array<int, 2> node;        // compact, of both groups: the one with the lower sheet first
    std::array<double, 2> inverse;  // of their masses [1/kg]
    Vec<dim> normal;                // from the first node's group to the other
    double gap;                     // at the last search [m]
    double area;                    // of the surface at the node [m2]
    FrictionMemory memory;
    // Of the last `resolve`:
    Held held;            // in which supports and bases hold the nodes
    bool presses, hangs;  // the groups touch, under pressure or tension
    bool joined, sticks;  // they move alike along the normal, and across it
    double force;         // friction against sliding [N]
    double closing;       // normal velocity at which the gap closes in the step [m/s]
    Vec<dim> impulse;     // on the second node's group [N s]
  };
  /// How a pair of nodes gives way to impulses.
  struct Yield {
    Square<dim> mobility;  // relative velocity by an impulse [1/kg]
    double across, along;  // along the normal, and mean across it [1/kg]
    double light;          // mobility below which supports hold both nodes [1/kg]
  };
  struct Sums {
    Vec<dim> impulse{};
    double normal = 0, friction = 0, slipped = 0;
  };

  void find_meetings(const FilledGrid<dim> &grid, double smallest_mass, double *volume, int stride);
  void number_contacts();
  PetscErrorCode find_areas(FilledGrid<dim> &grid);
  PetscErrorCode smooth_normals(FilledGrid<dim> &grid);
  PetscErrorCode find_gaps(FilledGrid<dim> &grid, const double *volume, int stride);
  template <class Use>
  void each_around(const Contact &c, Use &&use) const;
  Square<dim> mobility_of(const Contact &c, int side) const;
  Yield yield_of(const Contact &c) const;
  Vec<dim> hold(Contact &c, int side, const Step &step, const Vec<dim> &v) const;
  void resolve(Contact &c, const Step &step, Vec<dim> *v);

  const BackgroundMesh<dim> &mesh_;
  const std::vector<ContactSource> &sources_;
  std::vector<std::array<int, 2>> pairs_;
  std::vector<int> source_of_;          ///< [sheet][sheet]
  std::vector<int> first_cell_, cell_;  ///< cells of the first sheet around its nodes
  std::vector<int> contact_at_;         ///< [node of the first sheet] contact plus one, 0: none
  std::vector<Contact> contacts_, before_;
  std::vector<Vec<dim>> area_;  ///< [contact] of the surface, from the first group to the other [m2]
  std::vector<double> nodal_;
  std::vector<Sums> sums_;    ///< [source] since the last report, of this rank
  std::vector<int> crowded_;  ///< mesh nodes
  bool searched_ = false;
  double resolved_step_ = 0;
};

}  // namespace talus
