#include <gtest/gtest.h>

#include "box_mesh.h"
#include "meshes/background_mesh.h"

namespace talus {
namespace {

using test::BoxMesh;
using test::SharedFile;

/// The complaint about a file, which must be the same text on all ranks.
template <int dim>
std::string complaint(const std::string &file) {
  std::string text;
  try {
    (void)BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file, {});
  } catch (const std::invalid_argument &error) {
    text = error.what();
  }
  char first[1000] = "";
  text.copy(first, sizeof first - 1);
  MPI_Bcast(first, sizeof first, MPI_CHAR, 0, PETSC_COMM_WORLD);
  EXPECT_EQ(text, first);
  return text;
}

template <int dim>
std::string complaint(const BoxMesh &mesh) {
  return complaint<dim>(SharedFile(mesh).name());
}

std::string complaint_about_text(const std::string &content) {
  return complaint<3>(SharedFile([&](const std::string &file) { std::ofstream(file) << content; }).name());
}

void expect_words(const std::string &text, const std::vector<std::string> &words) {
  for (const std::string &word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
}

TEST(BadFile, AMissingFileIsNamed) { expect_words(complaint<2>("no/such.msh"), {"no/such.msh", "cannot be read"}); }

TEST(BadFile, AFileThatCannotBeReadIsNamed) {  // it can be opened, but not read at address 0
  expect_words(complaint<2>("/proc/self/mem"), {"/proc/self/mem: cannot be read (Input/output error)"});
}

TEST(BadFile, ATagHasAPositiveCounterpart) {
  const std::string head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"soil\"\n$EndPhysicalNames\n";
  expect_words(complaint_about_text(head + "$Entities\n1 0 0 0\n1 0 0 0 1 -2147483648\n$EndEntities\n"),
               {"the number 2147483648 is out of its range"});
}

TEST(BadFile, GarbageIsNotAMesh) {
  expect_words(complaint_about_text("these are\nnot the numbers\n"), {"not a Gmsh mesh", "$MeshFormat"});
  expect_words(complaint_about_text(""), {"empty"});
  expect_words(complaint_about_text("$MeshFormat\n1.0 0 8\n$EndMeshFormat\n"), {"format 1.0", "4.1"});
}

TEST(BadFile, AMeshWithoutNamesIsRefused) {
  expect_words(complaint_about_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n0\n$EndNodes\n"),
               {"no named groups"});
}

TEST(BadFile, ATruncatedOrDamagedFileIsRefusedQuietly) {
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"soil\"\n$EndPhysicalNames\n";
  expect_words(complaint_about_text(head + "$Nodes\n1\n1 0 0 0\n"), {"ends early"});
  expect_words(complaint_about_text(head + "$Nodes\n3\n1 0 0 0\nfour\n$EndNodes\n$Elements\n0\n$EndElements\n"),
               {"line 11", "'four' stands where a number belongs", "save it again"});
  expect_words(complaint_about_text(head + "$Nodes\n900000000\n1 0 0 0\n$EndNodes\n"),
               {"line 9", "900000000 entries are announced"});
}

TEST(BadFile, AnElementMustNameNodesThatAreThere) {
  BoxMesh absent(2, 2), twice(3, 2);
  absent.cell[3][1] = 99;
  expect_words(complaint<2>(absent), {"names the node 100, which is not in the file", "save it again"});
  twice.cell[3][1] = twice.cell[3][2];
  expect_words(complaint<3>(twice), {"names the node ", " twice", "save it again"});
}

TEST(BadFile, ANodeMayBeThereOnce) {
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"soil\"\n$EndPhysicalNames\n";
  expect_words(complaint_about_text(head + "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n2 5 5 5\n$EndNodes\n"
                                           "$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"),
               {"node 2 is there twice"});
}

TEST(BadFile, APlaneMeshHasOneZ) {
  BoxMesh mesh(2, 2);
  for (auto &x : mesh.node) x[2] = 5;
  EXPECT_EQ(complaint<2>(mesh), "");
  mesh.node[4][2] = 5.01;
  expect_words(complaint<2>(mesh), {"is not plane", "z = 5 m at (0, 0)", "z = 5.01 m at (", "y upward"});
}

TEST(BadFile, AGroupIsMadeOfSidesOfCells) {
  BoxMesh mesh(2, 2);
  mesh.facet[0] = {mesh.number(0, 0, 0), mesh.number(2, 2, 0)};
  expect_words(complaint<2>(mesh), {"element 1 of the group 'base' is not the side of a cell", "remesh"});
}

TEST(BadFile, PartsThatLieInOnePlaceAreNamed) {
  BoxMesh plane(2, 4), space(3, 2);
  plane.part_upper_half(0.05, -0.1), space.part_upper_half(0.05, -0.1);
  expect_words(complaint<2>(plane), {"overlaps cell ", "in lower", "in upper", "BooleanFragments"});
  expect_words(complaint<3>(space), {"overlaps cell ", "in lower", "in upper", "BooleanFragments"});
}

TEST(BadFile, TheDimensionMustFit) {
  expect_words(complaint<3>(BoxMesh(2, 2)), {"surfaces at most", "dimension 3"});
  expect_words(complaint<2>(BoxMesh(3, 2)), {"volumes at most", "dimension 2"});
}

TEST(BadFile, ACellOfNoVolumeIsNamedWithItsPlaceAndRegion) {
  BoxMesh flat(3, 2);
  flat.node[flat.cell[7][3]] = flat.node[flat.cell[7][2]];
  expect_words(complaint<3>(flat), {"has no volume", "centroid", "in lower", "remesh"});
  BoxMesh thin(2, 2);
  const auto &corner = thin.cell[5];
  for (int d = 0; d < 2; ++d) thin.node[corner[2]][d] = (thin.node[corner[0]][d] + thin.node[corner[1]][d]) / 2;
  expect_words(complaint<2>(thin), {"has no area", "cell "});
}

TEST(BadFile, ACellInNoNamedGroupIsNamed) {
  BoxMesh mesh(2, 2);
  mesh.cell_tag[3] = 99;
  expect_words(complaint<2>(mesh), {"cell 3 (centroid", "is in no named group of cells"});
}

TEST(BadFile, FoldedCellsAreNamed) {
  BoxMesh mesh(2, 4);
  mesh.node[mesh.number(2, 2, 0)][0] += 0.6;
  expect_words(complaint<2>(mesh), {"overlaps", "inverted"});
}

TEST(BadFile, ARepeatedCellIsNamed) {
  BoxMesh mesh(3, 2);
  mesh.cell.push_back(mesh.cell[4]);
  mesh.cell_tag.push_back(2);
  expect_words(complaint<3>(mesh), {"twice"});
}

TEST(BadFile, ANameThatDMPlexNeedsIsRefused) {
  expect_words(complaint_about_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"depth\"\n"
                                    "$EndPhysicalNames\n$Nodes\n0\n$EndNodes\n$Elements\n0\n$EndElements\n"),
               {"'depth'", "rename"});
}

std::vector<std::string> remarks(const BoxMesh &box) {
  const SharedFile file(box);
  return box.dim == 2 ? BackgroundMesh<2>::read(PETSC_COMM_WORLD, file.name(), {}).report().remarks
                      : BackgroundMesh<3>::read(PETSC_COMM_WORLD, file.name(), {}).report().remarks;
}

/// Claims about remarks, which only the first rank has.
void expect_remark(const BoxMesh &box, const std::vector<std::string> &words) {
  const std::vector<std::string> found = remarks(box);
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank) return;
  ASSERT_EQ(found.size(), 1u);
  expect_words(found[0], words);
}

TEST(MeshRemark, ASoundMeshHasNone) {
  EXPECT_TRUE(remarks(BoxMesh(2, 4)).empty());
  EXPECT_TRUE(remarks(BoxMesh(3, 4)).empty());
}

TEST(MeshRemark, NodesThatWereNotMergedAreACrack) {
  BoxMesh plane(2, 4), space(3, 2);
  plane.part_upper_half(0, 0), space.part_upper_half(0, 0);
  expect_remark(plane, {"8 sides of cells from (0, 0.5) m to (1, 0.5) m", "in lower", "in upper", "Merge the nodes"});
  expect_remark(space, {"16 sides of cells from (0, 0.5, 0) m to (1, 0.5, 1) m", "no particle can pass"});
}

TEST(MeshRemark, SidesThatMeetOthersInTheirMiddleAreACrack) {
  BoxMesh mesh(2, 4);
  mesh.part_upper_half(0.125, 1e-5);
  expect_remark(mesh, {"7 sides of cells from (0, 0.5) m to (1, 0.5) m", "cracked there"});
}

/// Two triangles or one tetrahedron of second order in a file; the node on the edge from (0, 0) to (1, 0) lies at y =
/// `rise`.
std::string second_order(int dim, double rise) {
  const std::string y = std::to_string(rise);
  if (dim == 2)
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"soil\"\n$EndPhysicalNames\n$Nodes\n9\n"
           "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.5 " +
           y +
           " 0\n6 1 0.5 0\n7 0.5 0.5 0\n8 0.5 1 0\n9 0 0.5 0\n$EndNodes\n$Elements\n2\n"
           "1 9 2 1 1 1 2 3 5 6 7\n2 9 2 1 1 1 3 4 7 8 9\n$EndElements\n";
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"soil\"\n$EndPhysicalNames\n$Nodes\n10\n"
         "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0.5 " +
         y +
         " 0\n6 0.5 0.5 0\n7 0 0.5 0\n8 0 0 0.5\n9 0 0.5 0.5\n10 0.5 0 0.5\n$EndNodes\n$Elements\n1\n"
         "7 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n";
}

template <int dim>
std::vector<std::string> remarks_of_text(const std::string &content) {
  const SharedFile file([&](const std::string &name) { std::ofstream(name) << content; });
  return BackgroundMesh<dim>::read(PETSC_COMM_SELF, file.name(), {}).report().remarks;
}

TEST(MeshRemark, CellsOfSecondOrderAreTakenByTheirCorners) {
  const auto expect_last = [](const std::vector<std::string> &found, const std::vector<std::string> &words) {
    ASSERT_FALSE(found.empty());
    expect_words(found.back(), words);
  };
  expect_last(remarks_of_text<2>(second_order(2, 0)), {"2 cells are of second or higher order", "nothing is lost"});
  expect_last(remarks_of_text<3>(second_order(3, 0)), {"1 cell is of second or higher order", "nothing is lost"});
  expect_last(remarks_of_text<2>(second_order(2, -0.04)), {"up to 0.04 of the edge beside it", "is lost"});
  expect_last(remarks_of_text<3>(second_order(3, -0.04)), {"up to 0.04 of the edge beside it"});
}

/// The order of nodes on edges is that of Gmsh: with another one straight elements would have bent edges.
TEST(BadFile, CellsWithCurvedEdgesAreRefused) {
  const auto about = [](int dim, double rise) {
    const SharedFile file([&](const std::string &name) { std::ofstream(name) << second_order(dim, rise); });
    return dim == 2 ? complaint<2>(file.name()) : complaint<3>(file.name());
  };
  expect_words(about(2, -0.06), {"element 1 has a curved edge", "node 5 at (0.5, -0.06) m lies 0.06 of the edge",
                                 "Mesh.ElementOrder = 1"});
  expect_words(about(3, 0.06), {"element 7 has a curved edge", "node 5 at (0.5, 0.06, 0) m lies 0.06 of the edge"});
  EXPECT_EQ(about(2, 0.04), "");
}

TEST(MeshRemark, APartWithoutNeighboursIsNamed) {
  BoxMesh mesh(2, 4);
  mesh.part_upper_half(0, 0.5);
  expect_remark(mesh, {"2 parts that share no side", "of 16 cells at (", "in upper"});
}

TEST(MeshRemark, ASliverIsNamed) {
  BoxMesh mesh(2, 2);
  mesh.node[mesh.number(1, 1, 0)][1] = 0.02;
  expect_remark(mesh, {"quality below 0.2", "the worst has", "in lower"});
}

TEST(MeshRemark, ATinyEdgeIsNamed) {
  BoxMesh mesh(2, 4);
  mesh.node[mesh.number(2, 2, 0)] = mesh.node[mesh.number(2, 1, 0)];
  mesh.node[mesh.number(2, 2, 0)][1] += 1e-3;
  const std::vector<std::string> found = remarks(mesh);
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank) return;
  ASSERT_EQ(found.size(), 2u);  // it makes slivers too
  expect_words(found[1], {"shortest edge measures 0.001 m", "determines the step"});
}

TEST(GmshFile, AllFormsGiveTheSameMesh) {
  for (int dim : {2, 3}) {
    const BoxMesh box(dim, 4);
    std::vector<std::vector<double>> numbers;
    for (const bool is_new : {false, true})
      for (const bool binary : {false, true}) {
        const SharedFile file([&](const std::string &name) { box.write(name, {is_new, binary}); });
        const auto take = [&](const auto &mesh) {
          auto &all = numbers.emplace_back();
          for (const auto &x : mesh.position) all.insert(all.end(), x.begin(), x.end());
          for (const auto &cell : mesh.cells) all.insert(all.end(), cell.node.begin(), cell.node.end());
          for (const char *group : {"base", "top", "middle"})
            for (const auto &facet : mesh.facets(group)) all.insert(all.end(), {1. * facet.cell, 1. * facet.face});
          for (const char *region : {"lower", "upper"}) all.push_back(static_cast<double>(mesh.region(region).size()));
        };
        dim == 2 ? take(BackgroundMesh<2>::read(PETSC_COMM_WORLD, file.name(), {}))
                 : take(BackgroundMesh<3>::read(PETSC_COMM_WORLD, file.name(), {}));
      }
    for (const auto &of_form : numbers) EXPECT_EQ(of_form, numbers[0]);
  }
}

/// A damaged file is refused with a text, or read as another mesh that is sound; nothing else may happen.
template <int dim>
bool is_refused(const std::string &content) {
  const SharedFile file([&](const std::string &name) { std::ofstream(name, std::ios::binary) << content; });
  const std::string text = complaint<dim>(file.name());
  EXPECT_TRUE(text.empty() || text.find(".msh") != std::string::npos) << text;
  return !text.empty();
}

TEST(GmshFile, EveryTruncationAndFlippedBitIsRefusedOrRead) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const std::size_t trials = ranks == 1 ? 400 : 4;  // of each kind and form; reading is the first rank's work
  for (int dim : {2, 3})
    for (const bool is_new : {false, true})
      for (const bool binary : {false, true}) {
        const std::string sound = BoxMesh(dim, 2).content({is_new, binary});
        const auto refused = [&](const std::string &content) {
          return dim == 2 ? is_refused<2>(content) : is_refused<3>(content);
        };
        EXPECT_FALSE(refused(sound));
        const std::size_t complete = sound.size() - std::string("$EndElements\n").size();
        int read = 0;
        for (std::size_t i = 0; i < trials; ++i) {
          EXPECT_TRUE(refused(sound.substr(0, i * complete / trials))) << "cut at " << i * complete / trials;
          std::string flipped = sound;
          flipped[i * 7919 % sound.size()] ^= static_cast<char>(1 << i % 8);
          read += !refused(flipped);
        }
        EXPECT_LT(read, static_cast<int>(trials));
      }
}

}  // namespace
}  // namespace talus
