// Meshes whose edges are halved after they have been divided among the ranks.
#include "meshes/refine.h"

#include <gtest/gtest.h>
#include <petscsf.h>

#include <cmath>
#include <map>
#include <set>

#include "box_mesh.h"
#include "meshes/background_mesh.h"
#include "meshes/whole_mesh.h"

namespace talus {
namespace {

using test::BoxMesh;
using test::SharedFile;
using test::sum;

/// All ranks' numbers, rank by rank.
std::vector<long long> all_of(const std::vector<long long> &mine) {
  int ranks, count = static_cast<int>(mine.size());
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  std::vector<int> counts(ranks), first(ranks + 1, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, PETSC_COMM_WORLD);
  for (int r = 0; r < ranks; ++r) first[r + 1] = first[r] + counts[r];
  std::vector<long long> all(first[ranks]);
  MPI_Allgatherv(mine.data(), count, MPI_LONG_LONG, all.data(), counts.data(), first.data(), MPI_LONG_LONG,
                 PETSC_COMM_WORLD);
  return all;
}

template <int dim>
using Corners = std::array<long long, dim + 1>;  // numbers of nodes

/// The cells of all ranks, each with the numbers of its nodes.
template <int dim>
std::map<long long, Corners<dim>> cells_of_all(const std::vector<long long> &cell_number,
                                               const std::vector<long long> &node_number,
                                               const std::function<std::array<int, dim + 1>(int)> &nodes) {
  std::vector<long long> mine;
  for (std::size_t c = 0; c < cell_number.size(); ++c) {
    mine.push_back(cell_number[c]);
    for (const int i : nodes(static_cast<int>(c))) mine.push_back(node_number[i]);
  }
  std::map<long long, Corners<dim>> cells;
  const std::vector<long long> all = all_of(mine);
  for (std::size_t k = 0; k < all.size(); k += dim + 2) {
    EXPECT_EQ(cells.count(all[k]), 0u) << "a cell is there twice";
    std::copy_n(&all[k + 1], dim + 1, cells[all[k]].begin());
  }
  return cells;
}
template <int dim>
std::map<long long, Corners<dim>> cells_of_all(const BackgroundMesh<dim> &mesh) {
  return cells_of_all<dim>(mesh.global_cell, mesh.global_node, [&](int c) { return mesh.cells[c].node; });
}

template <typename Case>
class RefinedMesh : public ::testing::Test {
 protected:
  static constexpr int dim = Case::dim, halvings = Case::halvings,
                       n = dim == 2        ? 8
                           : halvings == 1 ? 4
                                           : 2,
                       fine = n << halvings;
  static constexpr long long children = 1 << dim * halvings;
  SharedFile file{BoxMesh(dim, n)};
  BackgroundMesh<dim> mesh = read(PETSC_COMM_WORLD, halvings);
  BackgroundMesh<dim> read(MPI_Comm comm, int times, const Cuts &cuts = {}) const {
    return BackgroundMesh<dim>::read(comm, file.name(), {{"lower", 5}}, cuts, times);
  }
};
template <int dim_, int halvings_>
struct Case {
  static constexpr int dim = dim_, halvings = halvings_;
};
using Cases = ::testing::Types<Case<2, 1>, Case<2, 2>, Case<3, 1>, Case<3, 2>>;
TYPED_TEST_SUITE(RefinedMesh, Cases);

TYPED_TEST(RefinedMesh, HasTheVolumeAndTheFacetsOfTheMeshBefore) {
  double volume = 0, lower = 0, nodal = 0;
  for (const double one : this->mesh.volume) {
    EXPECT_GT(one, 0);
    volume += one;
  }
  for (const int c : this->mesh.region("lower")) lower += this->mesh.volume[c];
  for (int i = 0; i < this->mesh.node_count(); ++i)
    if (this->mesh.owned[i]) nodal += this->mesh.nodal_volume[i];
  EXPECT_NEAR(sum(volume), 1, 1e-12);
  EXPECT_NEAR(sum(lower), 0.5, 1e-12);
  EXPECT_NEAR(sum(nodal), 1, 1e-12);
  for (const auto &[group, y, expected] : {std::tuple{"base", 0., 1.}, {"top", 1., 1.}, {"middle", 0.5, 2.}}) {
    double area = 0;
    for (const auto &facet : this->mesh.facets(group)) {
      area += facet.area;
      for (const int i : facet.node) EXPECT_NEAR(this->mesh.position[i][1], y, 1e-14);
    }
    EXPECT_NEAR(sum(area), expected, 1e-12) << group;
  }
}

TYPED_TEST(RefinedMesh, CountsCellsAndNodes) {
  constexpr int dim = TestFixture::dim, n = TestFixture::fine;
  const MeshReport report = this->mesh.report();
  EXPECT_EQ(report.cells, dim == 2 ? 2 * n * n : 6 * n * n * n);
  EXPECT_EQ(report.nodes, dim == 2 ? (n + 1) * (n + 1) : (n + 1) * (n + 1) * (n + 1));
  std::set<long long> numbers;
  for (const long long one : all_of(this->mesh.global_node)) numbers.insert(one);
  EXPECT_EQ(static_cast<long long>(numbers.size()), report.nodes);
}

/// Triangles have their shape again, and the octahedra in tetrahedra are divided so that on average nothing is lost.
TYPED_TEST(RefinedMesh, KeepsTheShapeOfItsCells) {
  const auto before = this->read(PETSC_COMM_SELF, 0);
  const MeshReport now = this->mesh.report(), then = before.report();
  EXPECT_GT(now.mean_quality, (TestFixture::dim == 2 ? 1 - 1e-12 : 0.98) * then.mean_quality);
  EXPECT_GT(now.smallest_quality, (TestFixture::dim == 2 ? 1 - 1e-12 : 0.5) * then.smallest_quality);
}

/// A face without a neighbour is on the surface of the box, all others have two cells, which name each other.
TYPED_TEST(RefinedMesh, IsConforming) {
  constexpr int dim = TestFixture::dim, n = TestFixture::fine;
  const auto &mesh = this->mesh;
  std::map<std::set<long long>, std::vector<long long>> cells_at;  // a face, by its nodes
  for (const auto &[cell, corners] : cells_of_all(mesh))
    for (int k = 0; k <= dim; ++k) {
      std::set<long long> face(corners.begin(), corners.end());
      face.erase(corners[k]);
      cells_at[face].push_back(cell);
    }
  long long outer = 0;
  for (const auto &[face, cells] : cells_at) {
    EXPECT_LE(cells.size(), 2u);
    outer += cells.size() == 1;
  }
  EXPECT_EQ(outer, dim == 2 ? 4 * n : 12 * n * n);

  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  std::vector<std::vector<long long>> cells_of(ranks);  // in the order in which ranks number them
  std::vector<int> count(ranks, mesh.cell_count());
  MPI_Allgather(MPI_IN_PLACE, 0, MPI_INT, count.data(), 1, MPI_INT, PETSC_COMM_WORLD);
  const std::vector<long long> all = all_of(mesh.global_cell);
  for (int r = 0, first = 0; r < ranks; first += count[r++])
    cells_of[r].assign(all.begin() + first, all.begin() + first + count[r]);
  for (int c = 0; c < mesh.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k) {
      std::set<long long> face;
      for (int j = 0; j <= dim; ++j)
        if (j != k) face.insert(mesh.global_node[mesh.cells[c].node[j]]);
      const std::vector<long long> &cells = cells_at.at(face);
      const int next = mesh.cells[c].neighbour[k];
      if (next == boundary) {
        EXPECT_EQ(cells.size(), 1u);
        continue;
      }
      long long across;
      if (next >= 0) {
        across = mesh.global_cell[next];
      } else {
        const PartitionFace &beyond = mesh.partition_faces[-2 - next];
        across = cells_of[beyond.rank].at(beyond.cell);
      }
      ASSERT_EQ(cells.size(), 2u);
      EXPECT_EQ(across, cells[cells[0] == mesh.global_cell[c]]);
    }
}

/// Cells, nodes, patches and names of one rank that reads alone.
TYPED_TEST(RefinedMesh, IsTheSameOnAnyPartition) {
  constexpr int dim = TestFixture::dim;
  const auto alone = this->read(PETSC_COMM_SELF, this->halvings);
  std::map<long long, int> cell_of, node_of;
  for (int c = 0; c < alone.cell_count(); ++c) cell_of[alone.global_cell[c]] = c;
  for (int i = 0; i < alone.node_count(); ++i) node_of[alone.global_node[i]] = i;
  EXPECT_EQ(sum(this->mesh.cell_count()), alone.cell_count());
  EXPECT_EQ(this->mesh.fingerprint(), alone.fingerprint());
  std::map<int, int> patch_of;
  for (int c = 0; c < this->mesh.cell_count(); ++c) {
    const int there = cell_of.at(this->mesh.global_cell[c]);
    for (int k = 0; k <= dim; ++k)
      EXPECT_EQ(this->mesh.global_node[this->mesh.cells[c].node[k]], alone.global_node[alone.cells[there].node[k]]);
    EXPECT_EQ(patch_of.try_emplace(this->mesh.patch[c], alone.patch[there]).first->second, alone.patch[there]);
  }
  EXPECT_EQ(sum(this->mesh.patch_count), alone.patch_count);
  for (int i = 0; i < this->mesh.node_count(); ++i) {
    const int there = node_of.at(this->mesh.global_node[i]);
    EXPECT_EQ(this->mesh.position[i], alone.position[there]);
    EXPECT_NEAR(this->mesh.mean_edge[i], alone.mean_edge[there], 1e-14);
    EXPECT_NEAR(this->mesh.nodal_volume[i], alone.nodal_volume[there], 1e-16);
  }
}

/// By its definition, from the cells of one rank.
TYPED_TEST(RefinedMesh, KnowsTheMeanEdgesAtItsNodes) {
  constexpr int dim = TestFixture::dim;
  const auto alone = this->read(PETSC_COMM_SELF, this->halvings);
  std::vector<std::set<int>> ends(alone.node_count());
  for (const auto &cell : alone.cells)
    for (const int a : cell.node)
      for (const int b : cell.node)
        if (a != b) ends[a].insert(b);
  for (int i = 0; i < alone.node_count(); ++i) {
    double length = 0;
    for (const int j : ends[i]) length += (map<dim>(alone.position[i]) - map<dim>(alone.position[j])).norm();
    EXPECT_NEAR(alone.mean_edge[i], length / static_cast<double>(ends[i].size()), 1e-14);
  }
}

TYPED_TEST(RefinedMesh, HasPatchesOfTheUsualSizesWithinThoseBefore) {
  constexpr int dim = TestFixture::dim;
  const auto before = this->read(PETSC_COMM_SELF, 0);
  std::map<long long, int> patch_before;
  for (int c = 0; c < before.cell_count(); ++c) patch_before[before.global_cell[c]] = before.patch[c];
  std::vector<int> within(this->mesh.patch_count, -1), size(this->mesh.patch_count, 0);
  for (int c = 0; c < this->mesh.cell_count(); ++c) {
    const int p = this->mesh.patch[c], old = patch_before.at(this->mesh.global_cell[c] / this->children);
    if (size[p]++ == 0) within[p] = old;
    EXPECT_EQ(within[p], old);
  }
  for (const int one : size) {
    EXPECT_GE(one, dim == 2 ? 2 : 4);
    EXPECT_LE(one, dim == 2 ? 4 : 14);
  }
}

/// Vertices and edges that several ranks have are one point of the star forest, and have the numbers of one rank alone.
TYPED_TEST(RefinedMesh, HasElementsWithTheSameEdgesOnAnyPartition) {
  const auto edges_of = [](const auto &mesh, bool of_all) {
    const ElementPlex &plex = mesh.element_plex();
    std::vector<long long> list;  // number and ends
    PetscInt first, end, leaves;
    PetscSF sf;
    const PetscInt *leaf;
    EXPECT_EQ(DMPlexGetDepthStratum(plex.dm, 1, &first, &end), 0);
    EXPECT_EQ(DMGetPointSF(plex.dm, &sf), 0);
    EXPECT_EQ(PetscSFGetGraph(sf, nullptr, &leaves, &leaf, nullptr), 0);
    std::set<PetscInt> ghosts;
    for (PetscInt k = 0; k < leaves; ++k) ghosts.insert(leaf ? leaf[k] : k);
    for (PetscInt e = first; e < end; ++e) {
      const PetscInt *ends;
      EXPECT_EQ(DMPlexGetCone(plex.dm, e, &ends), 0);
      if (!ghosts.count(e))
        for (const long long one : {plex.number[e], plex.number[ends[0]], plex.number[ends[1]]}) list.push_back(one);
    }
    if (of_all) list = all_of(list);
    std::map<long long, std::set<long long>> edges;
    for (std::size_t k = 0; k < list.size(); k += 3) {
      EXPECT_EQ(edges.count(list[k]), 0u) << "an edge is counted twice";
      edges[list[k]] = {list[k + 1], list[k + 2]};
    }
    return edges;
  };
  const auto alone = this->read(PETSC_COMM_SELF, this->halvings);
  const auto expected = edges_of(alone, false);
  EXPECT_EQ(edges_of(this->mesh, true), expected);
  for (const long long number : this->mesh.global_edges()) EXPECT_EQ(expected.count(number), 1u);  // ghosts too
  for (const long long number : alone.global_node) EXPECT_EQ(expected.count(number), 0u);
}

/// Soil has moved to one side: the cuts are those of the mesh before with the sums of the work, and with them the mesh
/// is the one that is read with these cuts, to the bit.
TYPED_TEST(RefinedMesh, IsDividedAnew) {
  constexpr int dim = TestFixture::dim;
  if (!this->mesh.divisible()) return;
  const auto work_on = [&](const auto &mesh, long long children) {
    std::vector<FilledCell<dim>> work;
    for (int c = 0; c < mesh.cell_count(); ++c) {
      const long long before = mesh.global_cell[c] / children;
      if (before % 3 == 0) work.push_back({mesh.global_cell[c], static_cast<double>(before % 7 + 1) / children, {}});
    }
    return work;
  };
  PartitionForecast forecast, expected_forecast;
  const auto before = this->read(PETSC_COMM_WORLD, 0);
  const Cuts cuts = this->mesh.balanced_cuts(work_on(this->mesh, this->children), 0, &forecast),
             expected = before.balanced_cuts(work_on(before, 1), 0, &expected_forecast);
  ASSERT_EQ(cuts.size(), expected.size());
  for (std::size_t k = 0; k < cuts.size(); ++k) EXPECT_EQ(cuts[k].place, expected[k].place);
  EXPECT_EQ(forecast.imbalance,
            expected_forecast.imbalance);  // the work of a cell is a sum of parts that have no round-off

  const auto divided = this->mesh.divided(cuts), read = this->read(PETSC_COMM_WORLD, this->halvings, cuts);
  EXPECT_EQ(divided.partition_fingerprint(), read.partition_fingerprint());
  EXPECT_EQ(divided.fingerprint(), this->mesh.fingerprint());
  EXPECT_EQ(divided.position, read.position);
  EXPECT_EQ(divided.mean_edge, read.mean_edge);
  EXPECT_EQ(divided.patch, read.patch);
  EXPECT_EQ(divided.owned, read.owned);
  EXPECT_EQ(divided.halo.shared(), read.halo.shared());
  EXPECT_EQ(divided.element_plex().number, read.element_plex().number);
  EXPECT_EQ(divided.facets("middle").size(), read.facets("middle").size());
  EXPECT_EQ(sum(divided.cell_count()), sum(read.cell_count()));
  static_assert(dim == 2 || dim == 3);
}

/// Ranks get cells at random, so that many edges have ends on two ranks and are one rank's alone.
TYPED_TEST(RefinedMesh, TellsSharedEdgesFromOthersWithSharedEnds) {
  constexpr int dim = TestFixture::dim;
  int rank, ranks;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank), MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  std::string complaint;
  const GmshMesh source = read_gmsh(this->file.name(), dim);
  MeshPart<dim> whole = part_of_file<dim>(source, complaint);
  whole.patch.assign(whole.cells.node.size(), 0);
  std::vector<int> rank_of_cell;
  for (unsigned c = 0; c < whole.cells.node.size(); ++c)
    rank_of_cell.push_back(static_cast<int>((c * 2654435761u >> 8) % ranks));
  MeshPart<dim> mine = deal_out(PETSC_COMM_WORLD, whole, rank_of_cell);
  for (int k = 0; k < this->halvings; ++k)
    mine = refine(PETSC_COMM_WORLD, mine), whole = refine(PETSC_COMM_SELF, whole);
  const auto cells = cells_of_all<dim>(mine.cell_number, mine.node_number, [&](int c) { return mine.cells.node[c]; });
  ASSERT_EQ(cells.size(), whole.cells.node.size());
  for (std::size_t c = 0; c < whole.cells.node.size(); ++c)
    for (int k = 0; k <= dim; ++k)
      EXPECT_EQ(cells.at(whole.cell_number[c])[k], whole.node_number[whole.cells.node[c][k]]);
  // each node is owned once, by one of the ranks that have it, and these are all neighbours
  std::map<long long, std::set<int>> holders;
  std::vector<long long> pairs, owners;
  for (std::size_t i = 0; i < mine.node_number.size(); ++i) {
    pairs.insert(pairs.end(), {mine.node_number[i], rank});
    if (mine.owned[i]) owners.push_back(mine.node_number[i]);
  }
  pairs = all_of(pairs), owners = all_of(owners);
  for (std::size_t k = 0; k < pairs.size(); k += 2) holders[pairs[k]].insert(static_cast<int>(pairs[k + 1]));
  EXPECT_EQ(owners.size(), holders.size());
  EXPECT_EQ(std::set<long long>(owners.begin(), owners.end()).size(), holders.size());
  std::map<long long, std::set<int>> shared;
  for (const long long number : mine.node_number) shared[number].insert(rank);
  for (std::size_t k = 0; k < mine.neighbours.size(); ++k)
    for (const int i : mine.shared_nodes[k]) shared[mine.node_number[i]].insert(mine.neighbours[k]);
  for (const auto &[number, with] : shared) EXPECT_EQ(with, holders.at(number)) << number;
}

/// Of the four parts of a triangle that was a patch of its own, the middle has one neighbour in a pair.
TEST(RefinedTriangle, LeavesNoPartAlone) {
  MeshPart<2> part;
  part.cells.position = {{0, 0}, {1, 0}, {0, 1}};
  part.cells.node = {{0, 1, 2}}, part.cells.neighbour = {{-1, -1, -1}};
  part.cell_number = {0}, part.node_number = {1, 2, 3}, part.patch = {0}, part.owned = {1, 1, 1};
  part.mean_edge = {1, 1.2, 1.2}, part.regions = {{0}, {{"soil"}}}, part.all_cells = 1, part.end_of_numbers = 4;
  part = refine(PETSC_COMM_SELF, part);
  cut_patches(PETSC_COMM_SELF, part, part.patch, true);
  EXPECT_EQ(part.patch, (std::vector<int>{0, 0, 0, 0}));
  EXPECT_EQ(part.node_number, (std::vector<long long>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(part.cell_number, (std::vector<long long>{0, 1, 2, 3}));
}

/// More particles than there are numbers for, and than any machine has memory for: refused before edges are halved.
TEST(RefinedBox, IsRefusedWhereNumbersOrMemoryEnd) {
  const SharedFile file{BoxMesh(3, 1)};
  const auto complaint = [&](int particles) -> std::string {
    try {
      const double each = particles;
      BackgroundMesh<3>::read(PETSC_COMM_WORLD, file.name(), {}, {}, 1,
                              {{{"lower", each}, {"upper", each}}, particles});
    } catch (const std::invalid_argument &error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(4), "");
  const std::string numbers = complaint(45'000'000);
  EXPECT_EQ(
      numbers,
      "its 6 cells become 48 where their edges are halved once (mesh.halvings), and with up to 45000000 particles "
      "in each need 2160000000 numbers of particles, of which there are 2147483647; take fewer halvings, larger "
      "cells (mesh.size), or fewer particles_per_cell");
  const std::string memory = complaint(44'000'000);
  EXPECT_EQ(memory.find("its 6 cells become 48 where their edges are halved once (mesh.halvings), and with 2112000000 "
                        "particles need about 1.27e+03 GB on this machine, which has "),
            0u)
      << memory;
}

/// A slice that is one element thick is two thick once its edges are halved: its patches are those of other meshes.
TEST(RefinedSlice, IsTwoCellsThick) {
  const SharedFile file{BoxMesh(3, 1)};
  const auto mesh = BackgroundMesh<3>::read(PETSC_COMM_WORLD, file.name(), {}, {}, 1);
  EXPECT_FALSE(mesh.report().one_element_slice);
  EXPECT_EQ(sum(mesh.cell_count()), 48);
  std::vector<int> size(mesh.patch_count, 0);
  for (const int p : mesh.patch) ++size[p];
  for (const int one : size) EXPECT_GE(one, 4);
  EXPECT_LE(sum(mesh.patch_count), 8);
}

}  // namespace
}  // namespace talus
