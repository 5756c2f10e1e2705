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
void FilledGrid<dim>::complete() {
  if (!halo_.empty()) {
    staging_.resize(std::max(staging_.size(), compact_node_.size()));
    for (int node : halo_.shared_nodes()) staging_[node] = compact_node_[node] >= 0;
    (void)halo_.sum(staging_.data(), 1);
    for (int node : halo_.shared_nodes())
      if (staging_[node] > 0) enter_node(node);
  }
  for (int i = 0; i < node_count_; ++i) mass[i] = 0, position[i] = mesh_->position[mesh_node[i]];
  for (int c = 0; c < cell_count_; ++c) {
    const Cell<dim> &cell = mesh_->cells[mesh_cell[c]];
    Shape<dim> &s = shape[c];
    for (int k = 0; k <= dim; ++k) s.node[k] = compact_node_[cell.node[k]];
    s.gradient = cell.gradient, s.volume = mesh_->volume[mesh_cell[c]];
  }
  for (int c = 0; c < cell_count_; ++c) size[c] = element_size_[mesh_cell[c]], patch[c] = mesh_->patch[mesh_cell[c]];
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
    if (compact_node_[node] >= 0) std::copy_n(&staging_[node * width], width, &values[compact_node_[node] * width]);
  PetscFunctionReturn(0);
}

template <int dim>
void FilledGrid<dim>::serialize(Archive &archive) {
  if (archive.reading()) clear();
  archive.serialize("grid", node_count_, cell_count_, mesh_node, mass, position, mesh_cell, shape, mass_matrix,
                    nodal_share, size, patch);
  for (int i = 0; i < node_count(); ++i) compact_node_[mesh_node[i]] = i;
  for (int c = 0; c < cell_count(); ++c) compact_cell_[mesh_cell[c]] = c;
}

template class FilledGrid<2>;
template class FilledGrid<3>;

}  // namespace talus
