#include "physics/soil_motion/cell_filling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/room.h"
#include "scene/transfer_source.h"

namespace talus {

template <int dim>
CellFilling<dim>::CellFilling(int cells) {
  for (auto *field : {&blend, &share, &slenderness}) make_room(*field, cells);
  make_room(impedance, cells);
}

template <int dim>
void CellFilling<dim>::find(const FilledGrid<dim> &grid, Integration integration, const double *nodal, int stride,
                            SoilState<dim> &accepted) {
  constexpr double ramp_start = dim == 2 ? 0.7 : 0.6, ramp_length = 0.2, full = 0.9;
  const std::vector<double> &nodal_volume = grid.mesh().nodal_volume;
  for (int c = 0; c < grid.cell_count(); ++c) {
    const Shape<dim> &shape = grid.shape[c];
    double volume = 0, filling = 1e300;
    for (double part : grid.nodal_share[c]) volume += part;
    for (int i : shape.node) filling = std::min(filling, nodal[i * stride] / nodal_volume[grid.mesh_node[i]]);
    switch (integration) {
      case Integration::blended:
        blend[c] = std::clamp((filling - ramp_start) / ramp_length, 0., 1.);
        break;
      case Integration::mixed:
        blend[c] = filling > 0.5 && volume > full * shape.volume;
        break;
      case Integration::cell:
        blend[c] = filling > 0.5;
        break;
      case Integration::particle:
        blend[c] = 0;
        break;
    }
    accepted.particle_volume[c] = volume;
    accepted.weight[c] = volume + blend[c] * (shape.volume - volume);
    share[c] = accepted.weight[c] / shape.volume;
    slenderness[c] = 0;
    for (const auto &g : shape.gradient)
      for (double x : g) slenderness[c] += x * x;
  }
  find_divided(grid);
  divide_cells(accepted);
  for (const DividedCell &one : divided) share[one.cell] = accepted.weight[one.cell] / grid.shape[one.cell].volume;
}

template <int dim>
void CellFilling<dim>::find_divided(const FilledGrid<dim> &grid) {
  divided.clear();
  const BackgroundMesh<dim> &mesh = grid.mesh();
  const int cells = mesh.cells_in_sheet();
  if (mesh.sheet_count() == 1) return;
  const auto volume_in = [&](int c) {
    return std::accumulate(grid.nodal_share[c].begin(), grid.nodal_share[c].end(), 0.);
  };
  for (int c = 0; c < grid.cell_count(); ++c) {
    double all = 0;
    int met = 0;
    for (int copy = grid.mesh_cell[c] % cells; copy < mesh.cell_count(); copy += cells)
      if (const int other = grid.find_cell(copy); other >= 0) all += volume_in(other), ++met;
    if (met > 1) divided.push_back({c, volume_in(c) / all});
  }
}

template <int dim>
void CellFilling<dim>::measure_impedance(const FilledGrid<dim> &grid,
                                         const std::vector<std::unique_ptr<Body<dim>>> &bodies,
                                         const std::vector<PointSet> &points, const SoilState<dim> &accepted) {
  for (int c = 0; c < grid.cell_count(); ++c) impedance[c] = {0, 0};
  for (size_t b = 0; b < bodies.size(); ++b) {
    const double wave = constrained_modulus(bodies[b]->law()), shear = shear_modulus(bodies[b]->law());
    for (int q = 0; q < points[b].count; ++q) {
      const int c = points[b].cell[q];
      double m = 0;
      for (int k = 0; k < simplex_pairs<dim>; ++k) m += (k <= dim ? 1 : 2) * grid.mass_matrix[c][k];
      const double density = m / accepted.particle_volume[c],
                   of_point = points[b].volume[q] / accepted.particle_volume[c];
      impedance[c][0] += of_point * std::sqrt(density * wave), impedance[c][1] += of_point * std::sqrt(density * shear);
    }
  }
}

template <int dim>
void CellFilling<dim>::serialize(Archive &archive, const Archive::Rows &cells) {
  archive.column(cells, "blend", blend);
  archive.column(cells, "filling", share);
  archive.column(cells, "slenderness", slenderness);
  archive.column(cells, "impedance", impedance);
}

template struct CellFilling<2>;
template struct CellFilling<3>;

}  // namespace talus
