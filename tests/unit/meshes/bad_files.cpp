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
               {"PETSc cannot read it"});
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

}  // namespace
}  // namespace talus
