// Work of the ranks, and a new partition of the mesh.
#include "simulation/world.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {

template <int dim>
double World<dim>::work_of_rank(long long steps) const {
  WorkCounts counts = counts_;
  counts.cells = motion->grid().cell_count();
  for (const auto &body : bodies) counts.particles += body->particles().count;
  return steps > 0 ? rates_.of(counts, static_cast<double>(steps)) : rates_.of(counts);
}

namespace {

/// Calls `use` with the cell of each run (simulation/work.h) of the bodies.
template <int dim, class Use>
void for_each_run(const std::vector<std::unique_ptr<Body<dim>>> &bodies, Use use) {
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i)
      if (i == 0 || p.cell[i] != p.cell[i - 1]) use(p.cell[i]);
  }
}

}  // namespace

template <int dim>
void World<dim>::count_runs() {
  int ranks;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) return;  // which shares its work with nobody
  counts_.runs = 0;
  for (const auto &body : bodies) {  // the sum of comparisons is fast, and this is done at every remap
    const ParticleArrays<dim> &p = body->particles();
    int runs = p.count > 0;
    for (int i = 1; i < p.count; ++i) runs += p.cell[i] != p.cell[i - 1];
    counts_.runs += runs;
  }
}

template <int dim>
void World<dim>::count_cells() {
  long long mine = motion->grid().cell_count();
  MPI_Allreduce(&mine, &cell_count, 1, MPI_LONG_LONG, MPI_SUM, comm);
}

/// Particles change places in memory when they are sorted: what is kept of the movers is their cells.
template <int dim>
void World<dim>::count_movers() {
  int ranks;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) return;
  cells_of_movers_.clear();
  for (size_t b = 0; b < bodies.size(); ++b)
    for (const int i : movers_[b]) cells_of_movers_.push_back(bodies[b]->particles().cell[i]);
  counts_.movers = static_cast<double>(cells_of_movers_.size());
}

template <int dim>
std::vector<FilledCell<dim>> World<dim>::work_of_cells(double step, long long steps) const {
  std::vector<WorkCounts> counts(mesh.cell_count());
  std::vector<Vec<dim>> speed(mesh.cell_count(), Vec<dim>{});  // sums over particles
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i)
      counts[p.cell[i]].particles += 1, map<dim>(speed[p.cell[i]]) += map<dim>(p.velocity[i]);
  }
  for_each_run(bodies, [&](int cell) { counts[cell].runs += 1; });
  for (const int cell : cells_of_movers_) counts[cell].movers += 1;
  std::vector<FilledCell<dim>> filled;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (counts[c].particles == 0) continue;
    counts[c].cells = 1;
    const double work = rates_.of(counts[c], static_cast<double>(steps));
    filled.push_back({mesh.global_cell[c % mesh.cells_in_sheet()], WorkRates::without_round_off(work), {}});
    map<dim>(filled.back().way) = step / counts[c].particles * map<dim>(speed[c]);
  }
  return filled;
}

template <int dim>
void World<dim>::divide(const Cuts &cuts) {
  for (const auto &body : bodies) require(body->resize(0));
  const Loading<dim> loading = motion->loading;
  std::vector<Source> sources = conditions.sources();
  const bool stand_ins = conditions.uses_stand_ins();
  mesh = mesh.divided(cuts), comm = mesh.comm();
  separate_groups();
  tie_sides(sources, false);
  conditions = Conditions<dim>();
  require(conditions.setup(mesh, std::move(sources)));
  take_rigid_bodies(), take_soil_contact(), take_structures();
  conditions.use_stand_ins(stand_ins), conditions.bases().remember_slip(loading.softening);
  pressure.set_regions(bodies_of_cells(mesh, scene));
  set_pore_pressure_ratios();
  settle_bodies();
  close_bases();
  set_friction_delay();
  make_motion();
  motion->loading = loading;
  require(motion->setup_pores(false));
}

template double World<2>::work_of_rank(long long) const;
template double World<3>::work_of_rank(long long) const;
template void World<2>::count_cells();
template void World<3>::count_cells();
template void World<2>::count_runs();
template void World<3>::count_runs();
template void World<2>::count_movers();
template void World<3>::count_movers();
template std::vector<FilledCell<2>> World<2>::work_of_cells(double, long long) const;
template std::vector<FilledCell<3>> World<3>::work_of_cells(double, long long) const;
template void World<2>::divide(const Cuts &);
template void World<3>::divide(const Cuts &);

}  // namespace talus
