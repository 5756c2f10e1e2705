#include "meshes/plex.h"

#include <algorithm>
#include <map>
#include <set>

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

/// Fills `facet` and `neighbour` of one cell, by the node opposite to each face.
template <int dim>
PetscErrorCode read_faces(DM plex, int cell, Simplices<dim> &s) {
  const PetscInt point = cell + s.first_cell, *cone, *support;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetCone(plex, point, &cone));
  for (int f = 0; f <= dim; ++f) {
    std::array<PetscInt, dim> vertex{};
    PetscInt sharing;
    PetscCall(facet_vertices<dim>(plex, cone[f], vertex));
    int opposite = 0;
    while (opposite < dim && std::count(vertex.begin(), vertex.end(), s.node[cell][opposite] + s.first_vertex))
      ++opposite;
    PetscCall(DMPlexGetSupportSize(plex, cone[f], &sharing));
    PetscCall(DMPlexGetSupport(plex, cone[f], &support));
    s.facet[cell][opposite] = cone[f];
    s.neighbour[cell][opposite] =
        sharing < 2 ? -1 : static_cast<int>((support[0] == point ? support[1] : support[0]) - s.first_cell);
    if (sharing > 2) s.crowded = cell;
  }
  PetscFunctionReturn(0);
}

/// Gathers every rank's names and keeps each once.
PetscErrorCode unite(MPI_Comm comm, std::vector<std::string> &names) {
  std::string mine, all;
  PetscFunctionBeginUser;
  for (const std::string &name : names) mine += name + '\n';
  int size, length = static_cast<int>(mine.size());
  PetscCallMPI(MPI_Comm_size(comm, &size));
  std::vector<int> lengths(size), first(size, 0);
  PetscCallMPI(MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, comm));
  for (int r = 1; r < size; ++r) first[r] = first[r - 1] + lengths[r - 1];
  all.resize(first.back() + lengths.back());
  PetscCallMPI(MPI_Allgatherv(mine.data(), length, MPI_CHAR, all.data(), lengths.data(), first.data(), MPI_CHAR, comm));
  std::set<std::string> united;
  for (std::size_t begin = 0, end; begin < all.size(); begin = end + 1) {
    end = all.find('\n', begin);
    united.insert(all.substr(begin, end - begin));
  }
  names.assign(united.begin(), united.end());
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

}  // namespace

template <int dim>
PetscErrorCode read_simplices(DM plex, Simplices<dim> &s) {
  PetscInt end_cell, end_vertex;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(plex, 0, &s.first_cell, &end_cell));
  PetscCall(DMPlexGetDepthStratum(plex, 0, &s.first_vertex, &end_vertex));
  PetscCall(read_positions<dim>(plex, s.first_vertex, end_vertex, s.position));
  const int count = static_cast<int>(end_cell - s.first_cell);
  s.node.resize(count), s.neighbour.resize(count), s.facet.resize(count);
  for (int c = 0; c < count; ++c) {
    PetscCall(read_cell_nodes<dim>(plex, c + s.first_cell, s.first_vertex, end_vertex, s.node[c]));
    // the order of the closure turns every tetrahedron inside out
    if (Simplex<dim>(s.corners(c)).volume < 0) std::swap(s.node[c][dim - 1], s.node[c][dim]);
    PetscCall(read_faces<dim>(plex, c, s));
  }
  PetscFunctionReturn(0);
}

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

PetscErrorCode names_at_height(DM plex, int height, std::vector<std::string> &names) {
  std::vector<std::string> labels;
  std::vector<PetscInt> points;
  PetscFunctionBeginUser;
  names.clear();
  PetscCall(local_names(plex, labels));
  for (const std::string &label : labels) {
    PetscCall(points_at_height(plex, label, height, points));
    if (!points.empty()) names.push_back(label);
  }
  PetscCall(unite(PetscObjectComm((PetscObject)plex), names));
  PetscFunctionReturn(0);
}

PetscErrorCode read_regions(DM plex, Regions &regions) {
  PetscInt first, end;
  std::vector<std::string> labels;
  std::vector<PetscInt> points;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(plex, 0, &first, &end));
  PetscCall(local_names(plex, labels));
  std::vector<std::vector<std::string>> names(end - first);
  for (const std::string &label : labels) {
    PetscCall(points_at_height(plex, label, 0, points));
    for (PetscInt p : points) names[p - first].push_back(label);
  }
  std::map<std::vector<std::string>, int> number;
  for (const auto &combination : names) {
    const auto [at, is_new] = number.try_emplace(combination, static_cast<int>(number.size()));
    if (is_new) regions.names.push_back(combination);
    regions.combination.push_back(at->second);
  }
  PetscFunctionReturn(0);
}

template PetscErrorCode read_simplices(DM, Simplices<2> &);
template PetscErrorCode read_simplices(DM, Simplices<3> &);

}  // namespace talus
