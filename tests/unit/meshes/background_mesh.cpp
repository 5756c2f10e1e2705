#include "meshes/background_mesh.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <map>
#include <set>

#include "box_mesh.h"

namespace talus {
namespace {

using test::BoxMesh;
using test::SharedFile;
using test::sum;

template <typename Dimension>
class MeshOnRanks : public ::testing::Test {
 protected:
  static constexpr int dim = Dimension::value;
  static constexpr int n = dim == 2 ? 12 : 6;
  SharedFile file{BoxMesh(dim, n)};
  BackgroundMesh<dim> mesh = BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file.name(), {{"lower", 5}});

  /// All ranks' values of one number per cell, by global cell.
  std::vector<long long> gathered(const std::function<long long(int)> &value) const {
    std::vector<long long> mine(static_cast<std::size_t>(n) * n * (dim == 2 ? 2 : 6 * n), 0);
    for (int c = 0; c < mesh.cell_count(); ++c) mine[mesh.global_cell[c]] += value(c);
    MPI_Allreduce(MPI_IN_PLACE, mine.data(), static_cast<int>(mine.size()), MPI_LONG_LONG, MPI_SUM, PETSC_COMM_WORLD);
    return mine;
  }
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(MeshOnRanks, Dimensions);

TYPED_TEST(MeshOnRanks, VolumesAddUpToTheBox) {
  double volume = 0, lower = 0, nodal = 0;
  for (double v : this->mesh.volume) {
    EXPECT_GT(v, 0);
    volume += v;
  }
  for (int c : this->mesh.region("lower")) lower += this->mesh.volume[c];
  for (int i = 0; i < this->mesh.node_count(); ++i)
    if (this->mesh.owned[i]) nodal += this->mesh.nodal_volume[i];
  EXPECT_NEAR(sum(volume), 1, 1e-13);
  EXPECT_NEAR(sum(lower), 0.5, 1e-13);
  EXPECT_NEAR(sum(nodal), 1, 1e-13);
}

TYPED_TEST(MeshOnRanks, EveryCellOfTheFileIsThereOnce) {
  for (long long count : this->gathered([](int) { return 1; })) EXPECT_EQ(count, 1);
}

TYPED_TEST(MeshOnRanks, RegionsAndGroupsAreKnownOnAllRanks) {
  EXPECT_EQ(this->mesh.region_names(), (std::vector<std::string>{"lower", "upper"}));
  EXPECT_EQ(this->mesh.group_names(), (std::vector<std::string>{"base", "middle", "top"}));
  EXPECT_TRUE(this->mesh.has_region("upper") && this->mesh.has_group("top"));
  EXPECT_FALSE(this->mesh.has_region("top") || this->mesh.has_group("upper") || this->mesh.has_group("celltype"));
  EXPECT_TRUE(this->mesh.region("nowhere").empty() && this->mesh.facets("nowhere").empty());
}

TYPED_TEST(MeshOnRanks, NeighboursAreSymmetricAndShareTheFace) {
  constexpr int dim = TestFixture::dim;
  for (int c = 0; c < this->mesh.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k) {
      const int other = this->mesh.cells[c].neighbour[k];
      if (other < 0) continue;
      const auto &back = this->mesh.cells[other].neighbour;
      EXPECT_EQ(std::count(back.begin(), back.end(), c), 1);
      const auto &nodes = this->mesh.cells[other].node;
      for (int j = 0; j <= dim; ++j)
        EXPECT_EQ(std::count(nodes.begin(), nodes.end(), this->mesh.cells[c].node[j]), j == k ? 0 : 1);
    }
}

TYPED_TEST(MeshOnRanks, PartitionFacesNameTheCellAcross) {
  constexpr int dim = TestFixture::dim;
  int size;
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  // Each rank lists (its rank, its cell) -> (rank, cell across), all ranks gather the lists, and each pair must be
  // there twice.
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  std::vector<int> mine, all;
  for (int c = 0; c < this->mesh.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k)
      if (const int next = this->mesh.cells[c].neighbour[k]; next < boundary) {
        const PartitionFace &face = this->mesh.partition_faces.at(-2 - next);
        mine.insert(mine.end(), {rank, c, face.rank, face.cell});
      }
  EXPECT_EQ(mine.size(), 4 * this->mesh.partition_faces.size());
  std::vector<int> counts(size), first(size + 1, 0);
  int count = static_cast<int>(mine.size());
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, PETSC_COMM_WORLD);
  for (int r = 0; r < size; ++r) first[r + 1] = first[r] + counts[r];
  all.resize(first[size]);
  MPI_Allgatherv(mine.data(), count, MPI_INT, all.data(), counts.data(), first.data(), MPI_INT, PETSC_COMM_WORLD);
  std::multiset<std::array<int, 4>> faces;
  for (std::size_t i = 0; i < all.size(); i += 4) faces.insert({all[i], all[i + 1], all[i + 2], all[i + 3]});
  if (size > 1) {
    EXPECT_FALSE(faces.empty());
  }
  for (const auto &[a, b, c, d] : faces) EXPECT_EQ(faces.count({a, b, c, d}), faces.count({c, d, a, b}));
}

TYPED_TEST(MeshOnRanks, OuterFacesAddUpToTheSurfaceOfTheBox) {
  constexpr int dim = TestFixture::dim;
  double area = 0;
  for (int c = 0; c < this->mesh.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k)
      if (this->mesh.cells[c].neighbour[k] == boundary) {
        ColumnVector<dim> inward = ColumnVector<dim>::Zero();
        if (k > 0) inward = map<dim>(this->mesh.cells[c].gradient[k - 1]);
        if (k == 0)
          for (const auto &g : this->mesh.cells[c].gradient) inward -= map<dim>(g);
        area += dim * this->mesh.volume[c] * inward.norm();
      }
  EXPECT_NEAR(sum(area), 2 * dim, 1e-12);
}

TYPED_TEST(MeshOnRanks, FacetsOfAGroupAddUpAndPointOutward) {
  constexpr int dim = TestFixture::dim;
  const auto area = [&](const char *group, double y) {
    double total = 0;
    for (const Facet<dim> &facet : this->mesh.facets(group)) {
      total += facet.area;
      for (int i : facet.node) EXPECT_NEAR(this->mesh.position[i][1], y, 1e-14);
      const auto &opposite = this->mesh.position[this->mesh.cells[facet.cell].node[facet.face]];
      EXPECT_NEAR(std::abs(facet.normal[1]), 1, 1e-12);
      EXPECT_LT((opposite[1] - y) * facet.normal[1], 0);
    }
    return sum(total);
  };
  EXPECT_NEAR(area("base", 0), 1, 1e-12);
  EXPECT_NEAR(area("top", 1), 1, 1e-12);
  EXPECT_NEAR(area("middle", 0.5), 2, 1e-12);  // both sides
}

TYPED_TEST(MeshOnRanks, PatchesStayInARegionAndOnARankWhateverTheRanks) {
  constexpr int dim = TestFixture::dim;
  const auto &mesh = this->mesh;
  std::vector<int> upper(mesh.cell_count(), 0), size(mesh.patch_count, 0), in_upper(mesh.patch_count, 0);
  for (int c : mesh.region("upper")) upper[c] = 1;
  for (int c = 0; c < mesh.cell_count(); ++c) ++size[mesh.patch[c]], in_upper[mesh.patch[c]] += upper[c];
  for (int p = 0; p < mesh.patch_count; ++p) {
    EXPECT_TRUE(in_upper[p] == 0 || in_upper[p] == size[p]);
    if (dim == 3) {
      EXPECT_GE(size[p], 4);
    }
    EXPECT_LE(size[p], dim == 3 ? 14 : 3);
  }
  // The lowest cell of a patch names it: the names must be those of one rank reading alone.
  std::vector<long long> lowest(mesh.patch_count, 1 << 30);
  for (int c = 0; c < mesh.cell_count(); ++c)
    lowest[mesh.patch[c]] = std::min(lowest[mesh.patch[c]], mesh.global_cell[c]);
  const auto together = this->gathered([&](int c) { return lowest[mesh.patch[c]]; });
  const auto alone = BackgroundMesh<dim>::read(PETSC_COMM_SELF, this->file.name(), {});
  std::map<int, long long> name;
  for (int c = 0; c < alone.cell_count(); ++c) {
    const auto at = name.try_emplace(alone.patch[c], alone.global_cell[c]).first;
    at->second = std::min(at->second, alone.global_cell[c]);
  }
  for (int c = 0; c < alone.cell_count(); ++c) EXPECT_EQ(together[alone.global_cell[c]], name[alone.patch[c]]);
}

/// The cells of "lower" weigh 5, the others have no body.
TYPED_TEST(MeshOnRanks, WeightsOfRegionsBalanceTheRanks) {
  int size;
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  const double all = this->mesh.cell_count(), lower = static_cast<double>(this->mesh.region("lower").size());
  double mine = 5 * lower + 1e-3 * (all - lower), largest;  // a cell without a weight of its own has 1/1000
  MPI_Allreduce(&mine, &largest, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_LE(largest, 1.1 * sum(mine) / size);
}

TYPED_TEST(MeshOnRanks, MeanEdgesDoNotDependOnTheRanks) {
  constexpr int dim = TestFixture::dim;
  const auto alone = BackgroundMesh<dim>::read(PETSC_COMM_SELF, this->file.name(), {});
  std::map<Vec<dim>, double> expected;
  for (int i = 0; i < alone.node_count(); ++i) expected[alone.position[i]] = alone.mean_edge[i];
  for (int i = 0; i < this->mesh.node_count(); ++i)
    EXPECT_EQ(this->mesh.mean_edge[i], expected.at(this->mesh.position[i]));
}

/// Each cell's value is its global number: the value across a face is that of the cell on its other side.
TYPED_TEST(MeshOnRanks, CellsAcrossPartitionFacesAreAsked) {
  constexpr int dim = TestFixture::dim;
  const auto alone = BackgroundMesh<dim>::read(PETSC_COMM_SELF, this->file.name(), {});
  std::map<long long, int> of_number;
  for (int c = 0; c < alone.cell_count(); ++c) of_number[alone.global_cell[c]] = c;
  const auto byte_of = [](long long number) { return static_cast<char>(number % 101); };
  std::vector<char> mine;
  for (const long long number : this->mesh.global_cell) mine.push_back(byte_of(number));
  const std::vector<char> across = this->mesh.across(mine);
  ASSERT_EQ(across.size(), this->mesh.partition_faces.size());
  for (int c = 0; c < this->mesh.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k) {
      const int next = this->mesh.cells[c].neighbour[k];
      if (next >= boundary) continue;
      const int there = alone.cells[of_number.at(this->mesh.global_cell[c])].neighbour[k];
      EXPECT_EQ(across[-2 - next], byte_of(alone.global_cell[there]));
    }
}

/// Of the box its lower half can have finite elements: its cells, and no air, are in the DMPlex, whatever the ranks.
TYPED_TEST(MeshOnRanks, ThePlexOfElementsHoldsTheirRegionsAlone) {
  const ElementPlex &plex = this->mesh.element_plex();
  PetscInt first, end;
  ASSERT_EQ(DMPlexGetHeightStratum(plex.dm, 0, &first, &end), 0);
  EXPECT_EQ(end - first, static_cast<PetscInt>(this->mesh.region("lower").size()));
  std::set<int> of_lower, found;
  for (int c : this->mesh.region("lower"))
    of_lower.insert(this->mesh.cells[c].node.begin(), this->mesh.cells[c].node.end());
  for (int i = 0; i < this->mesh.node_count(); ++i) {
    if (plex.vertex[i] < 0) continue;
    found.insert(i);
    EXPECT_EQ(plex.number[plex.vertex[i]], this->mesh.global_node[i]);
  }
  EXPECT_EQ(found, of_lower);
  const std::vector<long long> edges = this->mesh.global_edges();
  const std::set<long long> once(edges.begin(), edges.end());
  EXPECT_EQ(once.size(), edges.size());
  for (const long long node : this->mesh.global_node) EXPECT_EQ(once.count(node), 0u);
}

TYPED_TEST(MeshOnRanks, ReportCountsCellsAndNodesOnce) {
  constexpr int dim = TestFixture::dim, n = TestFixture::n;
  const MeshReport report = this->mesh.report();
  EXPECT_EQ(report.cells, dim == 2 ? 2 * n * n : 6 * n * n * n);
  EXPECT_EQ(report.nodes, dim == 2 ? (n + 1) * (n + 1) : (n + 1) * (n + 1) * (n + 1));
  EXPECT_GT(report.smallest_altitude, 0);
  EXPECT_LT(report.smallest_quality, report.mean_quality);
  EXPECT_LT(report.mean_quality, 1);
  EXPECT_FALSE(report.one_element_slice);
}

/// The names of the box, as a host would give them.
void label_box(DM plex) {
  for (int height : {0, 1}) {
    PetscInt first, end;
    ASSERT_EQ(DMPlexGetHeightStratum(plex, height, &first, &end), 0);
    for (PetscInt p = first; p < end; ++p) {
      double volume, centre[3], normal[3];
      ASSERT_EQ(DMPlexComputeCellGeometryFVM(plex, p, &volume, centre, normal), 0);
      const char *name = height == 0                        ? centre[1] < 0.5 ? "lower" : nullptr
                         : std::abs(centre[1] - 0.5) < 1e-9 ? "middle"
                                                            : nullptr;
      if (name) {
        ASSERT_EQ(DMSetLabelValue(plex, name, p, 1), 0);
      }
    }
  }
}

TYPED_TEST(MeshOnRanks, AHostsPlexIsAdopted) {
  constexpr int dim = TestFixture::dim;
  const auto whole = BackgroundMesh<dim>::read(PETSC_COMM_WORLD, this->file.name(), {}, this->mesh.cuts());
  const DM plex = whole.element_plex().dm;
  label_box(plex);
  const auto adopted = BackgroundMesh<dim>::adopt(plex);
  EXPECT_EQ(adopted.cell_count(), this->mesh.cell_count());
  EXPECT_EQ(adopted.region("lower"), this->mesh.region("lower"));
  EXPECT_EQ(adopted.facets("middle").size(), this->mesh.facets("middle").size());
  EXPECT_EQ(adopted.position, this->mesh.position);
  EXPECT_EQ(adopted.halo.neighbours(), this->mesh.halo.neighbours());
  EXPECT_EQ(adopted.halo.shared_nodes(), this->mesh.halo.shared_nodes());
  EXPECT_EQ(adopted.owned, this->mesh.owned);
  EXPECT_EQ(adopted.host_vertex.size(), adopted.position.size());
  for (int i = 0; i < adopted.node_count(); ++i) EXPECT_NEAR(adopted.mean_edge[i], this->mesh.mean_edge[i], 1e-14);
  EXPECT_THROW(BackgroundMesh<5 - dim>::adopt(plex), std::invalid_argument);
}

/// With what rank 0 keeps for new partitions; a DMPlex of all cells would take three times as much.
TEST(MeshInMemory, TakesLittleForACell) {
  constexpr int n = 12, cells = 6 * n * n * n;
  const SharedFile file{BoxMesh(3, n)};
  const auto in_use = [] {
    const struct mallinfo2 heap = mallinfo2();
    return static_cast<double>(heap.uordblks + heap.hblkhd);
  };
  const double before = in_use();
  const auto mesh = BackgroundMesh<3>::read(PETSC_COMM_SELF, file.name(), {});
  ASSERT_EQ(mesh.cell_count(), cells);
  EXPECT_LT((in_use() - before) / cells, 220);
}

TEST(MeshOnRanksOfACoarseCube, IsASliceWithPatchesOfFour) {
  const SharedFile file{BoxMesh(3, 1)};
  const auto mesh = BackgroundMesh<3>::read(PETSC_COMM_WORLD, file.name(), {});
  EXPECT_TRUE(mesh.report().one_element_slice);
  EXPECT_EQ(sum(mesh.cell_count()), 6);  // some ranks hold no cell at all
}

}  // namespace
}  // namespace talus
