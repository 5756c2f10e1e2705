#pragma once
/// Work done to the soil since the start, docs/theory (6.6), beside that of boundaries (Conditions::work): by gravity,
/// by what else the scene imposes, and by damping. An accepted step counts the forces of the last evaluation.
#include <algorithm>
#include <vector>

#include "base/archive.h"
#include "base/room.h"
#include "transfer/filled_grid.h"

namespace talus {

/// Of this rank [J].
struct WorkDone {
  double gravity = 0;
  double imposed = 0;  ///< by body accelerations and prescribed pore pressure
  double damping = 0;  ///< by local or Rayleigh damping
};

template <int dim>
class WorkLedger {
 public:
  /// `imposes`: the scene has body accelerations or prescribes pore pressure.
  WorkLedger(int nodes, bool imposes) { make_room(imposed_, imposes ? nodes : 0), make_room(damping_, nodes); }

  bool imposes() const { return !imposed_.empty(); }
  /// To be called before and after imposed forces are added to `force` [node] [N].
  void before_imposed(const Vec<dim> *force, int nodes) { std::copy_n(force, nodes, imposed_.begin()); }
  void after_imposed(const Vec<dim> *force, int nodes) {
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) imposed_[i][d] = force[i][d] - imposed_[i][d];
  }
  /// Force of local damping, or the mass part of Rayleigh damping, against the motion of a node [N].
  Vec<dim> &damping(int node) { return damping_[node]; }

  /// Counts a step with nodal displacements `u` [m] under `gravity` [m/s2]; `extra_mass` [node] weighs beside the
  /// grid's mass [kg], null: nothing does. `damped`: `damping` acts.
  void add(const FilledGrid<dim> &grid, const Vec<dim> *u, const Vec<dim> &gravity, const double *extra_mass,
           bool damped);
  /// Counts forces of damping that the cells of this rank exert [node] [N].
  void add_damping(const FilledGrid<dim> &grid, const Vec<dim> *u, const Vec<dim> *force) {
    for (int i = 0; i < grid.node_count(); ++i)
      for (int d = 0; d < dim; ++d) done_.damping += force[i][d] * u[i][d];
  }
  const WorkDone &done() const { return done_; }
  void serialize(Archive &archive) { archive.sums("work", done_.gravity, done_.imposed, done_.damping); }

 private:
  std::vector<Vec<dim>> imposed_;  ///< [node] of this rank [N]
  std::vector<Vec<dim>> damping_;  ///< [node] [N]
  WorkDone done_;
};

}  // namespace talus
