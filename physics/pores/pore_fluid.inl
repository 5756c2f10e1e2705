// Implementation of PoreFluid; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"

namespace talus {

template <int dim, class Phases>
PoreFluid<dim, Phases>::PoreFluid(const BackgroundMesh<dim> &mesh, std::vector<std::unique_ptr<Body<dim>>> &bodies, const Scene &scene)
    : mesh_(mesh), bodies_(bodies), scene_(scene), liquid_(scene.water), gas_(scene.gas),
      pressure_(scene.water, std::hypot(scene.gravity[0], scene.gravity[1])), bishop_(scene.water.stress == PoreStress::bishop),
      smoothing_(scene.transfer.pore_smoothing == PoreSmoothing::nodal), explicit_drag_(scene.water.drag == PoreDrag::at_start),
      by_rate_(scene.water.storage == PoreStorage::rate), points_(bodies.size()), next_points_(bodies.size()), trial_(bodies.size()) {
  const size_t nodes = mesh.node_count(), cells = mesh.cell_count();
  const double gravity = std::hypot(scene.gravity[0], scene.gravity[1], dim == 3 ? scene.gravity[dim - 1] : 0);
  constexpr double earth = 9.81;  // [m/s2], for a hydraulic conductivity in a scene without gravity
  for (const auto &body : bodies) soils_.emplace_back(body->source(), scene.water.density * (gravity > 0 ? gravity : earth), scene.water.viscosity);
  cells_.resize(cells), nodes_.resize(nodes), mean_.resize(cells), reference_.resize(cells), rows_.resize(cells), head_.resize(cells), grain_mass_.resize(cells);
  nodal_head_.resize(nodes), momentum_.resize(nodes), surface_.resize(nodes), moment_.resize(nodes), gap_.resize(nodes), beyond_.assign(nodes, 0), body_of_node_.assign(nodes, 0);
  for (int a = 0; a < fluids; ++a) flux_[a].resize(nodes), shut_[a].resize(nodes), impulse_[a].resize(cells), divergence_[a].resize(cells), smooth_[a].resize(cells);
  nodal_.resize(4 * nodes);
  for (auto *all : {&points_, &next_points_})
    for (size_t b = 0; b < bodies.size(); ++b) (*all)[b].room(scene.transfer.average_stress ? static_cast<int>(cells) : bodies[b]->particles().count);
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
Pores<dim> PoreFluid<dim, Phases>::show(std::vector<PorePoints> &points, int b) {
  Pores<dim> pores{points[b].grains.data(), {}, {}, 1 / bodies_[b]->source().grain_density};
  for (int a = 0; a < fluids; ++a) pores.mass[a] = points[b].mass[a].data(), pores.impulse[a] = impulse_[a].data();
  return pores;
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::gather(const Frame &frame, PoreConditions<dim> &conditions, const Array &filling, const Vec<dim> *solid,
                                              Vec<dim> *velocity) {
  PetscFunctionBeginUser;
  FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count(), cells = grid.cell_count();
  Array *const mass = smooth_;  // of the fluids in a cell [kg]; nothing is smoothed yet
  for (int a = 0; a < fluids; ++a) std::fill_n(mass[a].begin(), cells, 0.);
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    const PointSet &set = frame.points[b];
    PorePoints &points = points_[b];
    points.count = set.count;
    if (!frame.averaged) {  // particles are the points
      const double over_density = 1 / bodies_[b]->source().grain_density;
      points.room(set.count);
      for (int i = 0; i < p.count; ++i) {
        points.grains[i] = p.mass[i] * over_density;
        for (int a = 0; a < fluids; ++a) points.mass[a][i] = p.fluid_mass[a][i];
      }
    }
    for (int q = 0; q < set.count; ++q) {
      const int c = set.cell[q];
      for (int a = 0; a < fluids; ++a) mass[a][c] += points.mass[a][q];
      if constexpr (Phases::suction) {
        points.share[q] = std::clamp(1 - points.mass[0][q] / (liquid_.density * (frame.volume[b][q] - points.grains[q])), 0., 1.);  // where Newton starts
        for (int node : grid.shape[c].node) body_of_node_[node] = static_cast<int>(b);
      }
    }
  }
  // velocities of the fluids at nodes: within a cell a fluid is spread as the grains are
  std::fill_n(momentum_.begin(), nodes, std::array<Quad, fluids>{});
  for (int c = 0; c < cells; ++c) {
    const auto &matrix = grid.mass_matrix[c];
    auto &rows = rows_[c];
    for (int k = 0; k <= dim; ++k) rows[k] = matrix[k];
    for (int k = 0, pair = dim + 1; k <= dim; ++k)
      for (int l = k + 1; l <= dim; ++l, ++pair) rows[k] += matrix[pair], rows[l] += matrix[pair];
    grain_mass_[c] = 0;
    const double scale = 1 / frame.particle_volume[c];
    for (int k = 0; k <= dim; ++k) {
      grain_mass_[c] += rows[k];
      mean_[c][k] = grid.nodal_share[c][k] * scale;
      reference_[c][k] = mean_[c][k] + frame.blend[c] * (1. / (dim + 1) - mean_[c][k]);
    }
    const Quad row = load<dim + 1>(rows.data());
    for (int a = 0; a < fluids; ++a) {
      const double ratio = mass[a][c] / grain_mass_[c];
      Quad part[4]{};  // by component, then by vertex
#pragma GCC unroll 8
      for (int d = 0; d < dim; ++d) part[d] = impulse_[a][c][d];
      part[last] = row;
      transpose(part);
#pragma GCC unroll 8
      for (int k = 0; k <= dim; ++k) momentum_[grid.shape[c].node[k]][a] += quad(ratio) * part[k];
    }
  }
  PetscCall(grid.sum(reinterpret_cast<double *>(momentum_.data()), 4 * fluids));
  for (int i = 0; i < nodes; ++i)
    for (int a = 0; a < fluids; ++a) {
      const Quad &momentum = momentum_[i][a];
      for (int d = 0; d < dim; ++d) velocity[a * nodes + i][d] = momentum[last] > 0 ? momentum[d] / momentum[last] : solid[i][d];
    }
  PetscCall(store(frame));
  for (int i = 0; i < nodes; ++i) talus::store<dim>(surface_[i].data(), nodes_[i].geometry);
  if (conditions.open_water()) {  // theory (5.2)
    std::fill_n(moment_.begin(), nodes, Vec<dim>{});
    for (int c = 0; c < cells; ++c) {
      const double y = place(frame, c, reference_[c])[1];
      Vec<dim> first{};
      for (int k = dim; k >= 0; --k) {
        const int i = grid.shape[c].node[k];
        for (int d = 0; d < dim; ++d) {
          const double g = k ? grid.shape[c].gradient[k - 1][d] : first[d];
          first[d] -= g;
          moment_[i][d] += frame.weight[c] * g * (frame.position[i][1] - y);
        }
        moment_[i][1] -= frame.weight[c] * reference_[c][k];
      }
    }
    PetscCall(grid.sum(moment_[0].data(), dim));
  }
  PetscCall(conditions.begin(grid, filling, surface_, moment_));
  constrain(frame, conditions, solid, velocity);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::hand_over(int nodes, const Vec<dim> *velocity, const Vec<dim> *start, double flip, NodalUpdate &update) const {
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i) {
      const int n = a * nodes + i;
      update.fluid[a][i] = load<dim>(velocity[n].data()) - quad(flip) * load<dim>(start[n].data());
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

/// Fills the points to the given pressures, where fluids do not move.
template <int dim, class Phases>
void PoreFluid<dim, Phases>::hold(const Frame &frame) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PorePoints &points = frame.trial ? trial_[b] : points_[b];
    for (int q = 0; q < frame.points[b].count; ++q) {
      const int c = frame.points[b].cell[q];
      const Vec<dim> x = place(frame, c, mean_[c]);
      const double pores = pore_volume(frame.volume[b][q], points_[b].grains[q]);
      const auto content = contents(soils_[b], given_ramp * given_pressure(x, frame.time), given_ramp * given_gas_pressure(x));
      for (int a = 0; a < fluids; ++a) {
        if (!frame.trial) given_mass_[a] += content[a] * pores - points.mass[a][q];
        points.mass[a][q] = content[a] * pores;
      }
      points.share[q] = content[2];
    }
  }
}

/// Pressures of points from their masses, and what cells make of them, theory (3.1)-(3.3), (4.2).
template <int dim, class Phases>
void PoreFluid<dim, Phases>::solve(const Frame &frame) {
  constexpr int lanes = 8;
  std::vector<CellPores> &cells = frame.trial ? trial_cells_ : cells_;
  if (frame.trial) cells.resize(cells_.size());
  std::fill_n(cells.begin(), frame.grid.cell_count(), CellPores{});
  if (given) hold(frame);
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
      if constexpr (Phases::gas) three_phase_pressures(soil, liquid_, gas_, p);
      else if constexpr (Phases::suction) unsaturated_pressures(soil, liquid_, p);
      else saturated_pressures(liquid_, p);
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
        if constexpr (Phases::suction) points.share[q] = p.gas_share[i], points.suction[q] = std::max(0., p.gas[i] - p.liquid[i]);
        if constexpr (Phases::gas) {
          cell.pressure[1] += part * p.gas[i], cell.mass[1] += points.mass[1][q];
          cell.conductivity[1] += part * k[i] * soil.gas_permeability() * k_g[i] / gas_.viscosity;
          cell.density[1] += part * gas_.density_at(p.gas[i]);
        }
      }
    }
  }
}

/// Cell to node to cell, weighted, among nearly saturated cells: conservative and its own adjoint, theory (4.3). Collective.
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
PetscErrorCode PoreFluid<dim, Phases>::store(const Frame &frame) {
  PetscFunctionBeginUser;
  const int nodes = frame.grid.node_count(), cells = frame.grid.cell_count();
  solve(frame);
  if (by_rate_) keep_pressures(frame);
  std::vector<CellPores> &pores = frame.trial ? trial_cells_ : cells_;
  for (int i = 0; i < nodes; ++i) {
    nodal_head_[i] = 0;
    for (int d = 0; d < dim; ++d) nodal_head_[i] += frame.gravity[d] * frame.position[i][d];
  }
  const auto head = [&](int c, const std::array<double, dim + 1> &n) {  // g . x
    double sum = 0;
    for (int k = 0; k <= dim; ++k) sum += n[k] * nodal_head_[frame.shape[c].node[k]];
    return sum;
  };
  std::array<double *, fluids> fields;
  for (int a = 0; a < fluids; ++a) fields[a] = smooth_[a].data();
  for (int c = 0; c < cells; ++c) {  // of the liquid, and of the mixture where that is something else
    const double weight = liquid_.density * (head_[c] = head(c, mean_[c]));
    smooth_[0][c] = pores[c].pressure[0] - weight;
    if constexpr (Phases::gas) smooth_[1][c] = mixture_pressure(pores[c].pressure, pores[c].saturation) - weight;
  }
  if constexpr (Phases::suction) PetscCall(see_around(frame, smooth_[0]));
  PetscCall(smooth<fluids>(frame, fields));
  std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  if (frame.trial) at.resize(nodes_.size());
  std::fill_n(at.begin(), nodes, NodePores{});
  for (int c = 0; c < cells; ++c) {
    CellPores &cell = pores[c];
    const Shape<dim> &shape = frame.shape[c];
    const double w = frame.weight[c], here = head(c, reference_[c]), scale = 1 / grain_mass_[c];
    cell.smooth[0] = smooth_[0][c] + liquid_.density * here;
    if constexpr (Phases::gas) cell.smooth[1] = cell.pressure[1] + gas_.density * (here - head_[c]);
    double own[fluids];
    for (int a = 0; a < fluids; ++a) own[a] = cell.pressure[a] + (a ? gas_density() : liquid_.density) * (here - head_[c]);
    cell.mixture = mixture_pressure(smoothed(c) ? cell.smooth : own, cell.saturation);
    if constexpr (Phases::gas)
      if (smoothed(c)) {  // the gas keeps its suction against the liquid: what smoothing takes must not draw gas
        cell.smooth[1] += smooth_[0][c] + liquid_.density * head_[c] - cell.pressure[0];
        cell.mixture = smooth_[1][c] + liquid_.density * here;
      }
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

// ---- forces ----

template <int dim, class Phases>
void PoreFluid<dim, Phases>::add_to_mixture(const Frame &frame, const PoreConditions<dim> &conditions, Vec<dim> *force) const {
  const std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  for (int i = 0; i < frame.grid.node_count(); ++i)
    for (int d = 0; d < dim; ++d) {
      force[i][d] += at[i].push[mixture][d];
      for (int a = 0; a < fluids; ++a) force[i][d] += at[i].mass(a) * weighs(at[i], a) * frame.gravity[d];
    }
  conditions.pressures(frame.time, frame.grid, unit_weight(frame), [&](int i, double, const Vec<dim> &, const Vec<dim> &load) {
    for (int d = 0; d < dim; ++d) force[i][d] -= load[d];
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
  return at.conductivity(mixture) / at.volume() * relative;
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::drive(const Frame &frame, const PoreConditions<dim> &conditions, Vec<dim> *force, Vec<dim> *acceleration,
                                             const Vec<dim> *velocity) {
  PetscFunctionBeginUser;
  const std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  const int nodes = frame.grid.node_count();
  std::fill_n(beyond_.begin(), nodes, 0.);
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i) {
      const double whole = at[i].whole(a), scale = whole > 0 ? 1 / whole : 0;
      for (int d = 0; d < dim; ++d) acceleration[a * nodes + i][d] = whole > 0 ? at[i].push[a][d] * scale + weighs(at[i], a) * frame.gravity[d] : 0;
    }
  // beyond a gap is the pressure of the cells around it, brought to the node with the weight of the fluid
  const std::vector<CellPores> &pores = frame.trial ? trial_cells_ : cells_;
  std::fill_n(nodal_.begin(), nodes * fluids, 0.);
  for (const auto &[i, c, k] : conditions.gap_cells()) {
    const Vec<dim> x = place(frame, c, reference_[c]);
    const double part = frame.weight[c] * reference_[c][k];
    double rise = 0;
    for (int d = 0; d < dim; ++d) rise += frame.gravity[d] * (frame.position[i][d] - x[d]);
    nodal_[i * fluids] += part * (pores[c].smooth[0] + liquid_.density * rise);
    if constexpr (Phases::gas) nodal_[i * fluids + 1] += part * (pores[c].smooth[1] + gas_.density * rise);
  }
  PetscCall(frame.grid.sum(nodal_.data(), fluids));
  conditions.gaps(frame.grid, [&](int i) { return surface_at(at[i]); }, [&](int i, const Vec<dim> &area) {
    for (int a = 0; a < fluids; ++a)
      for (int d = 0; d < dim && at[i].whole(a) > 0; ++d) acceleration[a * nodes + i][d] -= nodal_[i * fluids + a] / at[i].volume() * area[d] / at[i].whole(a);
  });
  conditions.pressures(frame.time, frame.grid, unit_weight(frame), [&](int i, double p, const Vec<dim> &push, const Vec<dim> &) {
    for (int d = 0; d < dim; ++d) acceleration[i][d] -= push[d] / at[i].whole(0);
    beyond_[i] = conductivity_beyond(i, at[i], p);
  });
  if constexpr (Phases::gas)
    conditions.gas_pressures(frame.time, frame.grid, [&](int i, double p, const Vec<dim> &area) {
      for (int d = 0; d < dim; ++d) acceleration[nodes + i][d] -= p * area[d] / at[i].whole(1);
    });
  for (int i = 0; i < nodes && explicit_drag_ && !given; ++i)
    for (int a = 0; a < fluids; ++a) {
      const double rate = drag_number(1, at_node(i, a));
      for (int d = 0; d < dim; ++d) acceleration[a * nodes + i][d] -= rate * (velocity[(1 + a) * nodes + i][d] - velocity[i][d]);
    }
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) force[i][d] -= at[i].mass(a) * acceleration[a * nodes + i][d];
  PetscFunctionReturn(0);
}

/// Mass, M and resistance Q = phi V / k of a fluid at a node: the flux of a steady state is then the mean conductivity times the gradient.
template <int dim, class Phases>
NodalFluid PoreFluid<dim, Phases>::at_node(int i, int a, double beyond) const {
  const NodePores &node = nodes_[i];
  const double mass = node.mass(a), whole = node.whole(a);
  if (!(whole > 0)) return {0, 0, 0};
  constexpr double closed = 1e30;  // [1/s]: where pressures are given, fluids go with the grains
  double conductivity = node.conductivity(a) / node.volume();
  if (beyond > 0) conductivity = (conductivity + beyond) / 2;  // as if there were one more cell, beyond the face
  const double resistance = given ? closed * whole : mass / whole * node.volume() / std::max(conductivity, 1e-300);
  return {mass, whole, resistance};
}

/// What drag over a step sees of it: nothing to resist where drag is explicit and so one of the forces.
template <int dim, class Phases>
NodalFluid PoreFluid<dim, Phases>::over_step(int i, int a) const {
  const NodalFluid at = at_node(i, a);
  return explicit_drag_ && !given ? NodalFluid{at.mass, at.whole_mass, 0} : at;
}

/// Each fluid against the skeleton; together they are no faster than their sum. Pores that may be dry beyond a face count there with half the conductivity.
template <int dim, class Phases>
double PoreFluid<dim, Phases>::drag_rate(const FilledGrid<dim> &grid) const {
  double largest = 0;
  for (int i = 0; i < grid.node_count() && !given; ++i) {
    double rate = 0;
    for (int a = 0; a < fluids; ++a) {
      const NodalFluid at = at_node(i, a, 0);
      rate += (Phases::suction && a == 0 ? 2 : 1) * drag_number(1, at) * (1 + at.mass / grid.mass[i]);
    }
    largest = std::max(largest, rate);
  }
  return largest;
}

/// Shortest change of a number that brings it between two others.
inline double into(double x, double low, double high) { return std::clamp(x, low, high) - x; }

/// Where a face or a wall holds a fluid back, that acts on the skeleton too: they share what momentum they have along its normal. A surface that lets no
/// water in bears its suction so, and a wall that holds the skeleton bears the weight of the water, theory (4.6a).
template <int dim, class Phases>
void PoreFluid<dim, Phases>::resist(double step, const Frame &frame, const PoreConditions<dim> &conditions, Vec<dim> *solid, const Vec<dim> *fluid) const {
  const FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count();
  for (int i = 0; i < nodes; ++i) {
    NodalFluid at[fluids];
    for (int a = 0; a < fluids; ++a) at[a] = over_step(i, a);
    for (int d = 0; d < dim; ++d) {
      double v[fluids];
      for (int a = 0; a < fluids; ++a) v[a] = fluid[a * nodes + i][d];
      resolve_drag<fluids>(step, grid.mass[i], solid[i][d], at, v);
    }
  }
  const auto share = [&](int i, const Vec<dim> &n, int count, double low, double high) {
    double momentum = 0, mass = grid.mass[i];
    for (int a = 0; a < count; ++a) {
      const NodalFluid at = over_step(i, a);
      double out = 0;
      for (int d = 0; d < dim; ++d) out += (fluid[a * nodes + i][d] - solid[i][d]) * n[d];
      momentum -= at.mass * into(out / (1 + drag_number(step, at)), low, high), mass += at.mass;
    }
    for (int d = 0; d < dim; ++d) solid[i][d] += momentum / mass * n[d];
  };
  limits(frame, conditions, [&](int i, const Vec<dim> &n, double low, double high) { share(i, n, 1, low, high); });
  conditions.walls([&](int i, const Vec<dim> &n) { share(i, n, fluids, 0, 0); });
}

/// What a support at a node holds: the skeleton, all of a fluid along the normals of walls, elsewhere what drag takes along in a step [kg].
template <int dim, class Phases>
Square<dim> PoreFluid<dim, Phases>::inertia(double step, const FilledGrid<dim> &grid, const PoreConditions<dim> &conditions, int i) const {
  double dragged = grid.mass[i], rest = 0;
  for (int a = 0; a < fluids; ++a) {
    const NodalFluid at = over_step(i, a);
    const double free = at.mass / (1 + drag_number(step, at));
    dragged += at.mass - free, rest += free;
  }
  Square<dim> held = dragged * Square<dim>::Identity();
  conditions.walls_at(grid, i, [&](const Vec<dim> &n) { held += rest * map<dim>(n) * map<dim>(n).transpose(); });
  return held;
}

/// The sum of w p grad N is the pressure on the wall less its gradient over the cells beside it; along a wall's normal that is the liquid's weight.
template <int dim, class Phases>
double PoreFluid<dim, Phases>::thrust(const Vec<dim> &gravity, int i, const Vec<dim> &n) const {
  double push = 0, weight = 0;
  for (int d = 0; d < dim; ++d) push += nodes_[i].push[mixture][d] * n[d], weight += liquid_.density * nodes_[i].volume() * gravity[d] * n[d];
  return Phases::suction && push <= 0 ? push : push + weight;
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::follow(double step, const Frame &frame, const PoreConditions<dim> &conditions, const Vec<dim> *solid, Vec<dim> *fluid) const {
  const int nodes = frame.grid.node_count();
  for (int i = 0; i < nodes; ++i) {
    NodalFluid at[fluids];
    for (int a = 0; a < fluids; ++a) at[a] = over_step(i, a);
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
template <class Limit>
void PoreFluid<dim, Phases>::limits(const Frame &frame, const PoreConditions<dim> &conditions, Limit &&limit) const {
  conditions.limits(frame.time, frame.grid, liquid_.density, unit_weight(frame), [&](int i) { return LiquidAtNode{nodes_[i].mass(0), nodes_[i].volume()}; }, limit);
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::constrain(const Frame &frame, const PoreConditions<dim> &conditions, const Vec<dim> *solid, Vec<dim> *fluid) const {
  const int nodes = frame.grid.node_count();
  const auto hold = [&](int i, const Vec<dim> &n, int count, double low, double high) {
    for (int a = 0; a < count; ++a) {
      Vec<dim> &v = fluid[a * nodes + i];
      double out = 0;
      for (int d = 0; d < dim; ++d) out += (v[d] - solid[i][d]) * n[d];
      const double change = into(out, low, high);
      for (int d = 0; d < dim; ++d) v[d] += change * n[d];
    }
  };
  limits(frame, conditions, [&](int i, const Vec<dim> &n, double low, double high) { hold(i, n, 1, low, high); });
  conditions.walls([&](int i, const Vec<dim> &n) { hold(i, n, fluids, 0, 0); });
}

// ---- exchange ----

/// Gas takes the density of where it comes from, and none leaves soil whose gas is down to its residue, theory (4.9). Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::gas_flux(const Frame &frame, const Vec<dim> *gas, const Vec<dim> *solid)
  requires Phases::gas
{
  PetscFunctionBeginUser;
  constexpr int width = 4, share = 3;  // of a node: volume taken, mass taken, what holds gas back; share of the gas that is in the pores
  constexpr double empty = 1e-30;
  FilledGrid<dim> &grid = frame.grid;
  const auto pore_share = [&](int i) { return nodes_[i].whole(1) > 0 ? nodes_[i].mass(1) / nodes_[i].whole(1) : 0; };
  for (int i = 0; i < grid.node_count(); ++i) {
    talus::store<4>(&nodal_[i * width], Quad{0, 0, 0, pore_share(i)});
    for (int d = 0; d < dim; ++d) flux_[1][i][d] = gas[i][d] - solid[i][d];
  }
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
      for (int d = 0; d < dim; ++d) towards += (g[d] - reference_[c][k] * gap_[i][d]) * flux_[1][i][d];
      takes[k] = frame.weight[c] * std::max(0., towards);
      out += takes[k] * nodal_[i * width + share];
    }
    if (!(out > 0)) continue;
    const double free = 1 - residual_gas / std::max(1 - cell.saturation, empty);  // share of the gas that may leave
    const double open = std::clamp(std::min(free / residual_gas * (1 - cell.saturation), free * cell.mass[1] / (2 * out * cell.density[1])), empty, 1.);
    const double held = 1 / open - 1;
    for (int k = 0; k <= dim; ++k) {  // without branches: which nodes take is as good as random
      double *node = &nodal_[shape.node[k] * width];
      talus::store<4>(node, load<4>(node) + Quad{takes[k], takes[k] * cell.density[1], takes[k] > 0 ? held : 0, 0});
    }
  }
  PetscCall(grid.sum(nodal_.data(), width));
  for (int i = 0; i < grid.node_count(); ++i) {
    const double *node = &nodal_[i * width], rho = node[0] > 0 ? node[1] / node[0] : gas_.density;
    const double density = given ? 0 : pore_share(i) * rho / (1 + node[2]);
    for (int d = 0; d < dim; ++d) flux_[1][i][d] *= density;
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::flow(const Frame &frame, const PoreConditions<dim> &conditions, const Vec<dim> *u) {
  PetscFunctionBeginUser;
  const FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count(), cells = grid.cell_count();
  std::fill_n(gap_.begin(), nodes, Vec<dim>{});
  conditions.gaps(grid, [&](int i) { return surface_at(nodes_[i]); }, [&](int i, const Vec<dim> &area) {
    for (int d = 0; d < dim; ++d) gap_[i][d] = area[d] / nodes_[i].volume();
  });
  for (int i = 0; i < nodes; ++i) {
    const double density = given ? 0 : nodes_[i].volume() > 0 ? nodes_[i].mass(0) / nodes_[i].volume() : 0;
    for (int d = 0; d < dim; ++d) flux_[0][i][d] = density * (u[nodes + i][d] - u[i][d]);
  }
  if constexpr (Phases::gas) PetscCall(gas_flux(frame, u + 2 * nodes, u));
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i) {
      double out = 0, shut = 0;
      for (int d = 0; d < dim; ++d) out += flux_[a][i][d] * nodes_[i].geometry[d], shut += flux_[a][i][d] * gap_[i][d];
      shut_[a][i] = shut;
      if (!frame.trial && mesh_.owned[grid.mesh_node[i]]) out_[a] += out - shut * nodes_[i].volume();
    }
  for (int c = 0; c < cells; ++c) {
    const Shape<dim> &shape = grid.shape[c];
    for (int a = 0; a < fluids; ++a) {
      double sum = 0;
      for (int k = 0; k < dim; ++k)
        for (int d = 0; d < dim; ++d) sum += shape.gradient[k][d] * (flux_[a][shape.node[k + 1]][d] - flux_[a][shape.node[0]][d]);
      divergence_[a][c] = sum;
    }
  }
  for (const auto &[i, c, k] : conditions.gap_cells())
    for (int a = 0; a < fluids; ++a) divergence_[a][c] -= reference_[c][k] * shut_[a][i];
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::smooth_flow(const Frame &frame, Array &volume_strain) {
  PetscFunctionBeginUser;
  PetscCall(smooth<2>(frame, {volume_strain.data(), divergence_[0].data()}));  // gas moves by its own pressure, which is not smoothed
  const int cells = frame.grid.cell_count();
  for (int a = Phases::suction; a < fluids; ++a)
    for (int c = 0; c < cells; ++c) divergence_[a][c] *= frame.weight[c];
  if constexpr (Phases::suction) PetscCall(give_around(frame, divergence_[0]));
  PetscFunctionReturn(0);
}

/// A cell takes up liquid as its particles' volume tells, and what its own volume tells beyond that goes to the cells around in proportion to theirs, theory (4.8a):
/// where particles are spread unevenly over the cells of a front, contents stay even. Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::give_around(const Frame &frame, Array &divergence) requires Phases::suction {
  PetscFunctionBeginUser;
  const int cells = frame.grid.cell_count();
  std::fill_n(nodal_.begin(), frame.grid.node_count() * 2, 0.);
  for (int c = 0; c < cells; ++c)
    for (int i : frame.shape[c].node) nodal_[i * 2] += frame.particle_volume[c], nodal_[i * 2 + 1] += beyond_particles(frame, c) * divergence[c];
  PetscCall(frame.grid.sum(nodal_.data(), 2));
  for (int c = 0; c < cells; ++c) {
    double given = 0;
    for (int i : frame.shape[c].node) given += nodal_[i * 2 + 1] / nodal_[i * 2];
    divergence[c] = (frame.weight[c] - beyond_particles(frame, c)) * divergence[c] + frame.particle_volume[c] / (dim + 1) * given;
  }
  PetscFunctionReturn(0);
}

/// The adjoint: a cell presses with the pressure of its particles as far as their volume goes, beyond that with that around it. Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::see_around(const Frame &frame, Array &pressure) requires Phases::suction {
  PetscFunctionBeginUser;
  const int cells = frame.grid.cell_count();
  std::fill_n(nodal_.begin(), frame.grid.node_count() * 2, 0.);
  for (int c = 0; c < cells; ++c)
    for (int i : frame.shape[c].node) nodal_[i * 2] += frame.particle_volume[c], nodal_[i * 2 + 1] += frame.particle_volume[c] * pressure[c];
  PetscCall(frame.grid.sum(nodal_.data(), 2));
  for (int c = 0; c < cells; ++c) {
    double around = 0;
    for (int i : frame.shape[c].node) around += nodal_[i * 2 + 1] / nodal_[i * 2] / (dim + 1);
    pressure[c] += beyond_particles(frame, c) / frame.weight[c] * (around - pressure[c]);
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::exchange(const Frame &frame) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PorePoints &from = points_[b];
    PorePoints &to = frame.trial ? trial_[b] : points_[b];
    const PointSet &set = frame.points[b];
    if (frame.trial) to.room(set.count), std::copy_n(from.share.begin(), set.count, to.share.begin());
    for (int q = 0; q < set.count; ++q) {
      const double part = frame.volume[b][q] / frame.particle_volume[set.cell[q]];
      for (int a = 0; a < fluids; ++a) to.mass[a][q] = from.mass[a][q] - part * divergence_[a][set.cell[q]];
    }
  }
  if (by_rate_) follow_rates(frame);
}

// The naive form, theory (3.5): pressures go on at their rate from those of the last step, and what the curve then gives takes the place of the masses.

template <int dim, class Phases>
void PoreFluid<dim, Phases>::keep_pressures(const Frame &frame) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PorePoints &points = points_[b];
    points.pressure.resize(points.grains.size());
    for (int q = 0; q < frame.points[b].count; ++q)
      points.pressure[q] = points.suction[q] > 0 ? -points.suction[q] : liquid_.pressure_at(points.mass[0][q] / pore_volume(frame.volume[b][q], points.grains[q]));
  }
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::follow_rates(const Frame &frame) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PorePoints &points = points_[b];
    for (int q = 0; q < frame.points[b].count; ++q) {
      const double pores = pore_volume(frame.volume[b][q], points.grains[q]);
      points.mass[0][q] = pores * content_by_rate(soils_[b], liquid_, points.pressure[q], points.mass[0][q] / pores);
    }
  }
}

template <int dim, class Phases>
PoreReport PoreFluid<dim, Phases>::report(int body, int point, int cell, bool surface) const {
  const double *p = smoothed(cell) ? cells_[cell].smooth : cells_[cell].pressure, gas = Phases::gas ? p[fluids - 1] : 0, share = points_[body].share[point];
  double suction = 0;
  if constexpr (Phases::suction) suction = points_[body].suction[point];
  return {p[0], gas, suction, 1 - share, surface};
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::keep(Archive &archive) {
  for (PorePoints &points : points_) {
    archive.keep("pores", points.count, points.grains, points.share, points.suction, points.pressure);
    for (int a = 0; a < fluids; ++a) archive.keep("fluid", points.mass[a]);
  }
  archive.keep("fluids", cells_, nodes_, surface_, moment_, mean_, reference_, rows_, grain_mass_, body_of_node_, out_, given_mass_);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::ledger(bool gathered, FluidLedger *sums) {
  PetscFunctionBeginUser;
  double mine[3 * fluids]{}, all[3 * fluids];
  for (size_t b = 0; b < bodies_.size(); ++b)
    for (int a = 0; a < fluids; ++a) {
      if (gathered)
        for (int q = 0; q < points_[b].count; ++q) mine[3 * a] += points_[b].mass[a][q];
      else
        for (int i = 0; i < bodies_[b]->particles().count; ++i) mine[3 * a] += bodies_[b]->particles().fluid_mass[a][i];
    }
  for (int a = 0; a < fluids; ++a) mine[3 * a + 1] = out_[a], mine[3 * a + 2] = given_mass_[a];
  PetscCallMPI(MPI_Allreduce(mine, all, 3 * fluids, MPI_DOUBLE, MPI_SUM, mesh_.comm()));
  for (int a = 0; a < fluids; ++a) sums[a] = {all[3 * a], all[3 * a + 1], all[3 * a + 2]};
  PetscFunctionReturn(0);
}

}  // namespace talus
