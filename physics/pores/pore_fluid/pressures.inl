// Pressures from masses, and their sums over cells and nodes; theory of pores, (3.1) to (3.3), (4.2), (4.3); included
// only where PoreFluid is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"

namespace talus {

template <int dim, class Phases>
double PoreFluid<dim, Phases>::mixture_pressure(const double *p, double saturation) const {
  if constexpr (Phases::gas)
    return bishop_ ? saturation * p[0] + (1 - saturation) * p[1] : std::max(p[0], p[1]);
  else if constexpr (Phases::suction)
    return bishop_ ? saturation * p[0] : std::max(0., p[0]);  // gas at zero gauge pressure
  else
    return p[0];
}

template <int dim, class Phases>
Vec<dim> PoreFluid<dim, Phases>::place(const Frame &frame, int c, const std::array<double, dim + 1> &n) const {
  Vec<dim> x{};
  for (int k = 0; k <= dim; ++k)
    for (int d = 0; d < dim; ++d) x[d] += n[k] * frame.position[frame.shape[c].node[k]][d];
  return x;
}

/// Gives the points the masses that belong to the prescribed pressures, in stages in which fluids do not move.
template <int dim, class Phases>
void PoreFluid<dim, Phases>::set_prescribed_pressures(const Frame &frame) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PorePoints &points = frame.trial ? trial_[b] : points_[b];
    for (int q = 0; q < frame.points[b].count; ++q) {
      const int c = frame.points[b].cell[q];
      const Vec<dim> x = place(frame, c, mean_[c]);
      const double pores = pore_volume(frame.volume[b][q], points_[b].grains[q]);
      const auto content = contents(soils_[b], prescribed_ramp * prescribed_pressure(x, frame.time),
                                    prescribed_ramp * prescribed_gas_pressure(x));
      for (int a = 0; a < fluids; ++a) {
        if (!frame.trial) prescribed_mass_[a] += content[a] * pores - points.mass[a][q];
        points.mass[a][q] = content[a] * pores;
      }
      points.share[q] = content[2];
    }
  }
}

/// Pressures of points from their masses, and their means over cells, theory (3.1)-(3.3), (4.2).
template <int dim, class Phases>
void PoreFluid<dim, Phases>::find_pressures(const Frame &frame) {
  constexpr int lanes = 8;
  std::vector<CellPores> &cells = frame.trial ? trial_cells_ : cells_;
  if (frame.trial) cells.resize(cells_.size());
  std::fill_n(cells.begin(), frame.grid.cell_count(), CellPores{});
  if (prescribed) set_prescribed_pressures(frame);
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PorePoints &accepted = points_[b];
    PorePoints &points = frame.trial ? trial_[b] : points_[b];
    const PointSet &set = frame.points[b];
    const SoilPores &soil = soils_[b];
    const double permeability = soil.permeability() / liquid_.viscosity;
    for (int first = 0; first < set.count; first += lanes) {
      const int count = std::min(lanes, set.count - first);
      PoreLanes<lanes> p;
      double volume[lanes], k[lanes], k_l[lanes], k_g[lanes];
      for (int i = 0; i < lanes; ++i) {
        const int q = first + std::min(i, count - 1);  // the last point fills a last block
        volume[i] = frame.volume[b][q];
        const double pores = pore_volume(volume[i], accepted.grains[q]);
        k[i] = soil.change(pores / volume[i]);
        p.gas_share[i] = Phases::suction ? points.share[q] : 0;
        p.liquid_content[i] = points.mass[0][q] / pores;
        if constexpr (Phases::gas) p.gas_content[i] = points.mass[1][q] / pores;
      }
      if constexpr (Phases::gas)
        three_phase_pressures(soil, liquid_, gas_, p);
      else if constexpr (Phases::suction)
        unsaturated_pressures(soil, liquid_, p);
      else
        saturated_pressures(liquid_, p);
      if constexpr (Phases::suction) {
#pragma omp simd
        for (int i = 0; i < lanes; ++i) {
          const SoilPores::State state = soil.at(p.gas_share[i]);
          constexpr double least_gas = 1e-6;  // trapped gas creeps
          k_l[i] = state.liquid, k_g[i] = std::max(state.gas, least_gas);
        }
      }
      for (int i = 0; i < count; ++i) {
        const int q = first + i, c = set.cell[q];
        CellPores &cell = cells[c];
        const double part = volume[i] / frame.particle_volume[c];
        cell.saturation += part * (1 - p.gas_share[i]);
        cell.pressure[0] += part * p.liquid[i], cell.mass[0] += points.mass[0][q];
        cell.saturated += part * k[i] * permeability;
        cell.conductivity[0] += part * k[i] * permeability * (Phases::suction ? k_l[i] : 1);
        cell.density[0] += part * p.liquid_content[i] / (1 - p.gas_share[i]);
        if constexpr (Phases::suction)
          points.share[q] = p.gas_share[i], points.suction[q] = std::max(0., p.gas[i] - p.liquid[i]);
        if constexpr (Phases::gas) {
          cell.pressure[1] += part * p.gas[i], cell.mass[1] += points.mass[1][q];
          cell.conductivity[1] += part * k[i] * soil.gas_permeability() * k_g[i] / gas_.viscosity;
          cell.density[1] += part * gas_.density_at(p.gas[i]);
        }
      }
    }
  }
}

/// Finds the cells of patches in which all pores are nearly full; without patches, the cells with such pores.
template <int dim, class Phases>
void PoreFluid<dim, Phases>::find_smoothed(const Frame &frame) requires Phases::suction {
  const int cells = frame.grid.cell_count();
  for (int c = 0; c < cells; ++c) cells_[c].smoothed = cells_[c].saturation >= nearly_full;
  if (!patches_) return;
  const int *patch = frame.grid.patch.data();
  for (int c = 0; c < cells; ++c) patch_pores_[patch[c]].open = 0;
  for (int c = 0; c < cells; ++c) patch_pores_[patch[c]].open += !cells_[c].smoothed;
  for (int c = 0; c < cells; ++c) cells_[c].smoothed = patch_pores_[patch[c]].open == 0;
}

/// In patches that are not smoothed, the pressure that acts on the skeleton is the mean over the patch, and the weight
/// of the liquid between the middle of the patch and the cell, theory (4.3a): the adjoint of the volume strain that
/// these pores share with the skeleton.
template <int dim, class Phases>
void PoreFluid<dim, Phases>::average_over_patches(const Frame &frame,
                                                  std::vector<CellPores> &pores) requires Phases::suction {
  const int cells = frame.grid.cell_count();
  const int *patch = frame.grid.patch.data();
  const auto head = [&](int c) {  // g . x of the place at which the cell has its pressure
    double sum = 0;
    for (int k = 0; k <= dim; ++k) sum += reference_[c][k] * nodal_head_[frame.shape[c].node[k]];
    return sum;
  };
  for (int c = 0; c < cells; ++c) {
    PatchPores &sum = patch_pores_[patch[c]];
    sum.weight = sum.pressure = sum.head = sum.liquid = 0;
  }
  for (int c = 0; c < cells; ++c) {
    if (smoothed(c)) continue;
    const double w = frame.weight[c], wet = pores[c].saturation;
    PatchPores &sum = patch_pores_[patch[c]];
    sum.weight += w, sum.pressure += w * pores[c].mixture, sum.head += w * head(c);
    sum.liquid += w * (bishop_ ? wet : wet >= nearly_full && pores[c].mixture > 0);
  }
  for (int c = 0; c < cells; ++c) {
    if (smoothed(c)) continue;
    const PatchPores &sum = patch_pores_[patch[c]];
    const double scale = 1 / sum.weight;
    pores[c].mixture = scale * (sum.pressure + sum.liquid * liquid_.density * (head(c) - scale * sum.head));
  }
}

/// Cell to node to cell, weighted, among nearly saturated cells: conservative and its own adjoint, theory (4.3).
/// Collective.
template <int dim, class Phases>
template <int count>
PetscErrorCode PoreFluid<dim, Phases>::smooth(const Frame &frame, const std::array<double *, count> &fields) {
  PetscFunctionBeginUser;
  if (!smoothing_) PetscFunctionReturn(0);
  constexpr int width = count + 1;
  const int cells = frame.grid.cell_count();
  std::fill_n(nodal_.begin(), frame.grid.node_count() * width, 0.);
  for (int c = 0; c < cells; ++c) {
    if (!smoothed(c)) continue;
    const double w = frame.weight[c];
    for (int i : frame.shape[c].node) {
      nodal_[i * width] += w;
      for (int f = 0; f < count; ++f) nodal_[i * width + 1 + f] += w * fields[f][c];
    }
  }
  PetscCall(frame.grid.sum(nodal_.data(), width));
  for (int i = 0; i < frame.grid.node_count(); ++i) {
    const double scale = nodal_[i * width] > 0 ? 1 / (nodal_[i * width] * (dim + 1)) : 0;
    for (int f = 0; f < count; ++f) nodal_[i * width + 1 + f] *= scale;
  }
  for (int c = 0; c < cells; ++c) {
    if (!smoothed(c)) continue;
    for (int f = 0; f < count; ++f) {
      double mean = 0;
      for (int i : frame.shape[c].node) mean += nodal_[i * width + 1 + f];
      fields[f][c] = mean;
    }
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::update_pressures(const Frame &frame) {
  PetscFunctionBeginUser;
  const int nodes = frame.grid.node_count(), cells = frame.grid.cell_count();
  find_pressures(frame);
  if (by_rate_) save_pressures(frame);
  if constexpr (Phases::suction)
    if (!frame.trial) find_smoothed(frame);
  std::vector<CellPores> &pores = frame.trial ? trial_cells_ : cells_;
  for (int i = 0; i < nodes; ++i) {
    nodal_head_[i] = 0;
    for (int d = 0; d < dim; ++d) nodal_head_[i] += frame.filling_gravity[d] * frame.position[i][d];
  }
  const auto head = [&](int c, const std::array<double, dim + 1> &n) {  // g . x
    double sum = 0;
    for (int k = 0; k <= dim; ++k) sum += n[k] * nodal_head_[frame.shape[c].node[k]];
    return sum;
  };
  std::array<double *, fluids> fields;
  for (int a = 0; a < fluids; ++a) fields[a] = smooth_[a].data();
  for (int c = 0; c < cells; ++c) {  // of the liquid, and of the mixture where its pressure is another one
    const double weight = liquid_.density * (head_[c] = head(c, mean_[c]));
    smooth_[0][c] = pores[c].pressure[0] - weight;
    if constexpr (Phases::gas) smooth_[1][c] = mixture_pressure(pores[c].pressure, pores[c].saturation) - weight;
  }
  if constexpr (Phases::suction) PetscCall(share_pressure(frame, smooth_[0]));
  PetscCall(smooth<fluids>(frame, fields));
  for (int c = 0; c < cells; ++c) {
    CellPores &cell = pores[c];
    const double here = head(c, reference_[c]);
    cell.smooth[0] = smooth_[0][c] + liquid_.density * here;
    if constexpr (Phases::gas) cell.smooth[1] = cell.pressure[1] + gas_.density * (here - head_[c]);
    double own[fluids];
    for (int a = 0; a < fluids; ++a)
      own[a] = cell.pressure[a] + (a ? gas_density() : liquid_.density) * (here - head_[c]);
    cell.mixture = mixture_pressure(smoothed(c) ? cell.smooth : own, cell.saturation);
    if constexpr (Phases::gas)
      if (smoothed(c)) {  // suction stays what it was: a pressure that smoothing has changed must not draw gas
        cell.smooth[1] += smooth_[0][c] + liquid_.density * head_[c] - cell.pressure[0];
        cell.mixture = smooth_[1][c] + liquid_.density * here;
      }
  }
  if constexpr (Phases::suction)
    if (patches_) average_over_patches(frame, pores);
  std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  if (frame.trial) at.resize(nodes_.size());
  std::fill_n(at.begin(), nodes, NodePores{});
  for (int c = 0; c < cells; ++c) {
    const CellPores &cell = pores[c];
    const Shape<dim> &shape = frame.shape[c];
    const double w = frame.weight[c], scale = 1 / grain_mass_[c];
    Quad push[sizeof(NodePores::push) / sizeof(Quad)], amount{};
    push[mixture] = quad(cell.mixture), push[mixture][last] = cell.saturated;
    for (int a = 0; a < fluids; ++a) {
      push[a] = quad(cell.smooth[a]), push[a][last] = cell.conductivity[a];
      amount[2 * a] = cell.mass[a] * scale, amount[2 * a + 1] = w * cell.density[a];
    }
    Quad first{};
    for (int k = dim; k >= 0; --k) {
      NodePores &node = at[shape.node[k]];
      Quad weighted = k ? quad(w) * load<dim>(shape.gradient[k - 1].data()) : first;
      first -= weighted;
      const double row = rows_[c][k], part = reference_[c][k];
      weighted[last] = w * part;
      node.geometry += weighted;
      node.amount += amount * Quad{row, part, row, part};
      for (size_t f = 0; f < std::size(push); ++f) node.push[f] += weighted * push[f];
    }
  }
  PetscCall(frame.grid.sum(reinterpret_cast<double *>(at.data()), node_width));
  PetscFunctionReturn(0);
}

}  // namespace talus
