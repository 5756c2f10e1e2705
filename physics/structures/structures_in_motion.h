#pragma once
/// Structures in the motion of particles, docs/theory/structures.md section 6: their points go with the nodes, as
/// particles do, and their forces act on the nodes like loads. The stiffness of a bar is limited such that it does not
/// shorten the step; its capacities are not.
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "physics/structures/structures.h"
#include "transfer/filled_grid.h"

namespace talus {

template <int dim>
class StructuresInMotion {
 public:
  /// Mean effective stress of a filled cell [Pa].
  using StressOf = std::function<Eigen::Matrix3d(int cell)>;
  /// The references must outlive it.
  StructuresInMotion(const BackgroundMesh<dim> &mesh, Structures<dim> &structures)
      : mesh_(mesh), structures_(structures) {}

  /// Finds the filled cells of the points where a Lagrangian part begins. Collective.
  void begin(const FilledGrid<dim> &grid);
  /// The next `begin` is that of a part under way, from a checkpoint.
  void resume_part() { resumes_ = true; }
  /// Adds this rank's part of the forces on the nodes [N], and remembers the stress around the points. Collective.
  void add_force(const FilledGrid<dim> &grid, const StressOf &stress, Vec<dim> *force);
  /// A step of length `step` [s] was accepted with nodal displacements `u`. Collective.
  void advance(const FilledGrid<dim> &grid, const Vec<dim> *u, double step);

 private:
  struct Place {
    int bar, point, cell;  ///< filled cell
    std::array<int, dim + 1> node;
    std::array<double, dim + 1> share;
    double normal_stress = 0;  ///< across the bar [Pa]
  };
  const BackgroundMesh<dim> &mesh_;
  Structures<dim> &structures_;
  std::vector<Place> places_;
  std::vector<std::size_t> first_;  ///< point of each bar
  bool resumes_ = false;
  int seen_ = -1;  ///< Structures::changes() when the points were found
};

}  // namespace talus
