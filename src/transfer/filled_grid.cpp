#include "transfer/filled_grid.h"

#include <algorithm>
#include <cmath>

#include "base/local_numbers.h"
#include "base/room.h"

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
FilledGrid<dim>::FilledGrid(const BackgroundMesh<dim> &mesh) : mesh_(&mesh), halo_(mesh.halo), ties_(mesh.ties) {
  const int nodes = mesh.node_count(), cells = mesh.cell_count();
  make_room(compact_node_, nodes), make_room(compact_cell_, cells);
  make_room(mesh_node, nodes), make_room(mass, nodes), make_room(position, nodes);
  make_room(mesh_cell, cells), make_room(shape, cells), make_room(mass_matrix, cells), make_room(nodal_share, cells);
  make_room(size, cells), make_room(patch, cells), make_room(element_size_, cells);
}

template <int dim>
double FilledGrid<dim>::element_size_of(int mesh_cell) {
  double &size = element_size_[mesh_cell];
  if (size == 0) size = element_size<dim>(mesh_->volume[mesh_cell]);
  return size;
}

template <int dim>
void FilledGrid<dim>::clear() {
  for (int i = 0; i < node_count_; ++i) compact_node_[mesh_node[i]] = 0;
  for (int c = 0; c < cell_count_; ++c) compact_cell_[mesh_cell[c]] = 0;
  node_count_ = cell_count_ = 0;
}

template <int dim>
void FilledGrid<dim>::complete() {
  if (!halo_.empty()) {
    staging_.resize(std::max(staging_.size(), compact_node_.size()));
    for (int node : halo_.shared_nodes()) staging_[node] = find_node(node) >= 0;
    (void)halo_.sum(staging_.data(), 1);
    for (int node : halo_.shared_nodes())
      if (staging_[node] > 0) enter_node(node);
  }
  if (!ties_.empty()) {
    staging_.resize(std::max(staging_.size(), compact_node_.size()));
    for (const int node : ties_.nodes()) staging_[node] = find_node(node) >= 0;
    ties_.find_places([](int node) { return node; });
    (void)ties_.sum(staging_.data(), 1);
    for (const int node : ties_.nodes())
      if (staging_[node] > 0) enter_node(node);
    find_ties();
  }
  for (int i = 0; i < node_count_; ++i) mass[i] = 0, position[i] = mesh_->position[mesh_node[i]];
  for (int c = 0; c < cell_count_; ++c) {
    const int cell = mesh_cell[c];
    shape[c].volume = mesh_->volume[cell], size[c] = element_size_of(cell), patch[c] = mesh_->patch[cell];
  }
}

template <int dim>
PetscErrorCode FilledGrid<dim>::sum(double *values, int width) {
  PetscFunctionBeginUser;
  if (!halo_.empty()) {
    staging_.resize(std::max(staging_.size(), compact_node_.size() * width));  // once for the widest sum
    for (int node : halo_.shared_nodes())
      for (int k = 0; k < width; ++k)
        staging_[node * width + k] = find_node(node) < 0 ? 0 : values[find_node(node) * width + k];
    PetscCall(halo_.sum(staging_.data(), width));
    for (int node : halo_.shared_nodes())
      if (find_node(node) >= 0) std::copy_n(&staging_[node * width], width, &values[find_node(node) * width]);
  }
  PetscCall(ties_.sum(values, width));
  PetscFunctionReturn(0);
}

template <int dim>
typename FilledGrid<dim>::Rows FilledGrid<dim>::serialize(Archive &archive) {
  const BackgroundMesh<dim> &mesh = *mesh_;
  std::vector<long long> nodes, cells;
  for (int i = 0; i < node_count_; ++i) nodes.push_back(mesh.global_node[mesh_node[i]]);
  for (int c = 0; c < cell_count_; ++c) cells.push_back(mesh.global_cell[mesh_cell[c]]);
  const Rows rows{archive.rows("nodes of the grid", Belongs::to_points, nodes),
                  archive.rows("cells of the grid", Belongs::to_cells, cells)};
  if (archive.reading()) {
    clear();
    const LocalNumbers node_of(mesh.global_node), cell_of(mesh.global_cell);
    for (const long long number : nodes) enter_node(node_of(number));
    find_ties();
    for (const long long number : cells) {
      const int cell = cell_of(number);
      mesh_cell[cell_count_] = cell, compact_cell_[cell] = ++cell_count_;
    }
  }
  archive.column(rows.nodes, "mass", mass);
  archive.column(rows.nodes, "position", position);
  std::vector<double> figures;  // of the shapes, without their node numbers, which are those of this partition
  for (int c = 0; c < cell_count_ && !archive.reading(); ++c) {
    for (const Vec<dim> &gradient : shape[c].gradient) figures.insert(figures.end(), gradient.begin(), gradient.end());
    figures.push_back(shape[c].volume);
  }
  archive.column(rows.cells, "shape", figures, dim * dim + 1);
  archive.column(rows.cells, "mass matrix", mass_matrix);
  archive.column(rows.cells, "nodal share", nodal_share);
  if (archive.reading())
    for (int c = 0; c < cell_count_; ++c) {
      const int cell = mesh_cell[c];
      const double *figure = &figures[c * (dim * dim + 1)];
      for (Vec<dim> &gradient : shape[c].gradient) std::copy_n(figure, dim, gradient.begin()), figure += dim;
      shape[c].volume = *figure;
      for (int k = 0; k <= dim; ++k) shape[c].node[k] = find_node(mesh.cells[cell].node[k]);
      size[c] = element_size_of(cell), patch[c] = mesh.patch[cell];
    }
  return rows;
}

template class FilledGrid<2>;
template class FilledGrid<3>;

}  // namespace talus
