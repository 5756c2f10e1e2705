// The flat copy of the part of a rank: Morton order, cell cache, partition faces, halo, sums at nodes.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>

#include "meshes/background_mesh.h"
#include "meshes/complaints.h"
#include "meshes/mesh_part.h"
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
  int operator()(int i) {
    if (number_[i] < 0) number_[i] = met_++;
    return number_[i];
  }
  int met() const { return met_; }
  int number(int i) const { return number_[i]; }

 private:
  std::vector<int> number_;
  int met_ = 0;
};

constexpr int tag = 19;

/// Of each partition face, what `of_cells` holds for the cell across, on its rank.
template <int dim, class T>
PetscErrorCode exchange(const BackgroundMesh<dim> &mesh, const std::vector<Seam> &seams, MPI_Datatype type,
                        const std::vector<T> &of_cells, std::vector<T> &across) {
  std::vector<MPI_Request> requests(2 * seams.size());
  std::vector<std::vector<T>> mine(seams.size()), theirs(seams.size());
  PetscFunctionBeginUser;
  for (std::size_t k = 0; k < seams.size(); ++k) {
    const int count = static_cast<int>(seams[k].sides.size());
    theirs[k].resize(count);
    for (const Side &side : seams[k].sides) mine[k].push_back(of_cells[side.cell]);
    PetscCallMPI(MPI_Irecv(theirs[k].data(), count, type, seams[k].rank, tag, mesh.comm(), &requests[2 * k]));
    PetscCallMPI(MPI_Isend(mine[k].data(), count, type, seams[k].rank, tag, mesh.comm(), &requests[2 * k + 1]));
  }
  PetscCallMPI(MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE));
  across.resize(mesh.partition_faces.size());
  for (std::size_t k = 0; k < seams.size(); ++k)
    for (std::size_t i = 0; i < theirs[k].size(); ++i) {
      const Side &side = seams[k].sides[i];
      across[-2 - mesh.cells[side.cell].neighbour[side.face]] = theirs[k][i];
    }
  PetscFunctionReturn(0);
}

/// Every rank's names, each once, sorted.
PetscErrorCode unite(MPI_Comm comm, const std::set<std::string> &names, std::vector<std::string> &united) {
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
  std::set<std::string> found;
  for (std::size_t begin = 0, end; begin < all.size(); begin = end + 1) {
    end = all.find('\n', begin);
    found.insert(all.substr(begin, end - begin));
  }
  united.assign(found.begin(), found.end());
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode BackgroundMesh<dim>::flatten(MeshPart<dim> part) {
  const Simplices<dim> &s = part.cells;
  PetscFunctionBeginUser;
  const std::vector<int> order = morton_order<dim>(s);
  const int count = static_cast<int>(order.size());
  std::vector<int> flat_cell(count);
  for (int c = 0; c < count; ++c) flat_cell[order[c]] = c;

  FirstTouch node(s.position.size());
  FirstTouch local_patch(part.patch.empty() ? 0 : *std::max_element(part.patch.begin(), part.patch.end()) + 1);
  cells.resize(count), volume.resize(count), patch.resize(count), global_cell.resize(count);
  regions_.names = std::move(part.regions.names), regions_.combination.resize(count);
  for (int c = 0; c < count; ++c) {
    const int from = order[c];
    const auto corner = s.corners(from);
    const Simplex<dim> simplex(corner);
    cells[c].origin = corner[0];
    cells[c].gradient = simplex.gradient;
    for (int k = 0; k <= dim; ++k) {
      cells[c].node[k] = node(s.node[from][k]);
      const int next = s.neighbour[from][k];
      cells[c].neighbour[k] = next < 0 ? boundary : flat_cell[next];
    }
    volume[c] = simplex.volume;
    patch[c] = local_patch(part.patch[from]);
    global_cell[c] = part.cell_number[from];
    regions_.combination[c] = part.regions.combination[from];
  }
  patch_count = local_patch.met(), end_of_numbers_ = part.end_of_numbers;

  const int nodes = node.met();
  position.resize(nodes), mean_edge.resize(nodes), owned.resize(nodes), global_node.resize(nodes);
  for (std::size_t v = 0; v < s.position.size(); ++v) {
    const int i = node.number(static_cast<int>(v));
    if (i < 0) continue;  // a node of no cell
    position[i] = s.position[v], mean_edge[i] = part.mean_edge[v];
    owned[i] = part.owned[v], global_node[i] = part.node_number[v];
  }
  counted = owned;
  std::vector<std::vector<int>> shared;
  for (const auto &with_one : part.shared_nodes) {
    shared.emplace_back();
    for (const int v : with_one)
      if (node.number(v) >= 0) shared.back().push_back(node.number(v));
  }
  halo = Halo(comm(), part.neighbours, std::move(shared));

  std::vector<std::pair<Side, int>> faces;
  seams_ = std::move(part.seams);
  for (Seam &seam : seams_)
    for (Side &side : seam.sides) {
      side.cell = flat_cell[side.cell];
      faces.emplace_back(side, seam.rank);
    }
  std::sort(faces.begin(), faces.end());
  for (const auto &[side, there] : faces) {
    cells[side.cell].neighbour[side.face] = -2 - static_cast<int>(partition_faces.size());
    partition_faces.push_back({there, -1});
  }
  std::vector<int> numbers(count), cell_across;
  std::iota(numbers.begin(), numbers.end(), 0);
  PetscCall(exchange(*this, seams_, MPI_INT, numbers, cell_across));
  for (std::size_t k = 0; k < cell_across.size(); ++k) partition_faces[k].cell = cell_across[k];

  nodal_volume.assign(nodes, 0);
  for (int c = 0; c < count; ++c)
    for (int i : cells[c].node) nodal_volume[i] += volume[c] / (dim + 1);
  PetscCall(halo.sum(nodal_volume.data(), 1));

  groups_ = std::move(part.groups);
  for (auto &[name, sides] : groups_) {
    for (Side &side : sides) side.cell = flat_cell[side.cell];
    std::sort(sides.begin(), sides.end());
  }
  std::set<std::string> names[2];
  for (const int combination : regions_.combination)
    names[0].insert(regions_.names[combination].begin(), regions_.names[combination].end());
  for (const auto &group : groups_)
    if (!group.second.empty()) names[1].insert(group.first);
  PetscCall(unite(comm(), names[0], region_names_));
  PetscCall(unite(comm(), names[1], group_names_));
  PetscCall(find_fingerprint());
  PetscFunctionReturn(0);
}

template <int dim>
std::vector<char> BackgroundMesh<dim>::across(const std::vector<char> &of_cells) const {
  std::vector<char> beyond;
  require(exchange(*this, seams_, MPI_CHAR, of_cells, beyond));
  return beyond;
}

template <int dim>
std::vector<PetscInt> BackgroundMesh<dim>::across(const std::vector<PetscInt> &of_cells) const {
  std::vector<PetscInt> beyond;
  require(exchange(*this, seams_, MPIU_INT, of_cells, beyond));
  return beyond;
}

template std::vector<char> BackgroundMesh<2>::across(const std::vector<char> &) const;
template std::vector<char> BackgroundMesh<3>::across(const std::vector<char> &) const;
template std::vector<PetscInt> BackgroundMesh<2>::across(const std::vector<PetscInt> &) const;
template std::vector<PetscInt> BackgroundMesh<3>::across(const std::vector<PetscInt> &) const;
template PetscErrorCode BackgroundMesh<2>::flatten(MeshPart<2>);
template PetscErrorCode BackgroundMesh<3>::flatten(MeshPart<3>);

}  // namespace talus
