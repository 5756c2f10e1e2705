#include "meshes/plex.h"

#include <petscsf.h>

#include <algorithm>
#include <map>

#include "meshes/halo.h"
#include "meshes/simplex.h"

namespace talus {
namespace {

/// Vertices of a facet: the ends of an edge, or the ends of the edges of a triangle.
template <int dim>
PetscErrorCode facet_vertices(DM plex, PetscInt facet, std::array<PetscInt, dim> &vertex) {
  const PetscInt *cone, *ends;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetCone(plex, facet, &cone));
  if constexpr (dim == 2) {
    vertex = {cone[0], cone[1]};
  } else {
    PetscCall(DMPlexGetCone(plex, cone[0], &ends));
    vertex[0] = ends[0], vertex[1] = ends[1];
    PetscCall(DMPlexGetCone(plex, cone[1], &ends));
    vertex[2] = ends[0] == vertex[0] || ends[0] == vertex[1] ? ends[1] : ends[0];
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode read_positions(DM plex, PetscInt first, PetscInt end, std::vector<Vec<dim>> &position) {
  ::Vec coordinates;
  PetscSection section;
  const PetscScalar *x;
  PetscFunctionBeginUser;
  PetscCall(DMGetCoordinatesLocal(plex, &coordinates));
  PetscCall(DMGetCoordinateSection(plex, &section));
  position.resize(end - first);
  if (first == end) PetscFunctionReturn(0);
  PetscCall(VecGetArrayRead(coordinates, &x));
  for (PetscInt v = first; v < end; ++v) {
    PetscInt offset;
    PetscCall(PetscSectionGetOffset(section, v, &offset));
    for (int d = 0; d < dim; ++d) position[v - first][d] = x[offset + d];  // a third coordinate of a 2D mesh is dropped
  }
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode read_cell_nodes(DM plex, PetscInt cell, PetscInt first_vertex, PetscInt end_vertex,
                               std::array<int, dim + 1> &node) {
  PetscInt *closure = nullptr, count;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetTransitiveClosure(plex, cell, PETSC_TRUE, &count, &closure));
  int k = 0;
  for (PetscInt i = 0; i < count && k <= dim; ++i)
    if (closure[2 * i] >= first_vertex && closure[2 * i] < end_vertex)
      node[k++] = static_cast<int>(closure[2 * i] - first_vertex);
  PetscCall(DMPlexRestoreTransitiveClosure(plex, cell, PETSC_TRUE, &count, &closure));
  PetscFunctionReturn(0);
}

/// The plex's cells, in its own order, and the plex points of their sides.
template <int dim>
struct PlexCells {
  PetscInt first_cell = 0, first_vertex = 0;
  std::vector<std::array<PetscInt, dim + 1>> facet;  ///< opposite to node k
};

/// Fills `facet` and `neighbour` of one cell, by the node opposite to each face.
template <int dim>
PetscErrorCode read_faces(DM plex, int cell, PlexCells<dim> &of, Simplices<dim> &s) {
  const PetscInt point = cell + of.first_cell, *cone, *support;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetCone(plex, point, &cone));
  for (int f = 0; f <= dim; ++f) {
    std::array<PetscInt, dim> vertex{};
    PetscInt sharing;
    PetscCall(facet_vertices<dim>(plex, cone[f], vertex));
    int opposite = 0;
    while (opposite < dim && std::count(vertex.begin(), vertex.end(), s.node[cell][opposite] + of.first_vertex))
      ++opposite;
    PetscCall(DMPlexGetSupportSize(plex, cone[f], &sharing));
    PetscCall(DMPlexGetSupport(plex, cone[f], &support));
    of.facet[cell][opposite] = cone[f];
    s.neighbour[cell][opposite] =
        sharing < 2 ? -1 : static_cast<int>((support[0] == point ? support[1] : support[0]) - of.first_cell);
    if (sharing > 2) s.crowded = cell;
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode read_cells(DM plex, PlexCells<dim> &of, Simplices<dim> &s) {
  PetscInt end_cell, end_vertex;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(plex, 0, &of.first_cell, &end_cell));
  PetscCall(DMPlexGetDepthStratum(plex, 0, &of.first_vertex, &end_vertex));
  PetscCall(read_positions<dim>(plex, of.first_vertex, end_vertex, s.position));
  const int count = static_cast<int>(end_cell - of.first_cell);
  s.node.resize(count), s.neighbour.resize(count), of.facet.resize(count);
  for (int c = 0; c < count; ++c) {
    PetscCall(read_cell_nodes<dim>(plex, c + of.first_cell, of.first_vertex, end_vertex, s.node[c]));
    // the order of the closure turns every tetrahedron inside out
    if (Simplex<dim>(s.corners(c)).volume < 0) std::swap(s.node[c][dim - 1], s.node[c][dim]);
    PetscCall(read_faces<dim>(plex, c, of, s));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode local_names(DM plex, std::vector<std::string> &names) {
  PetscInt count;
  PetscFunctionBeginUser;
  PetscCall(DMGetNumLabels(plex, &count));
  for (PetscInt i = 0; i < count; ++i) {
    const char *name;
    PetscCall(DMGetLabelName(plex, i, &name));
    if (!is_reserved_label(name)) names.emplace_back(name);
  }
  std::sort(names.begin(), names.end());
  PetscFunctionReturn(0);
}

/// Local points of a label at a height (0: cells, 1: facets), ascending; none when there is no such label.
PetscErrorCode points_at_height(DM plex, const std::string &name, int height, std::vector<PetscInt> &points) {
  DMLabel label;
  IS values;
  const PetscInt *value;
  PetscInt count, first, end;
  PetscFunctionBeginUser;
  points.clear();
  PetscCall(DMGetLabel(plex, name.c_str(), &label));
  if (!label) PetscFunctionReturn(0);
  PetscCall(DMPlexGetHeightStratum(plex, height, &first, &end));
  PetscCall(DMLabelGetValueIS(label, &values));
  PetscCall(ISGetLocalSize(values, &count));
  PetscCall(ISGetIndices(values, &value));
  for (PetscInt i = 0; i < count; ++i) {
    IS stratum;
    const PetscInt *point;
    PetscInt size;
    PetscCall(DMLabelGetStratumIS(label, value[i], &stratum));
    if (!stratum) continue;
    PetscCall(ISGetLocalSize(stratum, &size));
    PetscCall(ISGetIndices(stratum, &point));
    std::copy_if(point, point + size, std::back_inserter(points), [=](PetscInt p) { return first <= p && p < end; });
    PetscCall(ISRestoreIndices(stratum, &point));
    PetscCall(ISDestroy(&stratum));
  }
  PetscCall(ISRestoreIndices(values, &value));
  PetscCall(ISDestroy(&values));
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode read_names(DM plex, const PlexCells<dim> &of, MeshPart<dim> &part) {
  std::vector<std::string> labels;
  std::vector<PetscInt> points;
  std::vector<std::pair<std::string, std::vector<int>>> cells_of;
  PetscFunctionBeginUser;
  PetscCall(local_names(plex, labels));
  for (const std::string &label : labels) {
    PetscCall(points_at_height(plex, label, 0, points));
    cells_of.emplace_back(label, std::vector<int>{});
    for (PetscInt p : points) cells_of.back().second.push_back(static_cast<int>(p - of.first_cell));
    PetscCall(points_at_height(plex, label, 1, points));
    std::vector<Side> sides;
    for (PetscInt p : points) {
      PetscInt count;
      const PetscInt *support;
      PetscCall(DMPlexGetSupportSize(plex, p, &count));
      PetscCall(DMPlexGetSupport(plex, p, &support));
      for (PetscInt i = 0; i < count; ++i) {
        const int cell = static_cast<int>(support[i] - of.first_cell);
        const auto &around = of.facet[cell];
        sides.push_back({cell, static_cast<int>(std::find(around.begin(), around.end(), p) - around.begin())});
      }
    }
    std::sort(sides.begin(), sides.end());
    if (!sides.empty()) part.groups.emplace_back(label, std::move(sides));
  }
  part.regions = combine(static_cast<int>(of.facet.size()), std::move(cells_of));
  PetscFunctionReturn(0);
}

/// Numbers that an index set gives to local cells or points, unique over all ranks.
PetscErrorCode read_numbers(IS numbering, std::vector<long long> &number) {
  const PetscInt *index;
  PetscInt count;
  PetscFunctionBeginUser;
  PetscCall(ISGetLocalSize(numbering, &count));
  PetscCall(ISGetIndices(numbering, &index));
  for (PetscInt p = 0; p < count; ++p) number.push_back(index[p] < 0 ? -index[p] - 1 : index[p]);
  PetscCall(ISRestoreIndices(numbering, &index));
  PetscFunctionReturn(0);
}

struct RankAndPoint {
  PetscInt rank, point;
};

/// Local points that other ranks hold too.
struct SharedPoints {
  PetscInt begin, end;                 ///< chart
  std::vector<char> is_ghost;          ///< another rank owns the point
  std::vector<RankAndPoint> across;    ///< a holder on another rank, the owner for a ghost; rank -1 where there is none
  std::vector<std::vector<int>> with;  ///< all other ranks
};

PetscErrorCode shared_points(DM plex, SharedPoints &points) {
  const MPI_Comm comm = PetscObjectComm((PetscObject)plex);
  PetscSF sf;
  PetscInt roots, leaves;
  const PetscInt *local, *degree;
  const PetscSFNode *remote;
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(DMPlexGetChart(plex, &points.begin, &points.end));
  points.is_ghost.assign(points.end, 0), points.across.assign(points.end, {-1, -1}), points.with.resize(points.end);
  PetscCall(DMGetPointSF(plex, &sf));
  PetscCall(PetscSFGetGraph(sf, &roots, &leaves, &local, &remote));
  if (roots < 0) PetscFunctionReturn(0);  // a serial plex may come without a graph
  std::vector<RankAndPoint> mine(points.end), at_owner(points.end, {-1, -1});
  for (PetscInt p = 0; p < points.end; ++p) mine[p] = {rank, p};
  PetscCall(PetscSFReduceBegin(sf, MPIU_2INT, mine.data(), at_owner.data(), MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(sf, MPIU_2INT, mine.data(), at_owner.data(), MPI_REPLACE));
  points.across = at_owner;
  for (PetscInt i = 0; i < leaves; ++i) {
    const PetscInt p = local ? local[i] : i;
    points.is_ghost[p] = 1, points.across[p] = {remote[i].rank, remote[i].index};
    points.with[p].push_back(static_cast<int>(remote[i].rank));
  }

  // the owner learns the ranks of all ghosts of its points, and tells them one by one
  PetscCall(PetscSFComputeDegreeBegin(sf, &degree));
  PetscCall(PetscSFComputeDegreeEnd(sf, &degree));
  std::vector<PetscInt> first(roots + 1, 0), ranks(points.end, rank);
  for (PetscInt p = 0; p < roots; ++p) first[p + 1] = first[p] + degree[p];
  std::vector<PetscInt> ghosts(first[roots]);
  PetscCall(PetscSFGatherBegin(sf, MPIU_INT, ranks.data(), ghosts.data()));
  PetscCall(PetscSFGatherEnd(sf, MPIU_INT, ranks.data(), ghosts.data()));
  PetscInt most = roots ? *std::max_element(degree, degree + roots) : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPIU_INT, MPI_MAX, comm));
  for (PetscInt k = 0; k < most; ++k) {
    std::vector<PetscInt> one(points.end, -1), told(points.end, -1);
    for (PetscInt p = 0; p < roots; ++p)
      if (k < degree[p]) one[p] = ghosts[first[p] + k], points.with[p].push_back(static_cast<int>(one[p]));
    PetscCall(PetscSFBcastBegin(sf, MPIU_INT, one.data(), told.data(), MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(sf, MPIU_INT, one.data(), told.data(), MPI_REPLACE));
    for (PetscInt p = 0; p < points.end; ++p)
      if (points.is_ghost[p] && told[p] >= 0 && told[p] != rank) points.with[p].push_back(static_cast<int>(told[p]));
  }
  PetscFunctionReturn(0);
}

/// Nodes and sides that other ranks have too. Their order on two ranks is that of the numbers of nodes, and of the
/// owners' points.
template <int dim>
void join_ranks(MPI_Comm comm, const SharedPoints &points, const PlexCells<dim> &of, MeshPart<dim> &part) {
  std::map<int, std::vector<std::pair<long long, int>>> nodes;
  for (int i = 0; i < static_cast<int>(part.node_number.size()); ++i) {
    part.owned.push_back(!points.is_ghost[of.first_vertex + i]);
    for (const int rank : points.with[of.first_vertex + i]) nodes[rank].emplace_back(part.node_number[i], i);
  }
  for (auto &[rank, list] : nodes) {
    std::sort(list.begin(), list.end());
    part.neighbours.push_back(rank), part.shared_nodes.emplace_back();
    for (const auto &one : list) part.shared_nodes.back().push_back(one.second);
  }
  int mine;
  MPI_Comm_rank(comm, &mine);
  std::map<int, std::vector<std::pair<std::pair<PetscInt, PetscInt>, Side>>> seams;
  for (int c = 0; c < static_cast<int>(of.facet.size()); ++c)
    for (int k = 0; k <= dim; ++k) {
      const PetscInt p = of.facet[c][k];
      const auto [rank, point] = points.across[p];
      if (part.cells.neighbour[c][k] >= 0 || rank < 0) continue;
      const bool ghost = points.is_ghost[p];
      seams[static_cast<int>(rank)].push_back({{ghost ? rank : mine, ghost ? point : p}, {c, k}});
    }
  for (auto &[rank, list] : seams) {
    std::sort(list.begin(), list.end());
    part.seams.push_back({rank, {}});
    for (const auto &one : list) part.seams.back().sides.push_back(one.second);
  }
}

/// Mean length of the edges at each node, an edge counted on the rank that owns it.
template <int dim>
PetscErrorCode mean_edges(DM plex, const SharedPoints &points, PetscInt first_vertex, MeshPart<dim> &part) {
  PetscInt first, end;
  const PetscInt *ends;
  PetscFunctionBeginUser;
  std::vector<Vec<2>> sums(part.cells.position.size(), Vec<2>{});  // length, number
  PetscCall(DMPlexGetDepthStratum(plex, 1, &first, &end));
  for (PetscInt edge = first; edge < end; ++edge) {
    if (points.is_ghost[edge]) continue;
    PetscCall(DMPlexGetCone(plex, edge, &ends));
    const PetscInt a = ends[0] - first_vertex, b = ends[1] - first_vertex;
    const double length = (map<dim>(part.cells.position[a]) - map<dim>(part.cells.position[b])).norm();
    for (PetscInt i : {a, b}) sums[i][0] += length, sums[i][1] += 1;
  }
  Halo halo(PetscObjectComm((PetscObject)plex), part.neighbours, part.shared_nodes);
  PetscCall(halo.sum(sums.empty() ? nullptr : sums[0].data(), 2));
  for (const auto &[length, number] : sums) part.mean_edge.push_back(length / number);
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode part_of_plex(DM plex, MeshPart<dim> &part, HostPoints &host) {
  PlexCells<dim> of;
  SharedPoints points;
  IS cells;
  Owned<IS, ISDestroy> all;
  PetscFunctionBeginUser;
  PetscCall(read_cells(plex, of, part.cells));
  PetscCall(read_names(plex, of, part));
  PetscCall(DMPlexGetCellNumbering(plex, &cells));
  PetscCall(read_numbers(cells, part.cell_number));
  PetscCall(DMPlexCreatePointNumbering(plex, all.create()));
  PetscCall(read_numbers(all, host.number));
  for (std::size_t i = 0; i < part.cells.position.size(); ++i) {
    host.vertex.push_back(of.first_vertex + static_cast<PetscInt>(i));
    part.node_number.push_back(host.number[host.vertex.back()]);
  }
  PetscCall(shared_points(plex, points));
  join_ranks(PetscObjectComm((PetscObject)plex), points, of, part);
  PetscCall(mean_edges(plex, points, of.first_vertex, part));
  PetscFunctionReturn(0);
}

template PetscErrorCode part_of_plex(DM, MeshPart<2> &, HostPoints &);
template PetscErrorCode part_of_plex(DM, MeshPart<3> &, HostPoints &);

}  // namespace talus
