#include "physics/pores/open_pores.h"

#include <algorithm>

#include "base/room.h"

namespace talus {

template <int dim>
OpenPores<dim>::OpenPores(bool acts, bool patches, const BackgroundMesh<dim> &mesh) : acts(acts), patches_(patches) {
  if (!acts) return;
  const size_t nodes = mesh.node_count(), cells = mesh.cell_count();
  for (Array *field : {&own_volume, &beyond, &saturation, &full_weight, &pressure_}) make_room(*field, cells);
  for (Array *field : {&patch_weight_, &patch_sum_}) make_room(*field, mesh.patch_count);
  make_room(nodal_, 2 * nodes), make_room(volume_around_, nodes), make_room(open, cells);
  list.reserve(cells);
}

template <int dim>
PetscErrorCode OpenPores<dim>::begin(const StepStart<dim> &at) {
  PetscFunctionBeginUser;
  const int nodes = at.grid.node_count(), cells = at.grid.cell_count();
  list.clear();
  int shares = 0;
  for (int c = 0; c < cells; ++c) {
    full_weight[c] = open[c] ? 0 : at.weight[c];
    if (open[c]) list.push_back(c), shares |= beyond[c] != 0;
  }
  MPI_Allreduce(MPI_IN_PLACE, &shares, 1, MPI_INT, MPI_MAX, at.grid.mesh().comm());
  shares_ = shares > 0;
  if (!shares_) PetscFunctionReturn(0);
  std::fill_n(volume_around_.begin(), nodes, 0.);
  for (int c = 0; c < cells; ++c)
    for (int i : at.shape[c].node) volume_around_[i] += own_volume[c];
  PetscCall(at.grid.sum(volume_around_.data(), 1));
  PetscFunctionReturn(0);
}

template <int dim>
void OpenPores<dim>::take_means_over_patches(const StepStart<dim> &at, double *strain) {
  const int *patch = at.grid.patch.data();
  if (patches_) {
    for (const int c : list) patch_weight_[patch[c]] = patch_sum_[patch[c]] = 0;
    for (const int c : list) patch_weight_[patch[c]] += at.weight[c], patch_sum_[patch[c]] += at.weight[c] * strain[c];
    for (const int c : list) strain[c] = patch_sum_[patch[c]] / patch_weight_[patch[c]];
  }
  for (const int c : list) strain[c] *= saturation[c] * own_volume[c];
}

/// Pressures that push the liquid of all cells, into `pressure_`. Collective.
template <int dim>
PetscErrorCode OpenPores<dim>::find_pressures(const StepStart<dim> &at, const double *nodal, const double *own) {
  PetscFunctionBeginUser;
  if (!shares_) {
    for (const int c : list) pressure_[c] = own[c];
    PetscFunctionReturn(0);
  }
  const int nodes = at.grid.node_count(), cells = at.grid.cell_count();
  std::fill_n(nodal_.begin(), nodes, 0.);
  for (int c = 0; c < cells; ++c) {
    double p = open[c] ? own[c] : 0;
    if (!open[c])
      for (int i : at.shape[c].node) p += nodal[i] / (dim + 1);
    pressure_[c] = p;
    for (int i : at.shape[c].node) nodal_[i] += own_volume[c] * p;
  }
  PetscCall(at.grid.sum(nodal_.data(), 1));
  for (int i = 0; i < nodes; ++i) nodal_[i] /= volume_around_[i] * (dim + 1);
  for (const int c : list) {
    double around = 0;
    for (int i : at.shape[c].node) around += nodal_[i];
    pressure_[c] += beyond[c] / at.weight[c] * (around - pressure_[c]);
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode OpenPores<dim>::add_push(const StepStart<dim> &at, const double *nodal, const double *own,
                                        const double *mixture, const GapCorners &corners, Quad *on_liquid,
                                        Quad *on_mixture) {
  PetscFunctionBeginUser;
  const int *patch = at.grid.patch.data();
  PetscCall(find_pressures(at, nodal, own));
  for (const int c : list) patch_weight_[patch[c]] = patch_sum_[patch[c]] = 0;
  for (const int c : list) patch_weight_[patch[c]] += at.weight[c], patch_sum_[patch[c]] += at.weight[c] * mixture[c];
  for (const int c : list) {
    const Shape<dim> &shape = at.shape[c];
    const Quad liquid = quad(at.weight[c] * pressure_[c]),
               all = quad(at.weight[c] * (patches_ ? patch_sum_[patch[c]] / patch_weight_[patch[c]] : mixture[c]));
    for (int k = 1; k <= dim; ++k) {
      const Quad g = load<dim>(shape.gradient[k - 1].data());
      on_liquid[shape.node[k]] += liquid * g, on_liquid[shape.node[0]] -= liquid * g;
      on_mixture[shape.node[k]] += all * g, on_mixture[shape.node[0]] -= all * g;
    }
  }
  for (const auto &corner : corners)
    if (open[corner.cell])
      on_liquid[corner.node][PressureMatrices<dim>::gap] +=
          at.weight[corner.cell] * corner.share * pressure_[corner.cell];
  PetscFunctionReturn(0);
}

namespace {

/// Divergence in a cell of the velocities of its nodes [1/s].
template <int dim>
double divergence(const Shape<dim> &shape, const Quad *velocity) {
  Quad sum{};
  for (int k = 1; k <= dim; ++k)
    sum += load<dim>(shape.gradient[k - 1].data()) * (velocity[shape.node[k]] - velocity[shape.node[0]]);
  return sum[0] + sum[1] + sum[2];
}

}  // namespace

template <int dim>
void OpenPores<dim>::find_strain(const StepStart<dim> &at, const Quad *solid, double *strained) {
  for (const int c : list) strained[c] = divergence<dim>(at.shape[c], solid);
  take_means_over_patches(at, strained);
}

template <int dim>
PetscErrorCode OpenPores<dim>::find_outflow(const StepStart<dim> &at, const Quad *flux, const GapCorners &corners,
                                            double *lost, double *nodal) {
  PetscFunctionBeginUser;
  for (const int c : list) lost[c] = at.weight[c] * divergence<dim>(at.shape[c], flux);
  for (const auto &corner : corners)
    if (open[corner.cell])
      lost[corner.cell] += at.weight[corner.cell] * corner.share * flux[corner.node][PressureMatrices<dim>::gap];
  if (!shares_) PetscFunctionReturn(0);
  const int nodes = at.grid.node_count(), cells = at.grid.cell_count();
  std::fill_n(nodal_.begin(), nodes, 0.);
  for (const int c : list)
    for (int i : at.shape[c].node) nodal_[i] += beyond[c] / at.weight[c] * lost[c];
  PetscCall(at.grid.sum(nodal_.data(), 1));
  for (int i = 0; i < nodes; ++i) nodal_[i] /= volume_around_[i] * (dim + 1);
  for (int c = 0; c < cells; ++c) {
    double shared = 0;
    for (int i : at.shape[c].node) shared += nodal_[i];
    shared *= own_volume[c];
    if (open[c])
      lost[c] += shared - beyond[c] / at.weight[c] * lost[c];
    else
      for (int i : at.shape[c].node) nodal[i] += shared / (dim + 1);
  }
  PetscFunctionReturn(0);
}

template class OpenPores<2>;
template class OpenPores<3>;

}  // namespace talus
