#include "meshes/mesh_part.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "base/archive.h"
#include "meshes/patches.h"

namespace talus {
namespace {

constexpr int tag = 18;
constexpr std::size_t longest_message = 1 << 30;  // MPI counts by int

void send(MPI_Comm comm, int to, const std::string &bytes) {
  const unsigned long long size = bytes.size();
  MPI_Send(&size, 1, MPI_UNSIGNED_LONG_LONG, to, tag, comm);
  for (std::size_t at = 0; at < bytes.size(); at += longest_message)
    MPI_Send(bytes.data() + at, static_cast<int>(std::min(longest_message, bytes.size() - at)), MPI_BYTE, to, tag,
             comm);
}

std::string receive(MPI_Comm comm, int from) {
  unsigned long long size;
  MPI_Recv(&size, 1, MPI_UNSIGNED_LONG_LONG, from, tag, comm, MPI_STATUS_IGNORE);
  std::string bytes(size, '\0');
  for (std::size_t at = 0; at < bytes.size(); at += longest_message)
    MPI_Recv(bytes.data() + at, static_cast<int>(std::min(longest_message, bytes.size() - at)), MPI_BYTE, from, tag,
             comm, MPI_STATUS_IGNORE);
  return bytes;
}

template <int dim>
void serialize(Archive &archive, MeshPart<dim> &part) {
  archive.serialize("cells", part.cells.position, part.cells.node, part.cells.neighbour, part.cell_number,
                    part.node_number, part.patch, part.owned, part.mean_edge, part.regions.combination, part.neighbours,
                    part.all_cells, part.end_of_numbers);
  const auto each = [&](auto &list, const auto &item) {
    std::size_t count = list.size();
    archive.serialize("count", count);
    list.resize(count);
    for (auto &one : list) item(one);
  };
  each(part.regions.names, [&](auto &names) { each(names, [&](auto &name) { archive.serialize("region", name); }); });
  each(part.groups, [&](auto &group) { archive.serialize("group", group.first, group.second); });
  each(part.shared_nodes, [&](auto &nodes) { archive.serialize("shared nodes", nodes); });
  each(part.seams, [&](Seam &seam) { archive.serialize("seam", seam.rank, seam.sides); });
}

template <int dim>
class Dealer {
 public:
  Dealer(const MeshPart<dim> &whole, const std::vector<int> &rank_of_cell, int ranks)
      : whole_(whole),
        rank_(rank_of_cell),
        cells_of_(ranks),
        place_(rank_of_cell.size()),
        local_(whole.cells.position.size(), -1),
        any_rank_(whole.cells.position.size(), -1) {
    for (int c = 0; c < static_cast<int>(rank_.size()); ++c) {
      std::vector<int> &mine = cells_of_[rank_[c]];
      place_[c] = static_cast<int>(mine.size());
      mine.push_back(c);
      for (const int i : whole_.cells.node[c]) {
        if (any_rank_[i] < 0) any_rank_[i] = rank_[c];
        if (any_rank_[i] != rank_[c] || holders_.count(i)) add_holder(i, rank_[c]);
      }
    }
  }

  MeshPart<dim> part(int rank) {
    MeshPart<dim> part;
    const std::vector<int> &mine = cells_of_[rank];
    std::vector<int> nodes;
    for (const int c : mine)
      for (const int i : whole_.cells.node[c])
        if (local_[i] < 0) local_[i] = 0, nodes.push_back(i);
    std::sort(nodes.begin(), nodes.end());
    for (std::size_t i = 0; i < nodes.size(); ++i) local_[nodes[i]] = static_cast<int>(i);
    add_nodes(rank, nodes, part);
    add_cells(rank, mine, part);
    part.regions.names = whole_.regions.names;
    part.all_cells = whole_.all_cells, part.end_of_numbers = whole_.end_of_numbers;
    for (const auto &[name, sides] : whole_.groups) {
      part.groups.emplace_back(name, std::vector<Side>{});
      for (const Side &side : sides)
        if (rank_[side.cell] == rank) part.groups.back().second.push_back({place_[side.cell], side.face});
    }
    for (const int i : nodes) local_[i] = -1;
    return part;
  }

 private:
  void add_holder(int node, int rank) {
    std::vector<int> &ranks = holders_.try_emplace(node, 1, any_rank_[node]).first->second;
    const auto at = std::lower_bound(ranks.begin(), ranks.end(), rank);
    if (at == ranks.end() || *at != rank) ranks.insert(at, rank);
  }

  void add_nodes(int rank, const std::vector<int> &nodes, MeshPart<dim> &part) const {
    std::map<int, std::vector<int>> shared;
    for (const int i : nodes) {
      part.cells.position.push_back(whole_.cells.position[i]);
      part.node_number.push_back(whole_.node_number[i]);
      part.mean_edge.push_back(whole_.mean_edge[i]);
      const auto at = holders_.find(i);
      part.owned.push_back(at == holders_.end() || at->second.back() == rank);
      if (at == holders_.end()) continue;
      for (const int other : at->second)
        if (other != rank) shared[other].push_back(local_[i]);
    }
    for (auto &[other, list] : shared) {
      part.neighbours.push_back(other);
      part.shared_nodes.push_back(std::move(list));
    }
  }

  void add_cells(int rank, const std::vector<int> &mine, MeshPart<dim> &part) const {
    std::map<int, std::vector<std::pair<std::pair<int, int>, Side>>> seams;  // ordered by the two cells
    for (const int c : mine) {
      part.cells.node.push_back(whole_.cells.node[c]), part.cells.neighbour.push_back(whole_.cells.neighbour[c]);
      for (int &node : part.cells.node.back()) node = local_[node];
      for (int k = 0; k <= dim; ++k) {
        int &next = part.cells.neighbour.back()[k];
        if (next < 0) continue;
        if (rank_[next] != rank) seams[rank_[next]].push_back({std::minmax(c, int{next}), {place_[c], k}});
        next = rank_[next] == rank ? place_[next] : -1;
      }
      part.cell_number.push_back(whole_.cell_number[c]), part.patch.push_back(whole_.patch[c]);
      part.regions.combination.push_back(whole_.regions.combination[c]);
    }
    for (auto &[other, list] : seams) {
      std::sort(list.begin(), list.end());
      part.seams.push_back({other, {}});
      for (const auto &one : list) part.seams.back().sides.push_back(one.second);
    }
  }

  const MeshPart<dim> &whole_;
  const std::vector<int> &rank_;             // of cells
  std::vector<std::vector<int>> cells_of_;   // of ranks
  std::vector<int> place_;                   // of a cell on its rank
  std::vector<int> local_;                   // nodes of the part that is made
  std::vector<int> any_rank_;                // of a node
  std::map<int, std::vector<int>> holders_;  // ranks of a node that several have, ascending
};

}  // namespace

template <int dim>
MeshPart<dim> deal_out(MPI_Comm comm, const MeshPart<dim> &whole, const std::vector<int> &rank_of_cell) {
  int rank, ranks;
  MPI_Comm_rank(comm, &rank), MPI_Comm_size(comm, &ranks);
  MeshPart<dim> mine;
  if (rank == 0) {
    Dealer<dim> dealer(whole, rank_of_cell, ranks);
    for (int r = 1; r < ranks; ++r) {
      MeshPart<dim> part = dealer.part(r);
      Archive archive;
      serialize(archive, part);
      send(comm, r, archive.bytes());
    }
    return dealer.part(0);
  }
  Archive archive(receive(comm, 0));
  serialize(archive, mine);
  return mine;
}

template <int dim>
bool is_one_element_slice(MPI_Comm comm, const std::vector<Vec<dim>> &position) {
  if constexpr (dim == 2) return false;
  double range[2] = {std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};  // min z, min -z
  for (const auto &x : position) range[0] = std::min(range[0], x[dim - 1]), range[1] = std::min(range[1], -x[dim - 1]);
  MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_DOUBLE, MPI_MIN, comm);
  const double front = range[0], back = -range[1], tolerance = 1e-6 * (back - front);
  int off = std::any_of(position.begin(), position.end(),
                        [=](const auto &x) { return x[dim - 1] > front + tolerance && x[dim - 1] < back - tolerance; });
  MPI_Allreduce(MPI_IN_PLACE, &off, 1, MPI_INT, MPI_MAX, comm);
  return !off;
}

template <int dim>
void cut_patches(MPI_Comm comm, MeshPart<dim> &part, const std::vector<int> &kind, bool within_patches) {
  // sizes that lock neither nor soften (docs/theory, section on locking)
  const int size = is_one_element_slice<dim>(comm, part.cells.position) ? 4 : dim == 2 ? 2 : 8;
  part.patch =
      make_patches<dim>(part.cells.node, part.cells.neighbour, kind, size, within_patches ? std::max(2, size / 2) : 0);
}

template bool is_one_element_slice<2>(MPI_Comm, const std::vector<Vec<2>> &);
template bool is_one_element_slice<3>(MPI_Comm, const std::vector<Vec<3>> &);
template void cut_patches(MPI_Comm, MeshPart<2> &, const std::vector<int> &, bool);
template void cut_patches(MPI_Comm, MeshPart<3> &, const std::vector<int> &, bool);
template MeshPart<2> deal_out(MPI_Comm, const MeshPart<2> &, const std::vector<int> &);
template MeshPart<3> deal_out(MPI_Comm, const MeshPart<3> &, const std::vector<int> &);

}  // namespace talus
