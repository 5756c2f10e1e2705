// The flat copy of a distributed DMPlex: Morton order, cell cache, partition faces, halo, sums at nodes.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

#include "meshes/background_mesh.h"
#include "meshes/plex.h"
#include "meshes/simplex.h"

namespace talus {
namespace {

/// Every dim-th bit of the result is one of the lowest 21 bits of x.
template <int dim>
std::uint64_t spread(std::uint64_t x) {
  std::uint64_t bits = 0;
  for (int b = 0; b < 21; ++b) bits |= (x >> b & 1) << (dim * b);
  return bits;
}

/// Cells along a Morton curve through their centroids, so that neighbours in space are neighbours in memory.
template <int dim>
std::vector<int> morton_order(const Simplices<dim> &s) {
  const int count = static_cast<int>(s.node.size());
  std::vector<Vec<dim>> centre(count);
  Vec<dim> low, high;
  low.fill(std::numeric_limits<double>::max());
  high.fill(-std::numeric_limits<double>::max());
  for (int c = 0; c < count; ++c)
    for (int d = 0; d < dim; ++d) {
      centre[c][d] = 0;
      for (const auto &x : s.corners(c)) centre[c][d] += x[d] / (dim + 1);
      low[d] = std::min(low[d], centre[c][d]), high[d] = std::max(high[d], centre[c][d]);
    }
  double extent = 1e-300;
  for (int d = 0; d < dim && count; ++d) extent = std::max(extent, high[d] - low[d]);
  std::vector<std::pair<std::uint64_t, int>> key(count);
  for (int c = 0; c < count; ++c) {
    key[c].second = c;
    for (int d = 0; d < dim; ++d)
      key[c].first |= spread<dim>(static_cast<std::uint64_t>((centre[c][d] - low[d]) / extent * 0x1fffff)) << d;
  }
  std::sort(key.begin(), key.end());
  std::vector<int> order(count);
  std::transform(key.begin(), key.end(), order.begin(), [](const auto &k) { return k.second; });
  return order;
}

/// Numbers things 0, 1, ... in the order in which they are first met; -1 while not met.
class FirstTouch {
 public:
  explicit FirstTouch(std::size_t count) : number_(count, -1) {}
  int operator()(PetscInt i) {
    if (number_[i] < 0) number_[i] = met_++;
    return number_[i];
  }
  int met() const { return met_; }
  int number(PetscInt i) const { return number_[i]; }

 private:
  std::vector<int> number_;
  int met_ = 0;
};

/// Local points that other ranks hold too.
struct SharedPoints {
  PetscInt begin, end;          ///< chart
  std::vector<char> is_ghost;   ///< another rank owns the point
  std::vector<char> is_shared;  ///< ghost, or held by others too
  PetscSF sf;
};

PetscErrorCode shared_points(DM plex, SharedPoints &points) {
  PetscInt roots, leaves;
  const PetscInt *local, *degree;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetChart(plex, &points.begin, &points.end));
  points.is_ghost.assign(points.end, 0);
  PetscCall(DMGetPointSF(plex, &points.sf));
  PetscCall(PetscSFGetGraph(points.sf, &roots, &leaves, &local, nullptr));
  if (roots < 0) {  // a serial plex may come without a graph
    points.is_shared = points.is_ghost;
    points.sf = nullptr;
    PetscFunctionReturn(0);
  }
  for (PetscInt i = 0; i < leaves; ++i) points.is_ghost[local ? local[i] : i] = 1;
  points.is_shared = points.is_ghost;
  PetscCall(PetscSFComputeDegreeBegin(points.sf, &degree));
  PetscCall(PetscSFComputeDegreeEnd(points.sf, &degree));
  for (PetscInt p = 0; p < roots; ++p)
    if (degree[p]) points.is_shared[p] = 1;
  PetscFunctionReturn(0);
}

struct RankAndCell {
  PetscInt rank, cell;
};

/// Each rank tells the other side of its partition faces the cell it has there: `across[point]`.
PetscErrorCode exchange_cells(const SharedPoints &points, const std::vector<RankAndCell> &mine,
                              std::vector<RankAndCell> &across) {
  PetscFunctionBeginUser;
  across.assign(points.end, {-1, -1});
  if (!points.sf) PetscFunctionReturn(0);
  std::vector<RankAndCell> to_ghosts(points.end, {-1, -1}), to_owners(points.end, {-1, -1});
  PetscCall(PetscSFBcastBegin(points.sf, MPIU_2INT, mine.data(), to_ghosts.data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(points.sf, MPIU_2INT, mine.data(), to_ghosts.data(), MPI_REPLACE));
  PetscCall(PetscSFReduceBegin(points.sf, MPIU_2INT, mine.data(), to_owners.data(), MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(points.sf, MPIU_2INT, mine.data(), to_owners.data(), MPI_REPLACE));
  for (PetscInt p = points.begin; p < points.end; ++p) across[p] = points.is_ghost[p] ? to_ghosts[p] : to_owners[p];
  PetscFunctionReturn(0);
}

/// Every rank learns the global numbers of all shared nodes; pairs of ranks with numbers in common are neighbours.
PetscErrorCode make_halo(DM plex, const SharedPoints &points, PetscInt first_vertex, const FirstTouch &node,
                         Halo &halo) {
  const MPI_Comm comm = PetscObjectComm((PetscObject)plex);
  IS numbering;
  const PetscInt *index;
  PetscInt vertices;
  int size, rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(DMPlexGetVertexNumbering(plex, &numbering));
  PetscCall(ISGetLocalSize(numbering, &vertices));
  PetscCall(ISGetIndices(numbering, &index));
  std::vector<std::pair<PetscInt, int>> mine;  // (global number, local node)
  for (PetscInt v = 0; v < vertices; ++v)
    if (points.is_shared[first_vertex + v] && node.number(v) >= 0)
      mine.emplace_back(index[v] < 0 ? -index[v] - 1 : index[v], node.number(v));
  PetscCall(ISRestoreIndices(numbering, &index));
  std::sort(mine.begin(), mine.end());

  std::vector<PetscInt> sent, all;
  for (const auto &one : mine) sent.push_back(one.first);
  int count = static_cast<int>(sent.size());
  std::vector<int> counts(size), first(size + 1, 0);
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm));
  std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
  all.resize(first[size]);
  PetscCallMPI(MPI_Allgatherv(sent.data(), count, MPIU_INT, all.data(), counts.data(), first.data(), MPIU_INT, comm));

  std::vector<int> neighbours;
  std::vector<std::vector<int>> shared;
  for (int r = 0; r < size; ++r) {
    if (r == rank) continue;
    std::vector<int> nodes;
    for (const auto &[number, local] : mine)
      if (std::binary_search(all.begin() + first[r], all.begin() + first[r + 1], number)) nodes.push_back(local);
    if (nodes.empty()) continue;
    neighbours.push_back(r);
    shared.push_back(nodes);
  }
  halo = Halo(comm, neighbours, shared);
  PetscFunctionReturn(0);
}

/// Length and number of the edges at each node, an edge counted on the rank that owns it, and node volumes.
template <int dim>
PetscErrorCode sum_at_nodes(const SharedPoints &points, const FirstTouch &node, PetscInt first_vertex,
                            BackgroundMesh<dim> &mesh) {
  PetscInt first, end;
  const PetscInt *ends;
  PetscFunctionBeginUser;
  std::vector<Vec<3>> sums(mesh.position.size(), Vec<3>{});  // length, number, volume
  PetscCall(DMPlexGetDepthStratum(mesh.plex(), 1, &first, &end));
  for (PetscInt edge = first; edge < end; ++edge) {
    if (points.is_ghost[edge]) continue;
    PetscCall(DMPlexGetCone(mesh.plex(), edge, &ends));
    const int a = node.number(ends[0] - first_vertex), b = node.number(ends[1] - first_vertex);
    if (a < 0 || b < 0) continue;
    const double length = (map<dim>(mesh.position[a]) - map<dim>(mesh.position[b])).norm();
    for (int i : {a, b}) sums[i][0] += length, sums[i][1] += 1;
  }
  for (int c = 0; c < mesh.cell_count(); ++c)
    for (int i : mesh.cells[c].node) sums[i][2] += mesh.volume[c] / (dim + 1);
  PetscCall(mesh.halo.sum(sums.empty() ? nullptr : sums[0].data(), 3));
  for (const auto &[length, number, volume] : sums) {
    mesh.mean_edge.push_back(length / number);
    mesh.nodal_volume.push_back(volume);
  }
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode BackgroundMesh<dim>::flatten(const Simplices<dim> &s, const std::vector<PetscInt> &number,
                                            const std::vector<PetscInt> &patch_of) {
  SharedPoints points;
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm(), &rank));
  PetscCall(shared_points(plex_, points));
  const std::vector<int> order = morton_order<dim>(s);
  const int count = static_cast<int>(order.size());
  first_plex_cell_ = s.first_cell;
  flat_cell_.resize(count);
  for (int c = 0; c < count; ++c) flat_cell_[order[c]] = c;

  FirstTouch node(s.position.size());
  FirstTouch local_patch(patch_of.empty() ? 0 : *std::max_element(patch_of.begin(), patch_of.end()) + 1);
  cells.resize(count);
  for (int c = 0; c < count; ++c) {
    const int from = order[c];
    const auto corner = s.corners(from);
    const Simplex<dim> simplex(corner);
    cells[c].origin = corner[0];
    cells[c].gradient = simplex.gradient;
    for (int k = 0; k <= dim; ++k) {
      cells[c].node[k] = node(s.node[from][k]);
      const int next = s.neighbour[from][k];
      cells[c].neighbour[k] = next < 0 ? boundary : flat_cell_[next];
    }
    volume.push_back(simplex.volume);
    patch.push_back(local_patch(patch_of[from]));
    plex_point.push_back(s.first_cell + from);
    plex_facet_.push_back(s.facet[from]);
    global_cell.push_back(number[from]);
  }
  patch_count = local_patch.met();

  const int nodes = node.met();
  position.resize(nodes), plex_vertex.resize(nodes), owned.resize(nodes), global_node.resize(nodes);
  for (std::size_t v = 0; v < s.position.size(); ++v) {
    const int i = node.number(static_cast<PetscInt>(v));
    if (i < 0) continue;  // a node of no cell
    position[i] = s.position[v];
    plex_vertex[i] = s.first_vertex + static_cast<PetscInt>(v);
    owned[i] = !points.is_ghost[plex_vertex[i]];
    global_node[i] = global_point(plex_vertex[i]);
  }

  std::vector<RankAndCell> mine(points.end, {-1, -1}), across;
  for (int c = 0; c < count; ++c)
    for (int k = 0; k <= dim; ++k)
      if (cells[c].neighbour[k] == boundary) mine[plex_facet_[c][k]] = {rank, c};
  PetscCall(exchange_cells(points, mine, across));
  for (int c = 0; c < count; ++c)
    for (int k = 0; k <= dim; ++k) {
      const RankAndCell &there = across[plex_facet_[c][k]];
      if (cells[c].neighbour[k] != boundary || there.cell < 0) continue;
      cells[c].neighbour[k] = -2 - static_cast<int>(partition_faces.size());
      partition_faces.push_back({static_cast<int>(there.rank), static_cast<int>(there.cell)});
    }

  PetscCall(make_halo(plex_, points, s.first_vertex, node, halo));
  PetscCall(sum_at_nodes(points, node, s.first_vertex, *this));
  PetscCall(names_at_height(plex_, 0, region_names_));
  PetscCall(names_at_height(plex_, 1, group_names_));
  PetscCall(find_fingerprint());
  PetscFunctionReturn(0);
}

template PetscErrorCode BackgroundMesh<2>::flatten(const Simplices<2> &, const std::vector<PetscInt> &,
                                                   const std::vector<PetscInt> &);
template PetscErrorCode BackgroundMesh<3>::flatten(const Simplices<3> &, const std::vector<PetscInt> &,
                                                   const std::vector<PetscInt> &);

}  // namespace talus
