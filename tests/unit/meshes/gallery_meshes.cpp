#include <gtest/gtest.h>

#include <cmath>

#include "box_mesh.h"
#include "meshes/background_mesh.h"
#include "meshes/section.h"

namespace talus {
namespace {

using test::SharedFile;
using test::sum;

/// The mesh that talus-mesh makes of one of the gallery's sections.
class GalleryFile : public SharedFile {
 public:
  GalleryFile(const std::string &section, const std::string &options)
      : SharedFile([&](const std::string &file) {
          const std::string command =
              TALUS_MESH " " TALUS_SECTIONS + section + ".csv -o " + file + " " + options + " > /dev/null";
          EXPECT_EQ(std::system(command.c_str()), 0) << command;
        }) {}
};

template <int dim>
BackgroundMesh<dim> read(const SharedFile &file) {
  return BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file.name(), {});
}

template <int dim>
double volume_of(const BackgroundMesh<dim> &mesh, const std::string &region) {
  double volume = 0;
  for (int c : mesh.region(region)) volume += mesh.volume[c];
  return sum(volume);
}

template <int dim>
double area_of(const BackgroundMesh<dim> &mesh, const std::string &group) {
  double area = 0;
  for (const auto &facet : mesh.facets(group)) area += facet.area;
  return sum(area);
}

TEST(GalleryMesh, SelborneHasTheAreasOfItsSection) {
  const GalleryFile file("selborne", "--size 1.5");
  const auto mesh = read<2>(file);
  EXPECT_NEAR(volume_of(mesh, "unweathered"), 387.75, 1e-9);
  EXPECT_NEAR(volume_of(mesh, "weathered"), 191.25, 1e-9);
  EXPECT_NEAR(volume_of(mesh, "air"), 373, 1e-9);
  EXPECT_NEAR(area_of(mesh, "recharge_base"), 24, 1e-9);
  EXPECT_NEAR(area_of(mesh, "recharge_side"), 6, 1e-9);
  EXPECT_NEAR(area_of(mesh, "base"), 32, 1e-9);
  EXPECT_NEAR(area_of(mesh, "left"), 11, 1e-9);
  EXPECT_NEAR(area_of(mesh, "right"), 17, 1e-9);
  EXPECT_NEAR(area_of(mesh, "surface"), 56, 1e-9);
}

TEST(GalleryMesh, ASliceIsOneElementThickWithTheSectionsVolumes) {
  const GalleryFile file("column", "--size 0.02 --dimension 3");
  const auto mesh = read<3>(file);
  EXPECT_TRUE(mesh.report().one_element_slice);
  EXPECT_NEAR(volume_of(mesh, "bars"), 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(area_of(mesh, "front"), 0.52 * 0.12, 1e-12);
  EXPECT_NEAR(area_of(mesh, "back"), 0.52 * 0.12, 1e-12);
  std::vector<int> size(mesh.patch_count, 0);
  for (int p : mesh.patch) ++size[p];
  for (int one : size) EXPECT_TRUE(2 <= one && one <= 6) << one;
}

TEST(GalleryMesh, MoreLayersAndFreeTetrahedraAreNoSlice) {
  EXPECT_FALSE(
      read<3>(GalleryFile("box", "--size 0.25 --dimension 3 --thickness 0.5 --layers 2")).report().one_element_slice);
  const auto mesh = read<3>(GalleryFile("box", "--size 0.25 --dimension 3 --thickness 1 --layers 0"));
  EXPECT_FALSE(mesh.report().one_element_slice);
  EXPECT_NEAR(volume_of(mesh, "soil"), 1, 1e-9);
}

TEST(GalleryMesh, AGroupInsideTheDomainIsListedFromBothSides) {
  const auto mesh = read<2>(GalleryFile("oedometer", "--size 0.1"));
  EXPECT_NEAR(area_of(mesh, "load"), 2 * 0.3, 1e-12);
  double up = 0;
  for (const auto &facet : mesh.facets("load")) up += facet.normal[1] * facet.area;
  EXPECT_NEAR(sum(up), 0, 1e-12);
}

template <int dim>
void expect_alike(const BackgroundMesh<dim> &a, const BackgroundMesh<dim> &b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.global_cell, b.global_cell);
  EXPECT_EQ(a.patch, b.patch);
  EXPECT_EQ(a.region_names(), b.region_names());
  EXPECT_EQ(a.group_names(), b.group_names());
  for (const std::string &name : a.region_names()) EXPECT_EQ(a.region(name), b.region(name));
  for (const std::string &name : a.group_names()) EXPECT_EQ(a.facets(name).size(), b.facets(name).size());
}

TEST(GalleryMesh, Formats22And41LoadAlike) {
  const std::string flat = "--size 2 --format ", slice = "--size 2 --dimension 3 --format ";
  expect_alike(read<2>(GalleryFile("selborne_deck", flat + "2.2")),
               read<2>(GalleryFile("selborne_deck", flat + "4.1")));
  expect_alike(read<3>(GalleryFile("selborne_deck", slice + "2.2")),
               read<3>(GalleryFile("selborne_deck", slice + "4.1")));
}

}  // namespace
}  // namespace talus
