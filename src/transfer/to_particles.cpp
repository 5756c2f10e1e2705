#include <algorithm>

#include "transfer/transfer.h"

namespace talus {

template <int dim, bool averaged>
void to_particles(Body<dim> &body, const FilledGrid<dim> &grid, const NodalUpdate &nodes, double flip, const double *affine,
                  const PointSet &points, std::vector<int> &movers) {
  constexpr int vertices = dim + 1, components = stress_size<dim>;
  const ParticleArrays<dim> &p = body.particles();
  const int history_count = body.history_count();
  for (int i = 0; i < p.count;) {
    const int mesh_cell = p.cell[i], cell = grid.find_cell(mesh_cell);
    const BarycentricMap<dim> coordinates(grid.mesh().cells[mesh_cell]);
    Quad velocity[vertices], displacement[vertices];
    for (int k = 0; k < vertices; ++k) {
      velocity[k] = nodes.velocity[grid.shape[cell].node[k]];
      displacement[k] = nodes.displacement[grid.shape[cell].node[k]];
    }
    [[maybe_unused]] const int point = averaged ? points.of_cell[mesh_cell] : 0;
    [[maybe_unused]] const double growth = averaged ? points.volume[point] / points.start_volume[point] : 1;
    for (; i < p.count && p.cell[i] == mesh_cell; ++i) {
      Quad n = coordinates(p.position[i]), v = quad(flip) * load<dim>(p.velocity[i].data()), x = load<dim>(p.position[i].data());
      for (int k = 0; k < vertices; ++k) {
        v += quad(n[k]) * velocity[k];
        x += quad(n[k]) * displacement[k];
      }
      store<dim>(p.velocity[i].data(), v);
      store<dim>(p.position[i].data(), x);
      n = coordinates(p.position[i]);
      double nearest = std::min(n[0], n[1]);
      for (int k = 2; k < vertices; ++k) nearest = std::min(nearest, n[k]);
      if (!(nearest >= 0)) movers.push_back(i);
      if constexpr (averaged) {
        for (int s = 0; s < components; ++s) p.stress[i * components + s] = points.stress[point * components + s];
        for (int h = 0; h < history_count; ++h)
          p.history[i * history_count + h] += points.history[point * history_count + h] - points.start_history[point * history_count + h];
        p.volume[i] = std::min(p.volume[i] * growth, body.volume_limit(p.initial_volume[i], p.history + i * history_count));
      }
      if (affine) std::copy_n(&affine[cell * dim * dim], dim * dim, &p.affine[i * dim * dim]);
    }
  }
}

template <int dim>
PetscErrorCode relocate(Body<dim> &body, const BackgroundMesh<dim> &mesh, std::vector<int> &movers, bool *lost, Vec<dim> *where) {
  PetscFunctionBeginUser;
  std::vector<std::pair<int, int>> leavers;  // allocated only when particles change rank, as the swarm's own buffers are
  const bool alone = mesh.partition_faces.empty();
  while (true) {
    leavers.clear();
    const ParticleArrays<dim> &p = body.particles();
    for (int i : movers) {
      const Located at = walk(mesh, p.cell[i], p.position[i]);
      if (at.outside && !*lost) *lost = true, *where = p.position[i];
      p.cell[i] = at.cell;
      if (at.partition_face >= 0) {
        const PartitionFace &face = mesh.partition_faces[at.partition_face];
        p.cell[i] = face.cell;  // the walk goes on there
        leavers.emplace_back(i, face.rank);
      }
    }
    movers.clear();
    int leaving = !leavers.empty(), any = leaving, arrival;
    int ranks;
    PetscCallMPI(MPI_Comm_size(mesh.comm(), &ranks));
    if (alone && ranks == 1) break;
    PetscCallMPI(MPI_Allreduce(&leaving, &any, 1, MPI_INT, MPI_MAX, mesh.comm()));
    if (!any) break;
    PetscCall(body.migrate(leavers, &arrival));
    for (int i = arrival; i < body.particles().count; ++i) movers.push_back(i);
  }
  PetscFunctionReturn(0);
}

template void to_particles<2, true>(Body<2> &, const FilledGrid<2> &, const NodalUpdate &, double, const double *, const PointSet &, std::vector<int> &);
template void to_particles<2, false>(Body<2> &, const FilledGrid<2> &, const NodalUpdate &, double, const double *, const PointSet &, std::vector<int> &);
template void to_particles<3, true>(Body<3> &, const FilledGrid<3> &, const NodalUpdate &, double, const double *, const PointSet &, std::vector<int> &);
template void to_particles<3, false>(Body<3> &, const FilledGrid<3> &, const NodalUpdate &, double, const double *, const PointSet &, std::vector<int> &);
template PetscErrorCode relocate<2>(Body<2> &, const BackgroundMesh<2> &, std::vector<int> &, bool *, Vec<2> *);
template PetscErrorCode relocate<3>(Body<3> &, const BackgroundMesh<3> &, std::vector<int> &, bool *, Vec<3> *);

}  // namespace talus
