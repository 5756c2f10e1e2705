// Implementation of PoreFluid; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"
#include "scene/scene.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"

namespace talus {

template <int dim, class Phases>
PoreFluid<dim, Phases>::PoreFluid(const BackgroundMesh<dim> &mesh, std::vector<std::unique_ptr<Body<dim>>> &bodies,
                                  const Scene &scene, bool implicit)
    : mesh_(mesh),
      bodies_(bodies),
      scene_(scene),
      liquid_(*scene.water),
      gas_(*scene.gas),
      pressure_(scene),
      bishop_(scene.water->stress == PoreStress::bishop),
      smoothing_(scene.transfer->pore_smoothing == PoreSmoothing::nodal),
      patches_(scene.transfer->locking == Locking::patches),
      explicit_drag_(scene.water->drag == PoreDrag::at_start),
      by_rate_(scene.water->storage == PoreStorage::rate),
      implicit_(implicit),
      points_(bodies.size()),
      next_points_(bodies.size()),
      trial_(bodies.size()) {
  const size_t nodes = mesh.node_count(), cells = mesh.cell_count();
  const double gravity = scene.gravity_size();
  constexpr double earth = 9.81;  // [m/s2], for a hydraulic conductivity in a scene without gravity
  for (const auto &body : bodies)
    soils_.emplace_back(body->source(), scene.water->density * (gravity > 0 ? gravity : earth), scene.water->viscosity);
  make_room(cells_, cells), make_room(nodes_, nodes), make_room(mean_, cells), make_room(reference_, cells);
  make_room(rows_, cells), make_room(head_, cells), make_room(grain_mass_, cells), make_room(nodal_head_, nodes);
  for (auto *field : {&surface_, &moment_, &gap_}) make_room(*field, nodes);
  make_room(momentum_, nodes), make_room(beyond_, nodes), make_room(body_of_node_, nodes);
  for (int a = 0; a < fluids; ++a) {
    make_room(flux_[a], nodes), make_room(gap_flux_[a], nodes), make_room(impulse_[a], cells);
    make_room(divergence_[a], cells), make_room(smooth_[a], cells);
  }
  make_room(nodal_, 4 * nodes);
  if constexpr (Phases::suction) make_room(patch_pores_, mesh.patch_count);
  if constexpr (Phases::gas) make_room(uptake_, cells);
  for (auto *all : {&points_, &next_points_})
    for (size_t b = 0; b < bodies.size(); ++b)
      (*all)[b].reserve(scene.transfer->average_stress ? static_cast<int>(cells) : bodies[b]->particles().count);
}

// ---- first state ----

template <int dim, class Phases>
double PoreFluid<dim, Phases>::prescribed_pressure(const Vec<dim> &x, double t) const {
  double p = pressure_(x, t, common_water);
  if constexpr (Phases::suction)
    if (!pressure_.below_table(x, t, common_water))
      p -= scene_.water->suction.given() ? scene_.water->suction(x[0], x[1], dim == 3 ? x[dim - 1] : 0, t)
                                         : pressure_.above_table(x, t);
  return p;
}

template <int dim, class Phases>
double PoreFluid<dim, Phases>::prescribed_gas_pressure(const Vec<dim> &x) const {
  if constexpr (Phases::gas) return scene_.gas->pressure(x[0], x[1], dim == 3 ? x[dim - 1] : 0, 0);
  return 0;
}

/// Masses of liquid and gas per pore volume [kg/m3] and gas share, at a liquid pressure that is counted from the
/// pressure of the gas. Free gas, and the liquid with it, has the gauge pressure `gas_pressure`.
template <int dim, class Phases>
std::array<double, 3> PoreFluid<dim, Phases>::contents(const SoilPores &soil, double pressure,
                                                       double gas_pressure) const {
  double share = 0, gas = 0;
  if constexpr (Phases::suction) share = pressure < 0 ? 1 - talus::saturation(soil.retention(), -pressure) : 0;
  if constexpr (Phases::gas) {  // below the water table the residual gas is in equilibrium with the water
    const bool trapped = share < residual_gas;
    share = std::max(share, residual_gas);
    gas = share * gas_.density_at(trapped ? std::max(0., pressure + soil.suction(share)) : gas_pressure);
    if (!trapped) pressure += gas_pressure;
  }
  return {(1 - share) * liquid_.density_at(pressure), gas, share};
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::fill(double t) {
  fill([&](int, const Vec<dim> &x) { return prescribed_pressure(x, t); });
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::fill(const std::function<double(int, const Vec<dim> &)> &liquid) {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    ParticleArrays<dim> &p = bodies_[b]->particles();
    const double grain_density = bodies_[b]->grain_density();
    for (int i = 0; i < p.count; ++i) {
      const auto content =
          contents(soils_[b], liquid(p.cell[i], p.position[i]), prescribed_gas_pressure(p.position[i]));
      for (int a = 0; a < fluids; ++a) {
        p.fluid_mass[a][i] = content[a] * (p.volume[i] - p.mass[i] / grain_density);
        p.fluid_velocity[a][i] = p.velocity[i];
      }
    }
  }
}

// ---- reports ----

template <int dim, class Phases>
PoreReport PoreFluid<dim, Phases>::report(int body, int point, int cell, bool surface) const {
  const double *p = smoothed(cell) ? cells_[cell].smooth : cells_[cell].pressure, gas = Phases::gas ? p[fluids - 1] : 0,
               share = points_[body].share[point];
  double suction = 0;
  if constexpr (Phases::suction) suction = points_[body].suction[point];
  return {p[0], gas, suction, 1 - share, surface};
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::serialize(Archive &archive, const typename FilledGrid<dim>::Rows &grid,
                                       const std::vector<Archive::Rows> &points_of_bodies) {
  for (size_t b = 0; b < points_.size(); ++b) {
    const Archive::Rows &rows = points_of_bodies[b];
    PorePoints &points = points_[b];
    if (archive.reading()) points.count = static_cast<int>(rows.count), points.reserve(points.count);
    archive.column(rows, "volume of grains", points.grains);
    archive.column(rows, "share of gas", points.share);
    archive.column(rows, "suction of points", points.suction);
    archive.column(rows, "pressure of points", points.pressure);
    for (int a = 0; a < fluids; ++a) archive.column(rows, "mass of a fluid", points.mass[a]);
  }
  archive.column(grid.cells, "pores of cells", cells_);
  archive.column(grid.cells, "mean place", mean_);
  archive.column(grid.cells, "place of pressure", reference_);
  archive.column(grid.cells, "rows of the mass matrix", rows_);
  archive.column(grid.cells, "mass of grains", grain_mass_);
  archive.column(grid.nodes, "pores of nodes", nodes_);
  archive.column(grid.nodes, "surface", surface_);
  archive.column(grid.nodes, "moment of the surface", moment_);
  archive.column(grid.nodes, "body of a node", body_of_node_);
  archive.sums("fluids", out_, prescribed_mass_);
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
  for (int a = 0; a < fluids; ++a) mine[3 * a + 1] = out_[a], mine[3 * a + 2] = prescribed_mass_[a];
  PetscCallMPI(MPI_Allreduce(mine, all, 3 * fluids, MPI_DOUBLE, MPI_SUM, mesh_.comm()));
  for (int a = 0; a < fluids; ++a) sums[a] = {all[3 * a], all[3 * a + 1], all[3 * a + 2]};
  PetscFunctionReturn(0);
}

}  // namespace talus

#include "physics/pores/pore_fluid/drag.inl"
#include "physics/pores/pore_fluid/exchange.inl"
#include "physics/pores/pore_fluid/forces.inl"
#include "physics/pores/pore_fluid/implicit.inl"
#include "physics/pores/pore_fluid/pressures.inl"
#include "physics/pores/pore_fluid/remap.inl"
