#pragma once
/// The part of the background mesh that holds particles, during one Lagrangian part: nodes and cells are numbered
/// compactly, so that the time loop touches nothing else. Every array is sized for the whole local mesh once: its first
/// node_count() or cell_count() entries count.
#include <array>
#include <vector>

#include "base/archive.h"
#include "meshes/background_mesh.h"
#include "physics/laws/stress.h"

namespace talus {

/// Entries of a symmetric (dim + 1) x (dim + 1) matrix: diagonal first, then 01, 02, (03,) 12, (13, 23).
template <int dim>
inline constexpr int simplex_pairs = (dim + 1) * (dim + 2) / 2;

/// Shape of a filled cell on the current node positions.
template <int dim>
struct Shape {
  std::array<int, dim + 1> node;       ///< compact node numbers
  std::array<Vec<dim>, dim> gradient;  ///< of the shape functions 1..dim [1/m]
  double volume;                       ///< [m3]
};

template <int dim>
class FilledGrid {
 public:
  explicit FilledGrid(const BackgroundMesh<dim> &mesh);

  /// Removes all nodes and cells.
  void clear();
  /// Compact number of a mesh cell, which is the last one on first use: it has its nodes and gradients then, and its
  /// sums over particles are to be set.
  [[gnu::always_inline]] int enter_cell(int cell) {
    if (compact_cell_[cell] == 0) {
      const Cell<dim> &entered = mesh_->cells[cell];
      Shape<dim> &s = shape[cell_count_];
      for (int k = 0; k <= dim; ++k) s.node[k] = enter_node(entered.node[k]);
      s.gradient = entered.gradient;
      mesh_cell[cell_count_] = cell, compact_cell_[cell] = ++cell_count_;
    }
    return find_cell(cell);
  }
  /// Compact number of a mesh cell, -1 when it holds nothing.
  int find_cell(int mesh_cell) const { return compact_cell_[mesh_cell] - 1; }
  /// Compact number of a mesh node, -1 when no filled cell has it.
  int find_node(int mesh_node) const { return compact_node_[mesh_node] - 1; }
  /// Once all cells are entered: enters nodes that only other ranks have filled, and places cells and nodes as they are
  /// in the mesh; collective.
  void complete();
  /// Adds up `width` doubles per compact node over the ranks that share the node, and over nodes that are tied;
  /// collective.
  PetscErrorCode sum(double *values, int width);
  /// Rows of a checkpoint for the filled nodes and cells, by compact number.
  struct Rows {
    Archive::Rows nodes, cells;
  };
  /// Saves or loads nodes and cells with their fields.
  Rows serialize(Archive &archive);

  int node_count() const { return node_count_; }
  int cell_count() const { return cell_count_; }
  const BackgroundMesh<dim> &mesh() const { return *mesh_; }

  // nodes, by compact number
  std::vector<int> mesh_node;
  std::vector<double> mass;        ///< lumped [kg]
  std::vector<Vec<dim>> position;  ///< current [m]; the mesh's own at a remap
  // cells, by compact number
  std::vector<int> mesh_cell;
  std::vector<Shape<dim>> shape;
  std::vector<std::array<double, simplex_pairs<dim>>> mass_matrix;  ///< sum_p m_p N_ip N_jp [kg]
  std::vector<std::array<double, dim + 1>> nodal_share;             ///< sum_p V_p N_ip [m3]
  std::vector<double> size;                                         ///< element size of the softening law [m]
  std::vector<int> patch;                                           ///< patch of the mesh

 private:
  double element_size_of(int mesh_cell);
  void find_ties() {
    ties_.find_places([this](int node) { return find_node(node); });
  }
  int enter_node(int node) {
    if (compact_node_[node] == 0) mesh_node[node_count_] = node, compact_node_[node] = ++node_count_;
    return find_node(node);
  }

  const BackgroundMesh<dim> *mesh_;
  int node_count_ = 0, cell_count_ = 0;
  std::vector<int> compact_node_, compact_cell_;  // of the mesh: compact number plus one, 0 where it holds nothing
  std::vector<double> element_size_;              ///< of mesh cells that were filled before, otherwise 0 [m]
  std::vector<double> staging_;
  Halo halo_;
  LinkedNodes ties_;
};

/// Gradients 1..dim and volume of a simplex from its edges, which lead from vertex 0 to the others; the volume is
/// negative for an inverted one. Straight-line code, for loops over several cells at a time.
template <int dim>
[[gnu::always_inline]] inline double simplex_gradients(const std::array<Vec<dim>, dim> &edge,
                                                       std::array<Vec<dim>, dim> &gradient) {
  if constexpr (dim == 2) {
    const auto &[a, b] = edge;
    const double det = a[0] * b[1] - b[0] * a[1], i = 1 / det;
    gradient[0] = {b[1] * i, -b[0] * i};
    gradient[1] = {-a[1] * i, a[0] * i};
    return det / 2;
  } else {
    const auto cross = [](const Vec<3> &a, const Vec<3> &b) __attribute__((always_inline)) {
      return Vec<3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const auto &[a, b, c] = edge;
    const Vec<3> bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
    const double det = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2], i = 1 / det;
    gradient[0] = {bc[0] * i, bc[1] * i, bc[2] * i};
    gradient[1] = {ca[0] * i, ca[1] * i, ca[2] * i};
    gradient[2] = {ab[0] * i, ab[1] * i, ab[2] * i};
    return det / 6;
  }
}

/// Element size of the softening law, docs/theory (2.7), equal for a triangle and for the tetrahedra of its slice.
template <int dim>
double element_size(double volume);

}  // namespace talus
