#include "transfer/runs.h"

namespace talus {
namespace {

template <int dim, bool averaged, int fluids, class Index>
void gather(const Body<dim> &body, FilledGrid<dim> &grid, Vec<dim> *momentum, PointSet &points, const Pores<dim> &pores,
            int count, Index index) {
  const ParticleArrays<dim> &p = body.particles();
  for (int j = 0; j < count;) {
    const int mesh_cell = p.cell[index(j)];
    const BarycentricMap<dim> coordinates(grid.mesh().cells[mesh_cell]);
    RunToNodes<dim, averaged, fluids> run(body, grid, points, pores, mesh_cell);
    const int first = j;
    for (; j < count && p.cell[index(j)] == mesh_cell; ++j) {
      run.add(index(j), coordinates(load<dim>(p.position[index(j)].data())));
      if constexpr (averaged) run.add_own(index(j));
    }
    const int point = run.finish(momentum, nullptr, nullptr);
    if (body.history_count() > unrolled_history && point >= 0)
      for (int k = first; k < j; ++k) run.add_rest(index(k), point);
  }
}

/// Shares of strength at the stress points: means of those of the particles, weighted by volume.
template <int dim>
void average_shares(const ParticleArrays<dim> &p, PointSet &points) {
  std::fill_n(points.own_cohesion_share.begin(), points.count, 0.);
  std::fill_n(points.own_friction_share.begin(), points.count, 0.);
  for (int i = 0; i < p.count; ++i) {
    const int q = points.find(p.cell[i]);
    const double weight = p.volume[i] / points.own_volume[q];
    points.own_cohesion_share[q] += weight * p.cohesion_share[i];
    points.own_friction_share[q] += weight * p.friction_share[i];
  }
}

/// Lets each particle be a point of its own.
template <int dim>
void take_particles(const ParticleArrays<dim> &p, const FilledGrid<dim> &grid, PointSet &points) {
  points.own_cell.resize(std::max<size_t>(points.own_cell.size(), p.count));
  for (int i = 0; i < p.count; ++i) points.own_cell[i] = grid.find_cell(p.cell[i]);
  points.count = p.count;
}

}  // namespace

template <int dim, bool averaged, int fluids>
void to_nodes(const Body<dim> &body, FilledGrid<dim> &grid, Vec<dim> *momentum, PointSet &points,
              const Pores<dim> &pores, const std::vector<int> *only) {
  const ParticleArrays<dim> &p = body.particles();
  if (only)
    gather<dim, averaged, fluids>(body, grid, momentum, points, pores, static_cast<int>(only->size()),
                                  [only](int j) { return (*only)[j]; });
  else
    gather<dim, averaged, fluids>(body, grid, momentum, points, pores, p.count, [](int j) { return j; });
  if constexpr (averaged) {
    points.start(stress_size<dim>, body.history_count());
    if (p.cohesion_share) average_shares(p, points);
  } else {
    take_particles(p, grid, points);
  }
}

#define TALUS_TO_NODES(dim, averaged, fluids)                                                                 \
  template void to_nodes<dim, averaged, fluids>(const Body<dim> &, FilledGrid<dim> &, Vec<dim> *, PointSet &, \
                                                const Pores<dim> &, const std::vector<int> *);
TALUS_EACH_TRANSFER(TALUS_TO_NODES)

}  // namespace talus
