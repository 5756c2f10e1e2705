#include "physics/pores/implicit_pressure.h"

#include <algorithm>

namespace talus {

template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_push(FilledGrid<dim> &grid, const Shape<dim> *shape, const double *weight,
                                                const double *pressure) {
  PetscFunctionBeginUser;
  std::fill_n(push.begin(), grid.node_count(), Vec<dim>{});
  for (int c = 0; c < grid.cell_count(); ++c) {
    const auto &node = shape[c].node;
    double mean = 0;
    for (int i : node) mean += pressure[i];
    mean *= weight[c] / (dim + 1);
    Vec<dim> first{};
    for (int k = 0; k < dim; ++k)
      for (int d = 0; d < dim; ++d) {
        const double f = mean * shape[c].gradient[k][d];
        push[node[k + 1]][d] += f, first[d] -= f;
      }
    add_scaled<dim>(push[node[0]], 1, first);
  }
  PetscCall(grid.sum(push[0].data(), dim));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_beyond_gaps(FilledGrid<dim> &grid, const Shape<dim> *shape,
                                                       const double *weight, const double *pressure) {
  PetscFunctionBeginUser;
  std::fill_n(beyond_gap.begin(), grid.node_count(), 0.);
  for (const GapCorner &corner : gap_corners) {
    double mean = 0;
    for (int i : shape[corner.cell].node) mean += pressure[i] / (dim + 1);
    beyond_gap[corner.node] += weight[corner.cell] * corner.share * mean;
  }
  PetscCall(grid.sum(beyond_gap.data(), 1));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ImplicitPressure<dim>::apply(FilledGrid<dim> &grid, const PrescribedMotion<dim> &supports,
                                            const Shape<dim> *shape, const double *weight, double step, const double *x,
                                            double *y) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  PetscCall(find_push(grid, shape, weight, x));
  PetscCall(find_beyond_gaps(grid, shape, weight, x));
  Vec<dim> *in = after_drag.data(), *out = mapped.data();
  const auto stop_at_walls = [&](Vec<dim> *liquid) {
    for (const Wall &wall : walls) wall.along.take_from(liquid[wall.node]);
  };
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < dim; ++d) {
      const double at_gap = beyond_gap[i] * gap[i][d];
      in[i][d] = solid[i] * push[i][d] + gap_solid[i] * at_gap;
      in[nodes + i][d] = apart[i] * push[i][d] + gap_apart[i] * at_gap;
    }
  for (const auto &p : supports.active())  // where a support holds the skeleton, drag acts against what does not move
    for (int k = 0; k < p.condition->count; ++k) {
      const Vec<dim> &n = p.condition->direction[k];
      Vec<dim> &grains = in[p.node], &liquid = in[nodes + p.node];
      const double on_liquid = dot<dim>(push[p.node], n) - beyond_gap[p.node] * dot<dim>(gap[p.node], n);
      add_scaled<dim>(grains, -dot<dim>(grains, n), n);
      add_scaled<dim>(liquid, supported[p.node] * on_liquid - dot<dim>(liquid, n), n);
    }
  stop_at_walls(in + nodes);
  PetscCall((to_particles_and_back<dim, 2>(grid, in, out)));
  for (const auto &p : supports.active())
    for (int k = 0; k < p.condition->count; ++k) {
      const double speed = dot<dim>(out[p.node], p.condition->direction[k]);
      add_scaled<dim>(out[p.node], -speed, p.condition->direction[k]);
      add_scaled<dim>(out[nodes + p.node], speed, p.condition->direction[k]);
    }
  stop_at_walls(out + nodes);
  std::fill_n(y, nodes, 0.);
  for (const GapCorner &corner : gap_corners) {
    const double flux = porosity[corner.node] * dot<dim>(out[nodes + corner.node], gap[corner.node]);
    for (int i : shape[corner.cell].node) y[i] -= weight[corner.cell] * corner.share / (dim + 1) * flux;
  }
  for (int i = 0; i < nodes; ++i) add_scaled<dim>(out[i], porosity[i], out[nodes + i]);
  for (int c = 0; c < grid.cell_count(); ++c) {
    const auto &node = shape[c].node;
    double divergence = 0;
    for (int k = 0; k < dim; ++k)
      for (int d = 0; d < dim; ++d) divergence += shape[c].gradient[k][d] * (out[node[k + 1]][d] - out[node[0]][d]);
    divergence *= weight[c] / (dim + 1);
    for (int i : node) y[i] += divergence;
  }
  PetscCall(grid.sum(y, 1));
  const double square = step * step;
  for (int i = 0; i < nodes; ++i) y[i] = volume[i] / stiffness[i] * x[i] + square * y[i];
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_diagonal(FilledGrid<dim> &grid, const Shape<dim> *shape,
                                                    const double *weight, double step) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  std::fill_n(diagonal.begin(), nodes, 0.);
  for (int c = 0; c < grid.cell_count(); ++c) {
    const auto &node = shape[c].node;
    const double part = step * weight[c] / (dim + 1);
    Vec<dim> first{};
    double sum = 0;
    const auto add = [&](int i, const Vec<dim> &g) { sum += (solid[i] + porosity[i] * apart[i]) * dot<dim>(g, g); };
    for (int k = 0; k < dim; ++k)
      add_scaled<dim>(first, -1, shape[c].gradient[k]), add(node[k + 1], shape[c].gradient[k]);
    add(node[0], first);
    for (int i : node) diagonal[i] += part * part * sum;
  }
  PetscCall(grid.sum(diagonal.data(), 1));
  for (int i = 0; i < nodes; ++i) diagonal[i] += volume[i] / stiffness[i];
  PetscFunctionReturn(0);
}

template struct ImplicitPressure<2>;
template struct ImplicitPressure<3>;

}  // namespace talus
