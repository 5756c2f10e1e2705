// Mass fluxes between cells; theory of pores, (4.7) to (4.9); included only where PoreFluid is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"

namespace talus {

/// Gas flows with the density of the cells that it comes from, and none leaves cells that have only their residual gas,
/// theory (4.9). A cell may be much thinner in gas than those beside it: what nodes take out of it is therefore found
/// with the density with which they take. Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::gas_flux(const Frame &frame, const Vec<dim> *gas,
                                                const Vec<dim> *solid) requires Phases::gas {
  PetscFunctionBeginUser;
  constexpr int width = 2;  // of a node: volume and mass taken
  constexpr double empty = 1e-300;
  FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count(), cells = grid.cell_count();
  double *taken = nodal_.data(), *density = taken + width * nodes, *resistance = density + nodes;
  double *through_gap = gap_flux_[1].data();
  for (int i = 0; i < nodes; ++i) {
    double sum = 0;
    for (int d = 0; d < dim; ++d) {
      const double against = gas[i][d] - solid[i][d];
      flux_[1][i][d] = against, sum += gap_[i][d] * against;
    }
    through_gap[i] = sum;
  }
  std::fill_n(taken, width * nodes, 0.);
  for (int c = 0; c < cells; ++c) {
    const Shape<dim> &shape = grid.shape[c];
    const double mass = cells_[c].density[1];
    Vec<dim> first{};
    for (int k = dim; k >= 0; --k) {
      if (k)
        for (int d = 0; d < dim; ++d) first[d] -= shape.gradient[k - 1][d];
      const Vec<dim> &g = k ? shape.gradient[k - 1] : first;
      const int i = shape.node[k];
      // the volume that the node takes from the cell, if its pores were full of gas
      const double towards = dot<dim>(g, flux_[1][i]) - reference_[c][k] * through_gap[i];
      const double volume = frame.weight[c] * std::max(0., towards);
      uptake_[c][k] = volume;
      taken[i * width] += volume, taken[i * width + 1] += volume * mass;
    }
  }
  PetscCall(grid.sum(taken, width));
  for (int i = 0; i < nodes; ++i) {
    const double volume = taken[i * width], share = nodes_[i].whole(1) > 0 ? nodes_[i].mass(1) / nodes_[i].whole(1) : 0;
    density[i] = share * (volume > 0 ? taken[i * width + 1] / volume : gas_.density), resistance[i] = 0;
  }
  for (int c = 0; c < cells; ++c) {
    const auto &node = grid.shape[c].node;
    const CellPores &cell = cells_[c];
    const auto &volume = uptake_[c];
    double out = 0;  // mass
    for (int k = 0; k <= dim; ++k) out += volume[k] * density[node[k]];
    if (!(out > 0)) continue;
    const double free = 1 - residual_gas / std::max(1 - cell.saturation, empty);  // share of the gas that may leave
    const double open =
        std::clamp(std::min(free / residual_gas * (1 - cell.saturation), free * cell.mass[1] / (2 * out)), empty, 1.);
    for (int k = 0; k <= dim; ++k) resistance[node[k]] += volume[k] > 0 ? 1 / open - 1 : 0;
  }
  PetscCall(grid.sum(resistance, 1));
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < dim; ++d) flux_[1][i][d] *= prescribed ? 0 : density[i] / (1 + resistance[i]);
  PetscFunctionReturn(0);
}

/// What the gas does against the skeleton comes back from particles as momentum does at a remap: with the masses of the
/// gas. With those of the grains it would gain energy where saturation varies from cell to cell, theory (4.7a).
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::gas_to_particles_and_back(FilledGrid<dim> &grid, const Vec<dim> *in,
                                                                 Vec<dim> *out) requires Phases::gas {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  const Vec<dim> *gas = in + 2 * nodes;
  Vec<dim> *mapped = out + 2 * nodes;
  std::fill_n(mapped, nodes, Vec<dim>{});
  for (int c = 0; c < grid.cell_count(); ++c) {
    const auto &node = grid.shape[c].node;
    const auto &matrix = grid.mass_matrix[c];
    const Quad share = quad(cells_[c].mass[1] / grain_mass_[c]);
    Quad v[dim + 1], sum[dim + 1];
    for (int k = 0; k <= dim; ++k)
      v[k] = load<dim>(gas[node[k]].data()) - load<dim>(in[node[k]].data()), sum[k] = quad(matrix[k]) * v[k];
    for (int k = 0, pair = dim + 1; k <= dim; ++k)
      for (int l = k + 1; l <= dim; ++l, ++pair)
        sum[k] += quad(matrix[pair]) * v[l], sum[l] += quad(matrix[pair]) * v[k];
    for (int k = 0; k <= dim; ++k) {
      double *x = mapped[node[k]].data();
      talus::store<dim>(x, load<dim>(x) + share * sum[k]);
    }
  }
  PetscCall(grid.sum(mapped[0].data(), dim));
  for (int i = 0; i < nodes; ++i) {
    const double mass = nodes_[i].mass(1), scale = mass > 0 ? 1 / mass : 0;
    for (int d = 0; d < dim; ++d) mapped[i][d] = out[i][d] + scale * mapped[i][d];
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::find_gaps(const Frame &frame, const PoreConditions<dim> &conditions) {
  std::fill_n(gap_.begin(), frame.grid.node_count(), Vec<dim>{});
  conditions.gaps(
      frame.grid, [&](int i) { return surface_at(nodes_[i]); },
      [&](int i, const Vec<dim> &area) {
        for (int d = 0; d < dim; ++d) gap_[i][d] = area[d] / nodes_[i].volume();
      });
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::find_divergence(const Frame &frame, const PoreConditions<dim> &conditions,
                                                       const Vec<dim> *u) {
  PetscFunctionBeginUser;
  const FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count(), cells = grid.cell_count();
  find_gaps(frame, conditions);
  for (int i = 0; i < nodes; ++i) {
    const double density = prescribed ? 0 : nodes_[i].volume() > 0 ? nodes_[i].mass(0) / nodes_[i].volume() : 0;
    for (int d = 0; d < dim; ++d) flux_[0][i][d] = density * (u[nodes + i][d] - u[i][d]);
  }
  if constexpr (Phases::gas) PetscCall(gas_flux(frame, u + 2 * nodes, u));
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i) {
      double out = 0, gap_flux = 0;
      for (int d = 0; d < dim; ++d)
        out += flux_[a][i][d] * nodes_[i].geometry[d], gap_flux += flux_[a][i][d] * gap_[i][d];
      gap_flux_[a][i] = gap_flux;
      if (!frame.trial && mesh_.counted[grid.mesh_node[i]]) out_[a] += out - gap_flux * nodes_[i].volume();
    }
  for (int c = 0; c < cells; ++c) {
    const Shape<dim> &shape = grid.shape[c];
    for (int a = 0; a < fluids; ++a) {
      double sum = 0;
      for (int k = 0; k < dim; ++k)
        for (int d = 0; d < dim; ++d)
          sum += shape.gradient[k][d] * (flux_[a][shape.node[k + 1]][d] - flux_[a][shape.node[0]][d]);
      divergence_[a][c] = sum;
    }
  }
  for (const auto &[i, c, k] : conditions.gap_cells())
    for (int a = 0; a < fluids; ++a) divergence_[a][c] -= reference_[c][k] * gap_flux_[a][i];
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::smooth_divergence(const Frame &frame, Array &volume_strain) {
  PetscFunctionBeginUser;
  if (implicit_) {
    PetscCall(smooth<1>(frame, {volume_strain.data()}));
    if constexpr (Phases::suction)
      PetscCall(share_divergence(frame, divergence_[0]));
    else
      for (int c = 0; c < frame.grid.cell_count(); ++c) divergence_[0][c] *= frame.weight[c];
    PetscCall(spread_divergence(frame, divergence_[0]));
    PetscFunctionReturn(0);
  }
  PetscCall(smooth<2>(
      frame, {volume_strain.data(), divergence_[0].data()}));  // gas moves by its own pressure, which is not smoothed
  const int cells = frame.grid.cell_count();
  for (int a = Phases::suction; a < fluids; ++a)
    for (int c = 0; c < cells; ++c) divergence_[a][c] *= frame.weight[c];
  if constexpr (Phases::suction) PetscCall(share_divergence(frame, divergence_[0]));
  PetscFunctionReturn(0);
}

/// Where pressure is implicit in time, nodes give what comes to them from full cells to these in proportion to the
/// volumes of their particles: so it strains the pores of all full cells of a node alike, theory (8.4). Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::spread_divergence(const Frame &frame, Array &outflow) {
  PetscFunctionBeginUser;
  const int nodes = frame.grid.node_count(), cells = frame.grid.cell_count();
  std::fill_n(nodal_.begin(), 2 * nodes, 0.);
  for (int c = 0; c < cells; ++c) {
    if (!smoothed(c)) continue;
    for (int i : frame.shape[c].node) nodal_[2 * i] += frame.particle_volume[c], nodal_[2 * i + 1] += outflow[c];
  }
  PetscCall(frame.grid.sum(nodal_.data(), 2));
  for (int i = 0; i < nodes; ++i) nodal_[2 * i + 1] /= std::max(nodal_[2 * i] * (dim + 1), 1e-300);
  for (int c = 0; c < cells; ++c) {
    if (!smoothed(c)) continue;
    double sum = 0;
    for (int i : frame.shape[c].node) sum += nodal_[2 * i + 1];
    outflow[c] = frame.particle_volume[c] * sum;
  }
  PetscFunctionReturn(0);
}

/// A cell takes up the liquid that belongs to the volume of its particles. The rest, which belongs to its integration
/// volume beyond that, is distributed over the cells around it in proportion to their particle volumes, theory (4.8a):
/// so contents stay even where particles are spread unevenly over the cells of a front. Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::share_divergence(const Frame &frame,
                                                        Array &divergence) requires Phases::suction {
  PetscFunctionBeginUser;
  const int cells = frame.grid.cell_count();
  std::fill_n(nodal_.begin(), frame.grid.node_count() * 2, 0.);
  for (int c = 0; c < cells; ++c)
    for (int i : frame.shape[c].node)
      nodal_[i * 2] += frame.particle_volume[c], nodal_[i * 2 + 1] += volume_beyond_particles(frame, c) * divergence[c];
  PetscCall(frame.grid.sum(nodal_.data(), 2));
  for (int i = 0; i < frame.grid.node_count(); ++i) nodal_[i * 2 + 1] /= nodal_[i * 2];
  for (int c = 0; c < cells; ++c) {
    double from_nodes = 0;
    for (int i : frame.shape[c].node) from_nodes += nodal_[i * 2 + 1];
    divergence[c] = (frame.weight[c] - volume_beyond_particles(frame, c)) * divergence[c] +
                    frame.particle_volume[c] / (dim + 1) * from_nodes;
  }
  PetscFunctionReturn(0);
}

/// The adjoint of share_divergence: a cell has the pressure of its particles over their volume, and the pressure of the
/// cells around it over the rest of its integration volume. Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::share_pressure(const Frame &frame, Array &pressure) requires Phases::suction {
  PetscFunctionBeginUser;
  const int cells = frame.grid.cell_count();
  std::fill_n(nodal_.begin(), frame.grid.node_count() * 2, 0.);
  for (int c = 0; c < cells; ++c)
    for (int i : frame.shape[c].node)
      nodal_[i * 2] += frame.particle_volume[c], nodal_[i * 2 + 1] += frame.particle_volume[c] * pressure[c];
  PetscCall(frame.grid.sum(nodal_.data(), 2));
  for (int i = 0; i < frame.grid.node_count(); ++i) nodal_[i * 2 + 1] /= nodal_[i * 2] * (dim + 1);
  for (int c = 0; c < cells; ++c) {
    double around = 0;
    for (int i : frame.shape[c].node) around += nodal_[i * 2 + 1];
    pressure[c] += volume_beyond_particles(frame, c) / frame.weight[c] * (around - pressure[c]);
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::change_masses(const Frame &frame) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PorePoints &from = points_[b];
    PorePoints &to = frame.trial ? trial_[b] : points_[b];
    const PointSet &set = frame.points[b];
    if (frame.trial) to.reserve(set.count), std::copy_n(from.share.begin(), set.count, to.share.begin());
    for (int q = 0; q < set.count; ++q) {
      const double part = frame.volume[b][q] / frame.particle_volume[set.cell[q]];
      for (int a = 0; a < fluids; ++a) to.mass[a][q] = from.mass[a][q] - part * divergence_[a][set.cell[q]];
    }
  }
  if (by_rate_) set_masses_by_rate(frame);
}

// The naive form of storage, theory (3.5): pressures are integrated by their rate from those of the last step, and the
// masses are replaced by what the retention curve gives for them.

template <int dim, class Phases>
void PoreFluid<dim, Phases>::save_pressures(const Frame &frame) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PorePoints &points = points_[b];
    points.pressure.resize(points.grains.size());
    for (int q = 0; q < frame.points[b].count; ++q)
      points.pressure[q] =
          points.suction[q] > 0
              ? -points.suction[q]
              : liquid_.pressure_at(points.mass[0][q] / pore_volume(frame.volume[b][q], points.grains[q]));
  }
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::set_masses_by_rate(const Frame &frame) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PorePoints &points = points_[b];
    for (int q = 0; q < frame.points[b].count; ++q) {
      const double pores = pore_volume(frame.volume[b][q], points.grains[q]);
      points.mass[0][q] = pores * content_by_rate(soils_[b], liquid_, points.pressure[q], points.mass[0][q] / pores);
    }
  }
}

}  // namespace talus
