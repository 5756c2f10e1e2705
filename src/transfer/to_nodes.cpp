#include "transfer/transfer.h"

namespace talus {

template <int dim, bool averaged, bool apic>
void to_nodes(const Body<dim> &body, FilledGrid<dim> &grid, Vec<dim> *momentum, PointSet &points) {
  constexpr int vertices = dim + 1, components = stress_size<dim>;
  const ParticleArrays<dim> &p = body.particles();
  const int history_count = body.history_count();
  const BackgroundMesh<dim> &mesh = grid.mesh();
  for (int i = 0; i < p.count;) {
    const int mesh_cell = p.cell[i], cell = grid.enter_cell(mesh_cell);
    const BarycentricMap<dim> coordinates(mesh.cells[mesh_cell]);
    Quad mass[vertices]{}, impulse[dim]{}, share{};
    [[maybe_unused]] double stress[components]{}, limit = 0;
    int point = -1;
    if constexpr (averaged) {
      point = points.of_cell[mesh_cell];
      if (point < 0) {
        point = points.of_cell[mesh_cell] = points.count++;
        points.own_cell[point] = cell, points.own_volume[point] = points.own_limit[point] = 0;
        std::fill_n(&points.own_stress[point * components], components, 0.);
        std::fill_n(points.own_history.data() + point * history_count, history_count, 0.);
      }
    }
    double *history = averaged ? points.own_history.data() + point * history_count : nullptr;
    for (; i < p.count && p.cell[i] == mesh_cell; ++i) {
      const Quad n = coordinates(p.position[i]), mn = quad(p.mass[i]) * n;
      for (int k = 0; k < vertices; ++k) mass[k] += quad(n[k]) * mn;
      for (int d = 0; d < dim; ++d) {
        Quad v = quad(p.velocity[i][d]);
        if constexpr (apic) {  // velocity the affine field has at each vertex
          const double *c = &p.affine[(i * dim + d) * dim];
          for (int e = 0; e < dim; ++e) {
            Quad x{};
            for (int k = 0; k < vertices; ++k) x[k] = mesh.position[mesh.cells[mesh_cell].node[k]][e];
            v += quad(c[e]) * (x - quad(p.position[i][e]));
          }
        }
        impulse[d] += v * mn;
      }
      share += quad(p.volume[i]) * n;
      if constexpr (averaged) {
        for (int s = 0; s < components; ++s) stress[s] += p.volume[i] * p.stress[i * components + s];
        for (int h = 0; h < history_count; ++h) history[h] += p.volume[i] * p.history[i * history_count + h];
        limit += p.initial_volume[i];
      } else {
        points.own_cell[i] = cell;
      }
    }
    auto &matrix = grid.mass_matrix[cell];
    for (int k = 0, pair = vertices; k < vertices; ++k) {
      matrix[k] += mass[k][k];
      for (int l = k + 1; l < vertices; ++l) matrix[pair++] += mass[k][l];
    }
    double volume = 0;
    for (int k = 0; k < vertices; ++k) {
      Vec<dim> &sum = momentum[grid.shape[cell].node[k]];
      for (int d = 0; d < dim; ++d) sum[d] += impulse[d][k];
      grid.nodal_share[cell][k] += share[k];
      volume += share[k];
    }
    if constexpr (averaged) {
      points.own_volume[point] += volume, points.own_limit[point] += limit;
      for (int s = 0; s < components; ++s) points.own_stress[point * components + s] += stress[s];
    }
  }
  if constexpr (averaged) {
    for (int q = 0; q < points.count; ++q) {
      const double scale = 1 / points.own_volume[q];
      for (int s = 0; s < components; ++s) points.own_stress[q * components + s] *= scale;
      for (int h = 0; h < history_count; ++h) points.own_history[q * history_count + h] *= scale;
    }
    std::copy_n(points.own_history.begin(), points.count * history_count, points.start_history.begin());
    std::copy_n(points.own_volume.begin(), points.count, points.start_volume.begin());
  }
}

#define TALUS_TO_NODES(dim, averaged, apic) \
  template void to_nodes<dim, averaged, apic>(const Body<dim> &, FilledGrid<dim> &, Vec<dim> *, PointSet &);
TALUS_TO_NODES(2, true, true)
TALUS_TO_NODES(2, true, false)
TALUS_TO_NODES(2, false, true)
TALUS_TO_NODES(2, false, false)
TALUS_TO_NODES(3, true, true)
TALUS_TO_NODES(3, true, false)
TALUS_TO_NODES(3, false, true)
TALUS_TO_NODES(3, false, false)

}  // namespace talus
