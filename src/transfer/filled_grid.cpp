#include "transfer/filled_grid.h"

#include <algorithm>
#include <cmath>

namespace talus {

template <>
double element_size<2>(double volume) {
  return std::sqrt(4 * volume / std::sqrt(3.));
}
template <>
double element_size<3>(double volume) {
  return std::cbrt(6 * std::sqrt(2.) * volume);
}

template <int dim>
FilledGrid<dim>::FilledGrid(const BackgroundMesh<dim> &mesh) : mesh_(&mesh), halo_(mesh.halo) {
  const int nodes = mesh.node_count(), cells = mesh.cell_count();
  compact_node_.assign(nodes, -1), compact_cell_.assign(cells, -1);
  mesh_node.resize(nodes), mass.resize(nodes), position.resize(nodes);
  mesh_cell.resize(cells), shape.resize(cells), mass_matrix.resize(cells), nodal_share.resize(cells);
  size.resize(cells), patch.resize(cells), element_size_.reserve(cells);
  for (double volume : mesh.volume) element_size_.push_back(element_size<dim>(volume));
}

template <int dim>
void FilledGrid<dim>::clear() {
  for (int i = 0; i < node_count_; ++i) compact_node_[mesh_node[i]] = -1;
  for (int c = 0; c < cell_count_; ++c) compact_cell_[mesh_cell[c]] = -1;
  node_count_ = cell_count_ = 0;
}

template <int dim>
int FilledGrid<dim>::enter_node(int node) {
  int &compact = compact_node_[node];
  if (compact < 0) {
    compact = node_count_++;
    mesh_node[compact] = node, mass[compact] = 0, position[compact] = mesh_->position[node];
  }
  return compact;
}

template <int dim>
int FilledGrid<dim>::enter_cell(int cell) {
  int &compact = compact_cell_[cell];
  if (compact < 0) {
    compact = cell_count_++;
    Shape<dim> &s = shape[compact];
    for (int k = 0; k <= dim; ++k) s.node[k] = enter_node(mesh_->cells[cell].node[k]);
    s.gradient = mesh_->cells[cell].gradient, s.volume = mesh_->volume[cell];
    mesh_cell[compact] = cell, mass_matrix[compact] = {}, nodal_share[compact] = {};
    size[compact] = element_size_[cell], patch[compact] = mesh_->patch[cell];
  }
  return compact;
}

template <int dim>
void FilledGrid<dim>::enter_shared_nodes() {
  if (halo_.empty()) return;
  staging_.resize(std::max(staging_.size(), compact_node_.size()));
  for (int node : halo_.shared_nodes()) staging_[node] = compact_node_[node] >= 0;
  (void)halo_.sum(staging_.data(), 1);
  for (int node : halo_.shared_nodes())
    if (staging_[node] > 0) enter_node(node);
}

template <int dim>
PetscErrorCode FilledGrid<dim>::sum(double *values, int width) {
  PetscFunctionBeginUser;
  if (halo_.empty()) PetscFunctionReturn(0);
  staging_.resize(std::max(staging_.size(), compact_node_.size() * width));  // once for the widest sum
  for (int node : halo_.shared_nodes())
    for (int k = 0; k < width; ++k)
      staging_[node * width + k] = compact_node_[node] < 0 ? 0 : values[compact_node_[node] * width + k];
  PetscCall(halo_.sum(staging_.data(), width));
  for (int node : halo_.shared_nodes())
    if (compact_node_[node] >= 0)
      std::copy_n(&staging_[node * width], width, &values[compact_node_[node] * width]);
  PetscFunctionReturn(0);
}

template <int dim>
void FilledGrid<dim>::keep(Archive &archive) {
  if (archive.reading()) clear();
  archive.keep("grid", node_count_, cell_count_, mesh_node, mass, position, mesh_cell, shape, mass_matrix, nodal_share, size, patch);
  for (int i = 0; i < node_count(); ++i) compact_node_[mesh_node[i]] = i;
  for (int c = 0; c < cell_count(); ++c) compact_cell_[mesh_cell[c]] = c;
}

template class FilledGrid<2>;
template class FilledGrid<3>;

}  // namespace talus
