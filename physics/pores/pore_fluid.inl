// Implementation of PoreFluid; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"

namespace talus {

template <int dim, class Phases>
PoreFluid<dim, Phases>::PoreFluid(const BackgroundMesh<dim> &mesh, std::vector<std::unique_ptr<Body<dim>>> &bodies, const Scene &scene)
    : mesh_(mesh), bodies_(bodies), scene_(scene), liquid_(scene.water), gas_(scene.gas),
      pressure_(scene.water, std::hypot(scene.gravity[0], scene.gravity[1])), bishop_(scene.water.stress == PoreStress::bishop),
      smoothing_(scene.transfer.pore_smoothing == PoreSmoothing::nodal), points_(bodies.size()), trial_(bodies.size()) {
  const size_t nodes = mesh.node_count(), cells = mesh.cell_count();
  const double gravity = std::hypot(scene.gravity[0], scene.gravity[1], dim == 3 ? scene.gravity[dim - 1] : 0);
  constexpr double earth = 9.81;  // [m/s2], for a hydraulic conductivity in a scene without gravity
  for (const auto &body : bodies) soils_.emplace_back(body->source(), scene.water.density * (gravity > 0 ? gravity : earth), scene.water.viscosity);
  cells_.resize(cells), nodes_.resize(nodes), mean_.resize(cells), reference_.resize(cells), rows_.resize(cells), head_.resize(cells);
  flux_.resize(nodes), surface_.resize(nodes), beyond_.assign(nodes, 0), body_of_node_.assign(nodes, 0);
  for (int a = 0; a < fluids; ++a) impulse_[a].resize(cells), divergence_[a].resize(cells), smooth_[a].resize(cells);
  nodal_.resize(nodes * (fluids + 2 > fluids * (dim + 1) ? fluids + 2 : fluids * (dim + 1)));
}

// ---- what pores hold at first ----

template <int dim, class Phases>
double PoreFluid<dim, Phases>::given_pressure(const Vec<dim> &x, double t) const {
  double p = pressure_(x, t);
  if constexpr (Phases::suction)
    if (!pressure_.below_table(x, t)) p -= scene_.water.suction.given() ? scene_.water.suction(x[0], x[1], dim == 3 ? x[dim - 1] : 0, t) : pressure_.above_table(x, t);
  return p;
}

template <int dim, class Phases>
double PoreFluid<dim, Phases>::given_gas_pressure(const Vec<dim> &x) const {
  if constexpr (Phases::gas) return scene_.gas.pressure(x[0], x[1], dim == 3 ? x[dim - 1] : 0, 0);
  return 0;
}

/// Masses per pore volume [kg/m3] and gas share at a liquid pressure under the atmosphere; free gas, and liquid with it, has more by `gas_pressure`.
template <int dim, class Phases>
std::array<double, 3> PoreFluid<dim, Phases>::contents(const SoilPores &soil, double pressure, double gas_pressure) const {
  double share = 0, gas = 0;
  if constexpr (Phases::suction) share = pressure < 0 ? 1 - talus::saturation(soil.retention(), -pressure) : 0;
  if constexpr (Phases::gas) {  // below the water table what is left of the gas is in equilibrium with the water
    const bool trapped = share < residual_gas;
    share = std::max(share, residual_gas);
    gas = share * gas_.density_at(trapped ? std::max(0., pressure + soil.suction(share)) : gas_pressure);
    if (!trapped) pressure += gas_pressure;
  }
  return {(1 - share) * liquid_.density_at(pressure), gas, share};
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::fill(double t) {
  fill([&](int, const Vec<dim> &x) { return given_pressure(x, t); });
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::fill(const std::function<double(int, const Vec<dim> &)> &liquid) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    const double grain_density = bodies_[b]->source().grain_density;
    for (int i = 0; i < p.count; ++i) {
      const auto content = contents(soils_[b], liquid(p.cell[i], p.position[i]), given_gas_pressure(p.position[i]));
      for (int a = 0; a < fluids; ++a) {
        p.fluid_mass[a][i] = content[a] * (p.volume[i] - p.mass[i] / grain_density);
        p.fluid_velocity[a][i] = p.velocity[i];
      }
    }
  }
}

// ---- remap ----

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::gather(const Frame &frame, PoreConditions<dim> &conditions, const Array &filling, const Vec<dim> *solid,
                                              Vec<dim> *velocity) {
  PetscFunctionBeginUser;
  FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count(), cells = grid.cell_count();
  for (int c = 0; c < cells; ++c) {
    const auto &matrix = grid.mass_matrix[c];
    auto &rows = rows_[c];
    for (int k = 0; k <= dim; ++k) rows[k] = matrix[k];
    for (int k = 0, pair = dim + 1; k <= dim; ++k)
      for (int l = k + 1; l <= dim; ++l, ++pair) rows[k] += matrix[pair], rows[l] += matrix[pair];
    for (int a = 0; a < fluids; ++a) impulse_[a][c] = {};
    for (int k = 0; k <= dim; ++k) {
      mean_[c][k] = grid.nodal_share[c][k] / frame.particle_volume[c];
      reference_[c][k] = mean_[c][k] + frame.blend[c] * (1. / (dim + 1) - mean_[c][k]);
    }
    for (int a = 0; a < fluids; ++a) cells_[c].mass[a] = 0;
  }
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    PorePoints &points = points_[b];
    const int count = frame.points[b].count;
    const double per_density = 1 / bodies_[b]->source().grain_density;
    points.grains.assign(count, 0), points.share.assign(count, 0);
    if (Phases::suction) points.suction.assign(count, 0);
    for (int a = 0; a < fluids; ++a) points.mass[a].assign(count, 0), points.pressure[a].assign(count, 0);
    for (int i = 0; i < p.count;) {
      const int mesh_cell = p.cell[i], cell = grid.find_cell(mesh_cell), first = i;
      const BarycentricMap<dim> coordinates(mesh_.cells[mesh_cell]);
      Quad sum[fluids][dim]{};
      double mass[fluids]{}, grains = 0;
      for (; i < p.count && p.cell[i] == mesh_cell; ++i) {
        const Quad mn = quad(p.mass[i]) * coordinates(load<dim>(p.position[i].data()));
        for (int a = 0; a < fluids; ++a)
          for (int d = 0; d < dim; ++d) sum[a][d] += quad(p.fluid_velocity[a][i][d]) * mn;
        if (frame.averaged) {
          grains += p.mass[i];
          for (int a = 0; a < fluids; ++a) mass[a] += p.fluid_mass[a][i];
        } else {
          points.grains[i] = p.mass[i] * per_density;
          for (int a = 0; a < fluids; ++a) points.mass[a][i] = p.fluid_mass[a][i], mass[a] += p.fluid_mass[a][i];
        }
      }
      if (Phases::suction)
        for (int node : grid.shape[cell].node) body_of_node_[node] = static_cast<int>(b);
      for (int a = 0; a < fluids; ++a) {
        cells_[cell].mass[a] += mass[a];
        for (int k = 0; k <= dim; ++k)
          for (int d = 0; d < dim; ++d) impulse_[a][cell][k][d] += sum[a][d][k];
      }
      if (!frame.averaged || first == i) continue;
      const int q = frame.points[b].of_cell[mesh_cell];
      points.grains[q] += grains * per_density;
      for (int a = 0; a < fluids; ++a) points.mass[a][q] += mass[a];
    }
    for (int q = 0; q < count; ++q)  // where Newton starts
      points.share[q] = std::clamp(1 - points.mass[0][q] / (liquid_.density * (frame.volume[b][q] - points.grains[q])), 0., 1.);
  }
  // velocities of the fluids at nodes: within a cell a fluid is spread as the grains are
  constexpr int width = dim + 1;
  for (int a = 0; a < fluids; ++a) {
    std::fill_n(nodal_.begin(), nodes * width, 0.);
    for (int c = 0; c < cells; ++c) {
      double total = 0;
      for (double row : rows_[c]) total += row;
      const double ratio = cells_[c].mass[a] / total;
      for (int k = 0; k <= dim; ++k) {
        double *node = &nodal_[grid.shape[c].node[k] * width];
        node[0] += ratio * rows_[c][k];
        for (int d = 0; d < dim; ++d) node[1 + d] += ratio * impulse_[a][c][k][d];
      }
    }
    PetscCall(grid.sum(nodal_.data(), width));
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d)
        velocity[a * nodes + i][d] = nodal_[i * width] > 0 ? nodal_[i * width + 1 + d] / nodal_[i * width] : solid[i][d];
  }
  PetscCall(store(frame));
  for (int i = 0; i < nodes; ++i) surface_[i] = nodes_[i].surface;
  PetscCall(conditions.begin(grid, filling, surface_));
  constrain(frame, conditions, solid, velocity);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::release(const Frame &frame, const Vec<dim> *velocity, const Vec<dim> *start, double flip) {
  const FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count();
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    const PorePoints &points = points_[b];
    const double per_density = 1 / bodies_[b]->source().grain_density;
    for (int i = 0; i < p.count;) {
      const int mesh_cell = p.cell[i], cell = grid.find_cell(mesh_cell);
      const BarycentricMap<dim> coordinates(mesh_.cells[mesh_cell]);
      Quad change[fluids][dim + 1];
      for (int a = 0; a < fluids; ++a)
        for (int k = 0; k <= dim; ++k) {
          const int n = a * nodes + grid.shape[cell].node[k];
          change[a][k] = load<dim>(velocity[n].data()) - quad(flip) * load<dim>(start[n].data());
        }
      double growth = 1, content[fluids]{};
      if (frame.averaged) {
        const int q = frame.points[b].of_cell[mesh_cell];
        growth = frame.points[b].volume[q] / frame.points[b].start_volume[q];
        for (int a = 0; a < fluids; ++a) content[a] = points.mass[a][q] / (frame.points[b].volume[q] - points.grains[q]);
      }
      for (; i < p.count && p.cell[i] == mesh_cell; ++i) {
        const Quad n = coordinates(load<dim>(p.position[i].data()));
        for (int a = 0; a < fluids; ++a) {
          Quad v = quad(flip) * load<dim>(p.fluid_velocity[a][i].data());
          for (int k = 0; k <= dim; ++k) v += quad(n[k]) * change[a][k];
          talus::store<dim>(p.fluid_velocity[a][i].data(), v);
          // a cell's fluid fills its pores evenly, so that a particle that moves on takes its pressure along
          p.fluid_mass[a][i] = frame.averaged ? content[a] * (p.volume[i] * growth - p.mass[i] * per_density) : points.mass[a][i];
        }
      }
    }
  }
}

// ---- pressures ----

template <int dim, class Phases>
double PoreFluid<dim, Phases>::mixture_pressure(const double *p, double saturation) const {
  if constexpr (Phases::gas) return bishop_ ? saturation * p[0] + (1 - saturation) * p[1] : std::max(p[0], p[1]);
  else if constexpr (Phases::suction) return bishop_ ? saturation * p[0] : std::max(0., p[0]);  // gas at zero gauge pressure
  else return p[0];
}

template <int dim, class Phases>
Vec<dim> PoreFluid<dim, Phases>::place(const Frame &frame, int c, const std::array<double, dim + 1> &n) const {
  Vec<dim> x{};
  for (int k = 0; k <= dim; ++k)
    for (int d = 0; d < dim; ++d) x[d] += n[k] * frame.position[frame.shape[c].node[k]][d];
  return x;
}

/// Pressures of points from their masses, and what cells make of them, theory (3.1)-(3.3), (4.2).
template <int dim, class Phases>
void PoreFluid<dim, Phases>::solve(const Frame &frame) {
  const int cells = frame.grid.cell_count();
  std::fill_n(cells_.begin(), cells, CellPores{});
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PorePoints &accepted = points_[b];
    PorePoints &points = frame.trial ? trial_[b] : points_[b];
    const PointSet &set = frame.points[b];
    const SoilPores &soil = soils_[b];
    for (int q = 0; q < set.count; ++q) {
      const int c = set.cell[q];
      const double volume = frame.volume[b][q], pores = std::max(volume - accepted.grains[q], 1e-6 * volume), n = pores / volume;
      if (given) {
        const Vec<dim> x = place(frame, c, mean_[c]);
        const auto content = contents(soil, given_ramp * given_pressure(x, frame.time), given_ramp * given_gas_pressure(x));
        for (int a = 0; a < fluids; ++a) {
          if (!frame.trial) given_mass_[a] += content[a] * pores - points.mass[a][q];
          points.mass[a][q] = content[a] * pores;
        }
        points.share[q] = content[2];
      }
      PorePressures p;
      double &share = points.share[q];
      const double content = points.mass[0][q] / pores;
      if constexpr (Phases::gas)
        p = three_phase_pressures(soil, liquid_, gas_, content, points.mass[1][q] / pores, share);
      else if constexpr (Phases::suction)
        p = unsaturated_pressure(soil, liquid_, content, share);
      else
        p = saturated_pressure(liquid_, content), share = 0;
      newton_steps += p.iterations, ++newton_solves;
      points.pressure[0][q] = p.liquid;
      if constexpr (Phases::gas) points.pressure[1][q] = p.gas;
      if constexpr (Phases::suction) points.suction[q] = std::max(0., p.gas - p.liquid);

      CellPores &cell = cells_[c];
      const double part = volume / frame.particle_volume[c], k = soil.change(n);
      double k_l = 1, k_g = 1;
      if constexpr (Phases::suction) {
        const SoilPores::State state = soil.at(share);
        constexpr double least_gas = 1e-6;  // trapped gas creeps
        k_l = state.liquid, k_g = std::max(state.gas, least_gas);
      }
      cell.saturation += part * (1 - share);
      cell.pressure[0] += part * p.liquid, cell.mass[0] += points.mass[0][q];
      cell.saturated += part * k * soil.permeability() / liquid_.viscosity;
      cell.conductivity[0] += part * k * soil.permeability() * k_l / liquid_.viscosity;
      cell.density[0] += part * content / (1 - share);
      if constexpr (Phases::gas) {
        cell.pressure[1] += part * p.gas, cell.mass[1] += points.mass[1][q];
        cell.conductivity[1] += part * k * soil.gas_permeability() * k_g / gas_.viscosity;
        cell.density[1] += part * gas_.density_at(p.gas);
      }
    }
  }
}

/// Cell to node to cell, weighted, among nearly saturated cells: conservative and its own adjoint, theory (4.3). Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::smooth(const Frame &frame, double *const *fields, int count) {
  PetscFunctionBeginUser;
  if (!smoothing_) PetscFunctionReturn(0);
  const int cells = frame.grid.cell_count(), width = count + 1;
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
PetscErrorCode PoreFluid<dim, Phases>::store(const Frame &frame) {
  PetscFunctionBeginUser;
  const int nodes = frame.grid.node_count(), cells = frame.grid.cell_count();
  solve(frame);
  const auto head = [&](int c, const std::array<double, dim + 1> &n) {  // g . x
    const Vec<dim> x = place(frame, c, n);
    double sum = 0;
    for (int d = 0; d < dim; ++d) sum += frame.gravity[d] * x[d];
    return sum;
  };
  for (int c = 0; c < cells; ++c) {  // of the liquid, and of the mixture where that is something else
    const double weight = liquid_.density * (head_[c] = head(c, mean_[c]));
    smooth_[0][c] = cells_[c].pressure[0] - weight;
    if constexpr (Phases::gas) smooth_[1][c] = mixture_pressure(cells_[c].pressure, cells_[c].saturation) - weight;
  }
  double *fields[fluids];
  for (int a = 0; a < fluids; ++a) fields[a] = smooth_[a].data();
  PetscCall(smooth(frame, fields, fluids));
  std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  if (frame.trial) at.resize(nodes_.size());
  std::fill_n(at.begin(), nodes, NodePores{});
  for (int c = 0; c < cells; ++c) {
    CellPores &cell = cells_[c];
    const Shape<dim> &shape = frame.shape[c];
    const double w = frame.weight[c], part = w / (dim + 1), here = head(c, reference_[c]);
    double total = 0, ratio[fluids];
    for (double row : rows_[c]) total += row;
    for (int a = 0; a < fluids; ++a) ratio[a] = cell.mass[a] / total;
    cell.smooth[0] = smooth_[0][c] + liquid_.density * here;
    if constexpr (Phases::gas) cell.smooth[1] = cell.pressure[1] + gas_.density * (here - head_[c]);
    cell.mixture = mixture_pressure(cell.smooth, cell.saturation);
    if constexpr (Phases::gas)
      if (smoothed(c)) cell.mixture = smooth_[1][c] + liquid_.density * here;
    Vec<dim> first{};
    for (int k = dim; k >= 0; --k) {
      NodePores &node = at[shape.node[k]];
      if (k)
        for (int d = 0; d < dim; ++d) first[d] -= shape.gradient[k - 1][d];
      const Vec<dim> &g = k ? shape.gradient[k - 1] : first;
      node.volume += part, node.saturated += part * cell.saturated;
      for (int d = 0; d < dim; ++d) {
        const double wg = w * g[d];
        node.surface[d] += wg, node.push[d] += wg * cell.mixture;
        for (int a = 0; a < fluids; ++a) node.fluid[a].push[d] += wg * cell.smooth[a];
      }
      for (int a = 0; a < fluids; ++a) {
        node.fluid[a].mass += ratio[a] * rows_[c][k], node.fluid[a].whole += part * cell.density[a];
        node.fluid[a].conductivity += part * cell.conductivity[a];
      }
    }
  }
  PetscCall(frame.grid.sum(&at[0].volume, node_width));
  PetscFunctionReturn(0);
}

// ---- forces ----

template <int dim, class Phases>
void PoreFluid<dim, Phases>::add_to_mixture(const Frame &frame, const PoreConditions<dim> &conditions, Vec<dim> *force) const {
  const std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  for (int i = 0; i < frame.grid.node_count(); ++i)
    for (int d = 0; d < dim; ++d) {
      force[i][d] += at[i].push[d];
      for (int a = 0; a < fluids; ++a) force[i][d] += at[i].fluid[a].mass * frame.gravity[d];
    }
  conditions.pressures(frame.time, frame.grid, unit_weight(frame), [&](int i, double, const Vec<dim> &area, double load) {
    for (int d = 0; d < dim; ++d) force[i][d] -= load * area[d];
  });
}

/// Conductivity of the liquid where it has a given pressure, in the soil at a node [m2/(Pa s)].
template <int dim, class Phases>
double PoreFluid<dim, Phases>::conductivity_beyond(int node, const NodePores &at, double pressure) const {
  double relative = 1;
  if constexpr (Phases::suction) {
    const SoilPores &soil = soils_[body_of_node_[node]];
    if (pressure < -soil.entry()) relative = soil.at(1 - talus::saturation(soil.retention(), -pressure)).liquid;
  }
  return at.saturated / at.volume * relative;
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::drive(const Frame &frame, const PoreConditions<dim> &conditions, Vec<dim> *force, Vec<dim> *acceleration) {
  const std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  const int nodes = frame.grid.node_count();
  std::fill_n(beyond_.begin(), nodes, 0.);
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i) {
      const auto &fluid = at[i].fluid[a];
      for (int d = 0; d < dim; ++d) acceleration[a * nodes + i][d] = fluid.whole > 0 ? fluid.push[d] / fluid.whole + frame.gravity[d] : 0;
    }
  conditions.pressures(frame.time, frame.grid, unit_weight(frame), [&](int i, double p, const Vec<dim> &area, double) {
    for (int d = 0; d < dim; ++d) acceleration[i][d] -= p * area[d] / at[i].fluid[0].whole;
    beyond_[i] = conductivity_beyond(i, at[i], p);
  });
  if constexpr (Phases::gas)
    conditions.gas_pressures(frame.time, frame.grid, [&](int i, double p, const Vec<dim> &area) {
      for (int d = 0; d < dim; ++d) acceleration[nodes + i][d] -= p * area[d] / at[i].fluid[1].whole;
    });
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) force[i][d] -= at[i].fluid[a].mass * acceleration[a * nodes + i][d];
}

/// Mass, M and resistance Q = phi V / k of a fluid at a node: the flux of a steady state is then the mean conductivity times the gradient.
template <int dim, class Phases>
NodalFluid PoreFluid<dim, Phases>::at_node(int i, int a) const {
  const NodePores &node = nodes_[i];
  const auto &fluid = node.fluid[a];
  if (!(fluid.whole > 0)) return {0, 0, 0};
  constexpr double closed = 1e30;  // [1/s]: where pressures are given, fluids go with the grains
  double conductivity = fluid.conductivity / node.volume;
  if (a == 0 && beyond_[i] > 0) conductivity = (conductivity + beyond_[i]) / 2;  // as if there were one more cell, beyond the face
  const double resistance = given ? closed * fluid.whole : fluid.mass / fluid.whole * node.volume / std::max(conductivity, 1e-300);
  return {fluid.mass, fluid.whole, resistance};
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::resist(double step, const FilledGrid<dim> &grid, Vec<dim> *solid, const Vec<dim> *fluid) const {
  const int nodes = grid.node_count();
  for (int i = 0; i < nodes; ++i) {
    NodalFluid at[fluids];
    for (int a = 0; a < fluids; ++a) at[a] = at_node(i, a);
    for (int d = 0; d < dim; ++d) {
      double v[fluids];
      for (int a = 0; a < fluids; ++a) v[a] = fluid[a * nodes + i][d];
      resolve_drag<fluids>(step, grid.mass[i], solid[i][d], at, v);
    }
  }
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::follow(double step, const Frame &frame, const PoreConditions<dim> &conditions, const Vec<dim> *solid, Vec<dim> *fluid) const {
  const int nodes = frame.grid.node_count();
  for (int i = 0; i < nodes; ++i) {
    NodalFluid at[fluids];
    for (int a = 0; a < fluids; ++a) at[a] = at_node(i, a);
    for (int d = 0; d < dim; ++d) {
      double v[fluids], held = solid[i][d];
      for (int a = 0; a < fluids; ++a) v[a] = fluid[a * nodes + i][d];
      resolve_drag<fluids>(step, frame.grid.mass[i], held, at, v, true);
      for (int a = 0; a < fluids; ++a) fluid[a * nodes + i][d] = v[a];
    }
  }
  constrain(frame, conditions, solid, fluid);
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::constrain(const Frame &frame, const PoreConditions<dim> &conditions, const Vec<dim> *solid, Vec<dim> *fluid) const {
  conditions.constrain(
      frame.time, frame.grid, liquid_.density, unit_weight(frame), [&](int i) { return LiquidAtNode{nodes_[i].fluid[0].mass, nodes_[i].volume}; }, solid,
      fluid, Phases::gas ? fluid + frame.grid.node_count() : nullptr);
}

// ---- exchange ----

/// Gas takes the density of where it comes from, and none leaves soil whose gas is down to its residue, theory (4.9). Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::gas_flux(const Frame &frame, const Vec<dim> *gas, const Vec<dim> *solid)
  requires Phases::gas
{
  PetscFunctionBeginUser;
  constexpr int width = 3;
  constexpr double empty = 1e-30;
  FilledGrid<dim> &grid = frame.grid;
  const auto pore_share = [&](int i) {
    const auto &fluid = nodes_[i].fluid[1];
    return fluid.whole > 0 ? fluid.mass / fluid.whole : 0;
  };
  std::fill_n(nodal_.begin(), grid.node_count() * width, 0.);
  for (int c = 0; c < grid.cell_count(); ++c) {
    const Shape<dim> &shape = grid.shape[c];
    const CellPores &cell = cells_[c];
    double takes[dim + 1], out = 0;  // volume that a node takes from the cell
    Vec<dim> first{};
    for (int k = dim; k >= 0; --k) {
      if (k)
        for (int d = 0; d < dim; ++d) first[d] -= shape.gradient[k - 1][d];
      const Vec<dim> &g = k ? shape.gradient[k - 1] : first;
      const int i = shape.node[k];
      double towards = 0;
      for (int d = 0; d < dim; ++d) towards += g[d] * (gas[i][d] - solid[i][d]);
      takes[k] = frame.weight[c] * std::max(0., towards);
      out += takes[k] * pore_share(i);
    }
    if (!(out > 0)) continue;
    const double free = 1 - residual_gas / std::max(1 - cell.saturation, empty);  // share of the gas that may leave
    const double open = std::clamp(std::min(free / residual_gas * (1 - cell.saturation), free * cell.mass[1] / (2 * out * cell.density[1])), empty, 1.);
    for (int k = 0; k <= dim; ++k) {
      if (!(takes[k] > 0)) continue;
      double *node = &nodal_[shape.node[k] * width];
      node[0] += takes[k], node[1] += takes[k] * cell.density[1], node[2] += 1 / open - 1;
    }
  }
  PetscCall(grid.sum(nodal_.data(), width));
  for (int i = 0; i < grid.node_count(); ++i) {
    const double *node = &nodal_[i * width], rho = node[0] > 0 ? node[1] / node[0] : gas_.density;
    const double density = given ? 0 : pore_share(i) * rho / (1 + node[2]);
    for (int d = 0; d < dim; ++d) flux_[i][d] = density * (gas[i][d] - solid[i][d]);
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::flow(const Frame &frame, const Vec<dim> *u) {
  PetscFunctionBeginUser;
  const FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count(), cells = grid.cell_count();
  for (int a = 0; a < fluids; ++a) {
    const Vec<dim> *moved = u + (1 + a) * nodes;
    if constexpr (Phases::gas)
      if (a == 1) PetscCall(gas_flux(frame, moved, u));
    for (int i = 0; i < nodes && a == 0; ++i) {
      const double density = given ? 0 : nodes_[i].volume > 0 ? nodes_[i].fluid[a].mass / nodes_[i].volume : 0;
      for (int d = 0; d < dim; ++d) flux_[i][d] = density * (moved[i][d] - u[i][d]);
    }
    if (!frame.trial)
      for (int i = 0; i < nodes; ++i)
        if (mesh_.owned[grid.mesh_node[i]])
          for (int d = 0; d < dim; ++d) out_[a] += flux_[i][d] * nodes_[i].surface[d];
    for (int c = 0; c < cells; ++c) {
      const Shape<dim> &shape = grid.shape[c];
      double sum = 0;
      for (int k = 0; k < dim; ++k)
        for (int d = 0; d < dim; ++d) sum += shape.gradient[k][d] * (flux_[shape.node[k + 1]][d] - flux_[shape.node[0]][d]);
      divergence_[a][c] = sum;
    }
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::smooth_flow(const Frame &frame, Array &volume_strain) {
  PetscFunctionBeginUser;
  double *fields[] = {volume_strain.data(), divergence_[0].data()};  // gas moves by its own pressure, which is not smoothed
  PetscCall(smooth(frame, fields, 2));
  const int cells = frame.grid.cell_count();
  for (int a = 0; a < fluids; ++a)
    for (int c = 0; c < cells; ++c) divergence_[a][c] *= frame.weight[c];
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::exchange(const Frame &frame) {
  PetscFunctionBeginUser;
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PorePoints &from = points_[b];
    PorePoints &to = frame.trial ? trial_[b] : points_[b];
    const PointSet &set = frame.points[b];
    if (frame.trial) to = from;
    for (int a = 0; a < fluids; ++a)
      for (int q = 0; q < set.count; ++q)
        to.mass[a][q] = from.mass[a][q] - frame.volume[b][q] / frame.particle_volume[set.cell[q]] * divergence_[a][set.cell[q]];
  }
  PetscCall(store(frame));
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PoreReport PoreFluid<dim, Phases>::report(int body, int point, int cell) const {
  const double *p = cells_[cell].smooth, gas = Phases::gas ? p[fluids - 1] : 0, share = points_[body].share[point];
  double suction = 0;
  if constexpr (Phases::suction) suction = points_[body].suction[point];
  return {p[0], gas, suction, 1 - share};
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::keep(Archive &archive) {
  for (PorePoints &points : points_) {
    archive.keep("pores", points.grains, points.share, points.suction);
    for (int a = 0; a < fluids; ++a) archive.keep("fluid", points.mass[a], points.pressure[a]);
  }
  archive.keep("fluids", cells_, nodes_, surface_, mean_, reference_, rows_, body_of_node_, out_, given_mass_);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::ledger(bool gathered, FluidLedger *sums) {
  PetscFunctionBeginUser;
  double mine[3 * fluids]{}, all[3 * fluids];
  for (size_t b = 0; b < bodies_.size(); ++b)
    for (int a = 0; a < fluids; ++a) {
      if (gathered)
        for (double m : points_[b].mass[a]) mine[3 * a] += m;
      else
        for (int i = 0; i < bodies_[b]->particles().count; ++i) mine[3 * a] += bodies_[b]->particles().fluid_mass[a][i];
    }
  for (int a = 0; a < fluids; ++a) mine[3 * a + 1] = out_[a], mine[3 * a + 2] = given_mass_[a];
  PetscCallMPI(MPI_Allreduce(mine, all, 3 * fluids, MPI_DOUBLE, MPI_SUM, mesh_.comm()));
  for (int a = 0; a < fluids; ++a) sums[a] = {all[3 * a], all[3 * a + 1], all[3 * a + 2]};
  PetscFunctionReturn(0);
}

}  // namespace talus
