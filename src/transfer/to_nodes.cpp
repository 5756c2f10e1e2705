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

}  // namespace

template <int dim, bool averaged, int fluids>
void to_nodes(const Body<dim> &body, FilledGrid<dim> &grid, Vec<dim> *momentum, PointSet &points,
              const Pores<dim> &pores, const std::vector<int> *only) {
  if (only)
    gather<dim, averaged, fluids>(body, grid, momentum, points, pores, static_cast<int>(only->size()),
                                  [only](int j) { return (*only)[j]; });
  else
    gather<dim, averaged, fluids>(body, grid, momentum, points, pores, body.particles().count, [](int j) { return j; });
  if constexpr (averaged)
    points.start(stress_size<dim>, body.history_count());
  else
    for (int i = 0; i < body.particles().count; ++i) points.own_cell[i] = grid.find_cell(body.particles().cell[i]);
}

#define TALUS_TO_NODES(dim, averaged, fluids)                                                                 \
  template void to_nodes<dim, averaged, fluids>(const Body<dim> &, FilledGrid<dim> &, Vec<dim> *, PointSet &, \
                                                const Pores<dim> &, const std::vector<int> *);
TALUS_EACH_TRANSFER(TALUS_TO_NODES)

}  // namespace talus
