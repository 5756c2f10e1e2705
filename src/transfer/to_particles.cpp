#include <algorithm>
#include <limits>

#include "transfer/runs.h"

namespace talus {

template <int dim, bool averaged, int fluids>
void to_particles(Body<dim> &body, const Lagrangian<dim> &from, std::vector<int> &movers) {
  const ParticleArrays<dim> &p = body.particles();
  if constexpr (averaged) collect_changes<fluids>(from.points, from.pores, body.history_count(), from.change);
  for (int i = 0; i < p.count;) {
    const int mesh_cell = p.cell[i], first = i;
    const RunFromNodes<dim, averaged, fluids> run(body, from, mesh_cell);
    for (; i < p.count && p.cell[i] == mesh_cell; ++i) {
      const auto moved = run.move(i);
      if (!none_negative(moved.coordinates)) movers.push_back(i);
      run.give(i, moved.pores);
    }
    run.move_rest(first, i);
  }
}

template <int dim, bool averaged, int fluids>
void to_next_nodes(Body<dim> &body, const Lagrangian<dim> &from, FilledGrid<dim> &grid, Vec<dim> *momentum,
                   PointSet &points, const Pores<dim> &pores, std::vector<int> &movers) {
  const ParticleArrays<dim> &p = body.particles();
  if constexpr (averaged) collect_changes<fluids>(from.points, from.pores, body.history_count(), from.change);
  for (int i = 0; i < p.count;) {
    const int mesh_cell = p.cell[i], first = i;
    const RunFromNodes<dim, averaged, fluids> old(body, from, mesh_cell);
    RunToNodes<dim, averaged, fluids> next(body, grid, points, pores, mesh_cell);
    while (i < p.count && p.cell[i] == mesh_cell) {
      int leaving[run_part], left = 0;
      double pores_left[run_part];
      const int start = i, end = std::min(p.count, i + run_part);
      for (; i < end && p.cell[i] == mesh_cell; ++i) {
        const auto moved = old.move(i);
        const bool stays = none_negative(moved.coordinates);
        leaving[left] = i, pores_left[left] = moved.pores;
        left += !stays;
        if (!stays) continue;
        next.add(i, moved.coordinates);
        if constexpr (averaged && fluids > 0) next.add_pores(moved.pores);
      }
      old.move_rest(start, i);
      for (int k = 0; k < left; ++k) old.give(leaving[k], pores_left[k]);
      movers.insert(movers.end(), leaving, leaving + left);
    }
    const int point = next.finish(momentum, old.stress, old.content);
    if (body.history_count() > unrolled_history && point >= 0)
      for (int k = first; k < i; ++k)
        if (none_negative(old.coordinates(load<dim>(p.position[k].data())))) next.add_rest(k, point);
  }
}

template <int dim>
PetscErrorCode relocate(Body<dim> &body, const BackgroundMesh<dim> &mesh, std::vector<int> &movers,
                        std::vector<LeftMesh> &outside) {
  PetscFunctionBeginUser;
  // a cell from here up to half of it is the face by which a particle left; outlives a migration, as complements do
  constexpr PetscInt outside_from = std::numeric_limits<PetscInt>::min();
  std::vector<std::pair<int, int>>
      leavers;  // allocated only when particles change rank, as the swarm's own buffers are
  const bool alone = mesh.partition_faces.empty();
  bool migrated = false;
  size_t first =
      0;  // movers before it have arrived; their cell is marked by its complement, which outlives a migration
  int ranks;
  PetscCallMPI(MPI_Comm_size(mesh.comm(), &ranks));
  while (true) {
    leavers.clear();
    ParticleArrays<dim> &p = body.particles();
    for (; first < movers.size(); ++first) {
      const int i = movers[first];
      const Located at = walk(mesh, p.cell[i], p.position[i]);
      p.cell[i] = at.left_by >= 0 ? outside_from + at.cell * (dim + 1) + at.left_by : ~at.cell;
      if (at.partition_face >= 0) {
        const PartitionFace &face = mesh.partition_faces[at.partition_face];
        p.cell[i] = face.cell;  // the walk goes on there
        leavers.emplace_back(i, face.rank);
      }
    }
    int leaving = !leavers.empty(), any = leaving, arrival;
    if (alone && ranks == 1) break;
    PetscCallMPI(MPI_Allreduce(&leaving, &any, 1, MPI_INT, MPI_MAX, mesh.comm()));
    if (!any) break;
    PetscCall(body.migrate(mesh, leavers, &arrival));
    migrated = true, first = movers.size();
    for (int i = arrival; i < body.particles().count; ++i) movers.push_back(i);
  }
  ParticleArrays<dim> &p = body.particles();
  if (migrated) {  // particles have changed places
    movers.clear();
    for (int i = 0; i < p.count; ++i)
      if (p.cell[i] < 0) movers.push_back(i);
  }
  outside.clear();
  size_t inside = 0;
  for (const int i : movers)
    if (const PetscInt face = p.cell[i] - outside_from; p.cell[i] < outside_from / 2)
      outside.push_back({i, static_cast<int>(face / (dim + 1)), static_cast<int>(face % (dim + 1))});
    else
      p.cell[i] = ~p.cell[i], movers[inside++] = i;
  movers.resize(inside);
  PetscFunctionReturn(0);
}

#define TALUS_TO_PARTICLES(dim, averaged, fluids)                                                              \
  template void to_particles<dim, averaged, fluids>(Body<dim> &, const Lagrangian<dim> &, std::vector<int> &); \
  template void to_next_nodes<dim, averaged, fluids>(Body<dim> &, const Lagrangian<dim> &, FilledGrid<dim> &,  \
                                                     Vec<dim> *, PointSet &, const Pores<dim> &, std::vector<int> &);
TALUS_EACH_TRANSFER(TALUS_TO_PARTICLES)
template PetscErrorCode relocate(Body<2> &, const BackgroundMesh<2> &, std::vector<int> &, std::vector<LeftMesh> &);
template PetscErrorCode relocate(Body<3> &, const BackgroundMesh<3> &, std::vector<int> &, std::vector<LeftMesh> &);

}  // namespace talus
