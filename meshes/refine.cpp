#include "meshes/refine.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "meshes/exchange.h"
#include "meshes/halo.h"

namespace talus {
namespace {

template <int dim>
constexpr int edge_count = static_cast<int>(simplex_edges<dim>.size());
template <int dim>
constexpr int child_count = 1 << dim;

/// The edge between two corners of a simplex.
template <int dim>
int edge_between(int a, int b) {
  const std::pair<int, int> ends = std::minmax(a, b);
  return static_cast<int>(std::find(simplex_edges<dim>.begin(), simplex_edges<dim>.end(), ends) -
                          simplex_edges<dim>.begin());
}

/// The edges of a part, each once. They are numbered by the lowest cell of all ranks that has them.
template <int dim>
struct Edges {
  std::vector<std::array<int, edge_count<dim>>> of_cell;
  std::vector<std::array<int, 2>> ends;  ///< local nodes
  std::vector<long long> number;         ///< edge_number()
  std::vector<char> owned;               ///< by the highest of the ranks that have it
  std::vector<std::vector<int>> shared;  ///< with each neighbour, in an order that both ranks agree on
};

/// Edges with the same lower end stand together while they are found.
template <int dim>
Edges<dim> find_edges(const MeshPart<dim> &part) {
  Edges<dim> edges;
  const std::size_t cells = part.cells.node.size();
  std::vector<std::size_t> first(part.cells.position.size() + 1, 0);
  const auto each = [&](const auto &visit) {
    for (std::size_t c = 0; c < cells; ++c)
      for (int e = 0; e < edge_count<dim>; ++e) {
        const auto [a, b] = simplex_edges<dim>[e];
        const auto [low, high] = std::minmax(part.cells.node[c][a], part.cells.node[c][b]);
        visit(low, high, c, e);
      }
  };
  each([&](int low, int, std::size_t, int) { ++first[low + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<int> found(first.back()), count(part.cells.position.size(), 0);  // edges of a lower end so far
  edges.of_cell.resize(cells);
  each([&](int low, int high, std::size_t c, int e) {
    int *begin = found.data() + first[low], *end = begin + count[low];
    int *at = std::find_if(begin, end, [&](int edge) { return edges.ends[edge][1] == high; });
    if (at == end) {
      ++count[low], *at = static_cast<int>(edges.ends.size());
      edges.ends.push_back({low, high});
      edges.number.push_back(
          edge_number<dim>(part.end_of_numbers, part.cell_number[c], e));  // the first cell is the lowest of this rank
    }
    edges.of_cell[c][e] = *at;
  });
  return edges;
}

struct Message {
  int low, high;  ///< places of the ends among the nodes that two ranks share
  long long number;
  int edge;  ///< on the rank that sends
  bool operator<(const Message &other) const { return low != other.low ? low < other.low : high < other.high; }
};

/// An edge whose ends two ranks share may still be one rank's alone: each tells the other which it has.
template <int dim>
void share_edges(MPI_Comm comm, const MeshPart<dim> &part, Edges<dim> &edges) {
  int rank;
  MPI_Comm_rank(comm, &rank);
  const std::size_t neighbours = part.neighbours.size();
  std::vector<std::vector<Message>> mine(neighbours);
  std::vector<int> place(part.cells.position.size(), -1);
  for (std::size_t k = 0; k < neighbours; ++k) {
    const std::vector<int> &nodes = part.shared_nodes[k];
    for (std::size_t i = 0; i < nodes.size(); ++i) place[nodes[i]] = static_cast<int>(i);
    for (int e = 0; e < static_cast<int>(edges.ends.size()); ++e) {
      const auto [low, high] = std::minmax(place[edges.ends[e][0]], place[edges.ends[e][1]]);
      if (low >= 0) mine[k].push_back({low, high, edges.number[e], e});
    }
    std::sort(mine[k].begin(), mine[k].end());
    for (const int i : nodes) place[i] = -1;
  }
  const std::vector<std::vector<Message>> theirs = exchange(comm, part.neighbours, mine);
  edges.owned.assign(edges.ends.size(), 1), edges.shared.resize(neighbours);
  for (std::size_t k = 0; k < neighbours; ++k)
    for (const Message &told : theirs[k]) {
      const auto at = std::lower_bound(mine[k].begin(), mine[k].end(), told);
      if (at == mine[k].end() || told < *at) continue;
      edges.shared[k].push_back(at->edge);
      edges.number[at->edge] = std::min(edges.number[at->edge], told.number);
      if (part.neighbours[k] > rank) edges.owned[at->edge] = 0;
    }
}

template <int dim>
class Refinement {
 public:
  Refinement(MPI_Comm comm, const MeshPart<dim> &coarse)
      : comm_(comm), coarse_(coarse), old_nodes_(static_cast<int>(coarse.cells.position.size())) {
    const std::size_t cells = coarse.cells.node.size();
    int too_many = cells > std::numeric_limits<int>::max() / (child_count<dim> * (dim + 1));
    MPI_Allreduce(MPI_IN_PLACE, &too_many, 1, MPI_INT, MPI_MAX, comm);
    if (too_many)
      throw std::invalid_argument(
          "a rank has more cells than it can number once their edges are halved (mesh.halvings): take more ranks");
    edges_ = find_edges(coarse);
    share_edges(comm, coarse, edges_);
    partner_.resize(cells);
    for (std::size_t c = 0; c < cells && dim == 3; ++c) partner_[c] = shortest_diagonal(static_cast<int>(c));
  }

  MeshPart<dim> part() {
    fine_.all_cells = coarse_.all_cells * child_count<dim>;
    fine_.end_of_numbers = edge_number<dim>(coarse_.end_of_numbers, coarse_.all_cells, 0);
    fine_.regions.names = coarse_.regions.names;
    fine_.neighbours = coarse_.neighbours, fine_.shared_nodes = coarse_.shared_nodes;
    const std::size_t cells = child_count<dim> * coarse_.cells.node.size(), nodes = old_nodes_ + edges_.ends.size();
    fine_.cells.node.reserve(cells), fine_.cells.neighbour.reserve(cells), fine_.cell_number.reserve(cells);
    fine_.patch.reserve(cells), fine_.regions.combination.reserve(cells);
    fine_.cells.position.reserve(nodes), fine_.node_number.reserve(nodes), fine_.mean_edge.reserve(nodes);
    add_nodes();
    for (int c = 0; c < static_cast<int>(coarse_.cells.node.size()); ++c) add_children(c);
    halve_groups_and_seams();
    find_mean_edges();
    return std::move(fine_);
  }

 private:
  /// The new node between two corners of a cell.
  int middle(int cell, int a, int b) const { return old_nodes_ + edges_.of_cell[cell][edge_between<dim>(a, b)]; }
  const Vec<dim> &place(int node) const { return coarse_.cells.position[node]; }

  /// The diagonals of the octahedron within a tetrahedron lie between the middles of opposite edges. That of a number m
  /// leads from the edge between corners 0 and m, so that corner k is joined with corner k ^ m.
  int shortest_diagonal(int cell) const {
    const auto x = coarse_.cells.corners(cell);
    int shortest = 1;
    double least = std::numeric_limits<double>::max();
    for (int m = 1; m <= dim; ++m) {
      ColumnVector<dim> way = ColumnVector<dim>::Zero();
      for (int k = 0; k <= dim; ++k) way += (k == 0 || k == m ? 1. : -1.) * map<dim>(x[k]);
      // of equal ones the first, whatever round-off says
      if (way.squaredNorm() < (1 - 1e-9) * least) least = way.squaredNorm(), shortest = m;
    }
    return shortest;
  }
  int partner(int cell, int corner) const { return corner ^ partner_[cell]; }

  void add_nodes() {
    fine_.cells.position = coarse_.cells.position, fine_.node_number = coarse_.node_number, fine_.owned = coarse_.owned;
    for (const auto &[a, b] : edges_.ends) {
      Vec<dim> x;
      for (int d = 0; d < dim; ++d) x[d] = (place(a)[d] + place(b)[d]) / 2;
      fine_.cells.position.push_back(x);
    }
    fine_.node_number.insert(fine_.node_number.end(), edges_.number.begin(), edges_.number.end());
    fine_.owned.insert(fine_.owned.end(), edges_.owned.begin(), edges_.owned.end());
    for (std::size_t k = 0; k < edges_.shared.size(); ++k)
      for (const int edge : edges_.shared[k]) fine_.shared_nodes[k].push_back(old_nodes_ + edge);
  }

  /// Child k <= dim is the corner k. In 2D the last one is the middle; in 3D child 4 + f is the part of the octahedron
  /// on the face f, and has a face in common with the corner partner(f).
  void add_children(int c) {
    using Corners = std::array<int, dim + 1>;
    const Corners &node = coarse_.cells.node[c], &across = coarse_.cells.neighbour[c];
    const int first = child_count<dim> * c;
    int child = 0;
    const auto add = [&](const Corners &corners, const Corners &neighbours) {
      fine_.cells.node.push_back(corners), fine_.cells.neighbour.push_back(neighbours);
      fine_.cell_number.push_back(child_count<dim> * coarse_.cell_number[c] + child++);
      fine_.patch.push_back(coarse_.patch[c]);
      fine_.regions.combination.push_back(coarse_.regions.combination[c]);
    };
    Corners corners, neighbours;
    for (int k = 0; k <= dim; ++k) {
      for (int j = 0; j <= dim; ++j) {
        corners[j] = j == k ? node[k] : middle(c, k, j);
        neighbours[j] = j == k ? first + dim + 1 + (dim == 2 ? 0 : partner(c, k))
                        : across[j] < 0
                            ? -1
                            : child_count<dim> * across[j] + place_of(coarse_.cells.node[across[j]], node[k]);
      }
      add(corners, neighbours);
    }
    for (int f = 0; f <= dim && dim == 3; ++f) {
      const int p = partner(c, f);
      for (int j = 0; j <= dim; ++j) {
        corners[j] = j == f ? middle(c, f, p) : opposite(c, f, j);
        neighbours[j] = j == p ? first + p : first + dim + 1 + partner(c, j);
      }
      neighbours[f] =
          across[f] < 0 ? -1 : child_count<dim> * across[f] + dim + 1 + place_of(coarse_.cells.neighbour[across[f]], c);
      add(corners, neighbours);
    }
    if (dim == 3) return;
    for (int k = 0; k <= dim; ++k) corners[k] = opposite(c, k, k), neighbours[k] = first + k;
    add(corners, neighbours);
  }
  static int place_of(const std::array<int, dim + 1> &list, int one) {
    return static_cast<int>(std::find(list.begin(), list.end(), one) - list.begin());
  }
  /// The middle of the edge between the two corners that are neither f nor j.
  int opposite(int cell, int f, int j) const {
    int ends[dim + 1], count = 0;
    for (int k = 0; k <= dim; ++k)
      if (k != f && k != j) ends[count++] = k;
    return middle(cell, ends[0], ends[1]);
  }

  /// The parts of a side at its corners, ascending in the numbers of their nodes; then, in 3D, the part in the middle.
  void halve(const Side &side, std::vector<Side> &into) const {
    std::array<std::pair<long long, int>, dim> corner;
    for (int k = 0, i = 0; k <= dim; ++k)
      if (k != side.face) corner[i++] = {coarse_.node_number[coarse_.cells.node[side.cell][k]], k};
    std::sort(corner.begin(), corner.end());
    for (const auto &one : corner) into.push_back({child_count<dim> * side.cell + one.second, side.face});
    if (dim == 3) into.push_back({child_count<dim> * side.cell + dim + 1 + side.face, side.face});
  }
  void halve_groups_and_seams() {
    for (const auto &[name, sides] : coarse_.groups) {
      fine_.groups.emplace_back(name, std::vector<Side>{});
      for (const Side &side : sides) halve(side, fine_.groups.back().second);
      std::sort(fine_.groups.back().second.begin(), fine_.groups.back().second.end());
    }
    for (const Seam &seam : coarse_.seams) {
      fine_.seams.push_back({seam.rank, {}});
      for (const Side &side : seam.sides) halve(side, fine_.seams.back().sides);
    }
  }

  /// At an old node the edges are the old ones, halved. A new one has the halves of its edge, in each triangle with
  /// this edge two sides of the triangle's middle, and perhaps the diagonal of an octahedron. Each counts on one rank.
  void find_mean_edges() {
    std::vector<Vec<2>> sums(fine_.cells.position.size(), Vec<2>{});  // length, number
    const auto length = [&](int a, int b) { return (map<dim>(place(a)) - map<dim>(place(b))).norm(); };
    for (std::size_t e = 0; e < edges_.ends.size(); ++e)
      if (edges_.owned[e]) sums[old_nodes_ + e] = {length(edges_.ends[e][0], edges_.ends[e][1]), 2};
    std::vector<char> elsewhere(coarse_.cells.node.size(), 0);  // a bit for each face of a cell
    int rank;
    MPI_Comm_rank(comm_, &rank);
    for (const Seam &seam : coarse_.seams)
      for (const Side &side : seam.sides)
        if (seam.rank < rank) elsewhere[side.cell] = static_cast<char>(elsewhere[side.cell] | 1 << side.face);
    const auto add = [&](int node, double edge) { sums[node][0] += edge, sums[node][1] += 1; };
    for (int c = 0; c < static_cast<int>(coarse_.cells.node.size()); ++c) {
      const auto &node = coarse_.cells.node[c];
      for (int f = 0; f <= dim; ++f) {  // of a triangle its only one, without a corner that is left out
        const int next = coarse_.cells.neighbour[c][f];
        if (dim == 2 ? f > 0 : (next >= 0 && next < c) || elsewhere[c] & 1 << f) continue;
        for (int a = 0; a <= dim; ++a)
          for (int b = 0; b < a; ++b) {
            if (dim == 3 && (a == f || b == f)) continue;
            int third = 0;
            while (third == a || third == b || (dim == 3 && third == f)) ++third;
            const double edge = length(node[a], node[b]) / 2;
            add(middle(c, a, third), edge), add(middle(c, b, third), edge);
          }
      }
      if (dim == 2) continue;
      const int p = partner(c, 0), ends[2] = {middle(c, 0, p), opposite(c, 0, p)};
      const double diagonal =
          (map<dim>(fine_.cells.position[ends[0]]) - map<dim>(fine_.cells.position[ends[1]])).norm();
      for (const int end : ends) add(end, diagonal);
    }
    Halo halo(comm_, fine_.neighbours, fine_.shared_nodes);
    PetscCallAbort(comm_, halo.sum(sums.empty() ? nullptr : sums[0].data(), 2));
    for (const double edge : coarse_.mean_edge) fine_.mean_edge.push_back(edge / 2);
    for (std::size_t i = old_nodes_; i < sums.size(); ++i) fine_.mean_edge.push_back(sums[i][0] / sums[i][1]);
  }

  MPI_Comm comm_;
  const MeshPart<dim> &coarse_;
  const int old_nodes_;
  Edges<dim> edges_;
  std::vector<int> partner_;  // of a tetrahedron: the diagonal along which its octahedron is divided
  MeshPart<dim> fine_;
};

}  // namespace

template <int dim>
MeshPart<dim> refine(MPI_Comm comm, const MeshPart<dim> &coarse) {
  return Refinement<dim>(comm, coarse).part();
}

template MeshPart<2> refine(MPI_Comm, const MeshPart<2> &);
template MeshPart<3> refine(MPI_Comm, const MeshPart<3> &);

}  // namespace talus
