// Work of the ranks, and a new partition of the mesh.
#include "simulation/world.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {

template <int dim>
double World<dim>::work_of_rank() const {
  double work = rates_.per_cell * motion->grid().cell_count() + rates_.per_run * runs_;
  for (const auto &body : bodies) work += body->particles().count;
  return work;
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
  runs_ = 0;
  for_each_run(bodies, [this](int) { ++runs_; });
}

template <int dim>
std::vector<FilledCell<dim>> World<dim>::work_of_cells(double step) const {
  std::vector<FilledCell<dim>> all(mesh.cell_count()), filled;
  for (const auto &body : bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i)
      all[p.cell[i]].weight += 1, map<dim>(all[p.cell[i]].way) += map<dim>(p.velocity[i]);
  }
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (all[c].weight == 0) continue;
    filled.push_back({mesh.global_cell[c], all[c].weight + rates_.per_cell, {}});
    map<dim>(filled.back().way) = step / all[c].weight * map<dim>(all[c].way);
    all[c].number = static_cast<long long>(filled.size()) - 1;
  }
  for_each_run(bodies, [&](int cell) { filled[all[cell].number].weight += rates_.per_run; });
  return filled;
}

template <int dim>
void World<dim>::divide(const Cuts &cuts) {
  for (const auto &body : bodies) require(body->resize(0));
  const Loading<dim> loading = motion->loading;
  std::vector<Source> sources = conditions.sources();
  const bool stand_ins = conditions.uses_stand_ins();
  mesh = mesh.divided(cuts), comm = mesh.comm();
  conditions = Conditions<dim>();
  require(conditions.setup(mesh, std::move(sources)));
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

template double World<2>::work_of_rank() const;
template double World<3>::work_of_rank() const;
template void World<2>::count_runs();
template void World<3>::count_runs();
template std::vector<FilledCell<2>> World<2>::work_of_cells(double) const;
template std::vector<FilledCell<3>> World<3>::work_of_cells(double) const;
template void World<2>::divide(const Cuts &);
template void World<3>::divide(const Cuts &);

}  // namespace talus
