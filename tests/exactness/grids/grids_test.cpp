// A grid of a linear function is that function: whatever reads a grid by place does what it does with the expression,
// to round-off. And what a grid does not say is refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

using Overrides = std::vector<std::string>;
const std::string block = std::string(TALUS_VERIFICATION) + "/incline_block/scene.toml";

int rank() {
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

class Grids : public ::testing::Test {
 protected:
  std::filesystem::path folder;
  void SetUp() override {
    int process = static_cast<int>(getpid());  // of rank 0: other runs of the test have files of their own
    MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    folder = std::filesystem::path(P_tmpdir) / ("talus_grids_" + std::to_string(process));
    if (rank() == 0) std::filesystem::create_directories(folder);
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  void TearDown() override {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank() == 0) std::filesystem::remove_all(folder);
  }
  std::string in_folder(const std::string &name) const { return (folder / name).string(); }

  using Value = std::function<double(double x, double y)>;
  /// From (west, south), `columns` x `rows` values 0.5 m apart.
  std::string grid(const std::string &name, const Value &value, int columns = 21, int rows = 7, double west = -1,
                   double south = -1, double spacing = 0.5) const {
    if (rank() == 0) {
      std::ofstream file(in_folder(name));
      file.precision(17);
      file << "ncols " << columns << "\nnrows " << rows << "\nxllcenter " << west << "\nyllcenter " << south
           << "\ncellsize " << spacing << "\nNODATA_value -9999\n";
      for (int j = rows - 1; j >= 0; --j)
        for (int i = 0; i < columns; ++i)
          file << value(west + i * spacing, south + j * spacing) << (i + 1 < columns ? " " : "\n");
    }
    MPI_Barrier(PETSC_COMM_WORLD);
    return in_folder(name);
  }

  static RunOptions quiet() {
    RunOptions options;
    options.pictures = options.screen = false;
    return options;
  }
  static Snapshot end_of(const std::string &file, Overrides overrides, bool runs = true) {
    overrides.emplace_back("stage.0.duration=0.1");
    Scene scene = read_scene(file, overrides);
    const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, quiet());
    if (runs) simulation->run();
    return simulation->snapshot();
  }
  /// Each value of the particles within round-off of the largest of its column.
  static void expect_same(const Snapshot &a, const Snapshot &b, double tolerance = 1e-9) {
    ASSERT_EQ(a.id, b.id);
    ASSERT_EQ(a.columns.size(), b.columns.size());
    for (std::size_t k = 0; k < a.columns.size(); ++k) {
      double largest = 0, difference = 0;
      for (std::size_t i = 0; i < a.columns[k].values.size(); ++i) {
        largest = std::max<double>(largest, std::abs(a.columns[k].values[i]));
        difference = std::max<double>(difference, std::abs(a.columns[k].values[i] - b.columns[k].values[i]));
      }
      // round-off, grown over a hundred steps; columns that are zero but for it have no size to compare with
      EXPECT_LE(difference, tolerance * largest + 1e-15) << "column " << k;
    }
  }
  static bool differ(const Snapshot &a, const Snapshot &b) {
    double difference = 0;
    for (std::size_t i = 0; i < a.columns[0].values.size(); ++i)
      difference = std::max<double>(difference, std::abs(a.columns[0].values[i] - b.columns[0].values[i]));
    MPI_Allreduce(MPI_IN_PLACE, &difference, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    return difference > 1e-6;  // [m], of positions
  }
  /// Ends with these words in its complaint.
  static void expect_refused(const std::function<void()> &what, const Overrides &words) {
    try {
      what();
      FAIL() << "was not refused";
    } catch (const std::exception &error) {
      for (const std::string &word : words)
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
};

TEST_F(Grids, friction_of_the_base_slides_as_its_expression_does) {
  const std::string file = grid("a.asc", [](double x, double y) { return 15 + 2 * x + 3 * y; });
  const Snapshot number = end_of(block, {});
  const Snapshot expression = end_of(block, {"boundary.base.friction_angle=15 + 2 * x + 3 * y"});
  expect_same(expression, end_of(block, {"grids.angle=" + file, "boundary.base.friction_angle=angle(x, y)"}));
  EXPECT_TRUE(differ(expression, number));
}

/// What is stored as 10 times the angle less 1000 is the angle, by the scale and the offset of a band; the run says so.
TEST_F(Grids, have_the_scale_and_offset_of_their_band) {
  const std::string file = grid("a.asc", [](double x, double y) { return 15 + 2 * x + 3 * y; });
  grid("stored.asc", [](double x, double y) { return 10 * (15 + 2 * x + 3 * y) - 10000; });
  if (rank() == 0)
    std::ofstream(in_folder("a.vrt"))
        << "<VRTDataset rasterXSize='21' rasterYSize='7'><GeoTransform>-1.25, 0.5, 0, 2.25, 0, -0.5</GeoTransform>"
        << "<VRTRasterBand dataType='Float64' band='1'><Offset>1000</Offset><Scale>0.1</Scale><SimpleSource>"
        << "<SourceFilename relativeToVRT='1'>stored.asc</SourceFilename><SourceBand>1</SourceBand></SimpleSource>"
        << "</VRTRasterBand></VRTDataset>";
  MPI_Barrier(PETSC_COMM_WORLD);
  const auto with = [&](const std::string &name) {
    return Overrides{"grids.angle=" + name, "boundary.base.friction_angle=angle(x, y)"};
  };
  expect_same(end_of(block, with(file)), end_of(block, with(in_folder("a.vrt"))), 1e-6);  // digits lost by the offset
  Scene scene = read_scene(block, with(in_folder("a.vrt")));
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, quiet());
  std::string said;
  for (const std::string &remark : simulation->mesh_report().remarks) said += remark;
  if (rank() == 0) {
    EXPECT_NE(said.find("grids.angle: "), std::string::npos) << said;
    EXPECT_NE(said.find("0.1 times those stored plus 1000"), std::string::npos) << said;
  }
}

TEST_F(Grids, strength_yields_as_its_expression_does) {
  const std::string file = grid("a.asc", [](double x, double y) { return 500 + 200 * x + 300 * y; });
  Overrides soil{"body.block.law=mohr_coulomb", "body.block.friction_angle=5"}, by_grid = soil, number = soil;
  number.emplace_back("body.block.cohesion=1e6");
  soil.emplace_back("body.block.cohesion=500 + 200 * x + 300 * y");
  by_grid.insert(by_grid.end(), {"grids.c=" + file, "body.block.cohesion=c(x, y)"});
  const Snapshot expression = end_of(block, soil);
  expect_same(expression, end_of(block, by_grid));
  EXPECT_TRUE(differ(expression, end_of(block, number)));
}

TEST_F(Grids, water_table_presses_as_its_expression_does) {
  const std::string file = grid("a.asc", [](double x, double) { return 0.2 + 0.1 * x; });
  Overrides wet{"phases=drained"}, by_grid = wet, dry = wet;
  wet.emplace_back("water.excess=max(0, 9810 * (0.2 + 0.1 * x - y))");
  by_grid.insert(by_grid.end(), {"grids.water=" + file, "water.excess=max(0, 9810 * (water(x, 0) - y))"});
  dry.emplace_back("water.density=1000");
  expect_same(end_of(block, wet, false), end_of(block, by_grid, false), 1e-12);
  const Snapshot expression = end_of(block, wet);
  expect_same(expression, end_of(block, by_grid), 1e-6);  // the water lifts the block: contacts open by round-off
  EXPECT_TRUE(differ(expression, end_of(block, dry)));
}

/// A water table presses, fills the pores and weighs alike whether it is given by points, by an expression or by a
/// grid; that soil is wet below it is seen by its mass.
TEST_F(Grids, water_table_is_that_of_its_points_and_expression) {
  grid(
      "ground.asc", [](double, double) { return 20; }, 5, 4, 5000, 2000, 10);
  grid(
      "a.asc", [](double x, double) { return 5 + 0.2 * (x - 5000); }, 9, 7, 4990, 1990, 10);
  grid(
      "b.asc", [](double x, double y) { return 5 + 0.2 * (x - 5000) + 0.1 * (y - 2000); }, 9, 7, 4990, 1990, 10);
  const auto start = [&](const std::string &water, bool runs) {
    const std::string text =
        "dimension = 3\nup = \"z\"\nphases = \"drained\"\ngravity = 9.81\n[mesh]\nsize = 10\n[mesh.terrain]\n"
        "file = \"ground.asc\"\nbase = 0\n[grids]\na = \"a.asc\"\nb = \"b.asc\"\n[body.soil]\nregion = \"ground\"\n"
        "law = \"linear_elastic\"\nyoung_modulus = 1e7\npoisson_ratio = 0.3\nunit_weight = 18e3\n"
        "saturated_unit_weight = 21e3\n[boundary.base]\nkind = \"fixed\"\n[[stage]]\nduration = 0.02\n[water]\n" +
        water;
    Scene read = parse_scene(text, in_folder("scene.toml"));
    const auto simulation = make_simulation(PETSC_COMM_WORLD, read, quiet());
    if (runs) simulation->run();
    return simulation->snapshot();
  };
  const auto mass = [](const Snapshot &state) {
    double sum = 0;
    for (const Column &column : state.columns)
      if (column.name == "mass")
        for (const double one : column.values) sum += one;
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    return sum;
  };
  for (const bool runs : {false, true}) {
    const Snapshot points = start("table = [[0, 5], [40, 13]]\n", runs);
    const double tolerance = runs ? 1e-6 : 1e-12;
    expect_same(points, start("table = \"5 + 0.2 * x\"\n", runs), tolerance);
    expect_same(points, start("table = \"a(x, y)\"\n", runs), tolerance);
  }
  expect_same(start("table = \"5 + 0.2 * x + 0.1 * y\"\nlevel = 1\n", true),
              start("table = \"b(x, y)\"\nlevel = 1\n", true), 1e-6);
  // 40 m x 30 m x 20 m, of which 9 m on average are wet; by whole particles, of which there are four over 10 m or so
  const double g = 9.81, exact = 1200 * (9 * 21e3 + 11 * 18e3) / g;
  EXPECT_NEAR(mass(start("table = \"a(x, y)\"\n", false)) / exact, 1, 0.01);
  EXPECT_NEAR(mass(start("excess = \"max(0, 9810 * (a(x, y) - z))\"\n", false)) / (1200 * 20 * 18e3 / g), 1, 1e-9);
}

/// A grid counts as the terrain does: x and y of the mesh plus the origin, also where the mesh is a file.
TEST_F(Grids, count_from_the_origin_of_the_terrain) {
  const std::string ground = grid(
      "ground.asc", [](double, double) { return 20; }, 5, 4, 5000, 2000, 10);
  const std::string values = grid(
      "a.asc", [](double x, double y) { return 1e3 * (x - 5000) - 2e3 * (y - 2000); }, 9, 7, 4990, 1990, 10);
  const auto scene = [&](const std::string &mesh, const std::string &xx) {
    return "dimension = 3\nup = \"z\"\nphases = \"dry\"\ngravity = 0\n" + mesh +
           "[grids]\nstress = \"a.asc\"\n[body.soil]\nregion = \"ground\"\nlaw = \"linear_elastic\"\n"
           "young_modulus = 1e7\npoisson_ratio = 0.3\ndensity = 2000\nstress = [\"" +
           xx + "\", \"0\", \"0\", \"0\", \"0\", \"0\"]\n[[stage]]\nduration = 0.1\n";
  };
  const std::string terrain = "[mesh]\nsize = 10\n[mesh.terrain]\nfile = \"ground.asc\"\nbase = 0\n";
  const auto start = [&](const std::string &text) {
    Scene read = parse_scene(text, in_folder("scene.toml"));
    return make_simulation(PETSC_COMM_WORLD, read, quiet())->snapshot();
  };
  const std::string expression = "1e3 * x - 2e3 * y";
  expect_same(start(scene(terrain, expression)), start(scene(terrain, "stress(x, y)")));
  if (rank() == 0) {
    const std::string command = std::string(TALUS_MESH) + " " + ground + " -o " + in_folder("mesh.msh") +
                                " --size 10 --base 0 > " + in_folder("said");
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  const std::string made = "[mesh]\nfile = \"mesh.msh\"\n";
  expect_same(start(scene(made, expression)), start(scene(made, "stress(x, y)")));
}

TEST_F(Grids, have_values_where_they_are_asked) {
  const auto with = [&](const std::string &file, const std::string &angle) {
    return [=, this] { end_of(block, {"grids.angle=" + file, "boundary.base.friction_angle=" + angle}); };
  };
  const std::string short_one = grid(
      "short.asc", [](double, double) { return 20; }, 3, 7);
  expect_refused(with(short_one, "angle(x, y)"),
                 {"boundary.base.friction_angle", "short.asc has no value at (", "reaches from (-1, -1) to (0, 2)",
                  "give a grid that covers the soil"});
  expect_refused(with(short_one, "max(20, angle(x, y))"), {"short.asc has no value at ("});  // nothing hides it
  const std::string hole = grid("hole.asc", [](double x, double) { return x == 1 ? -9999 : 20; });
  expect_refused(with(hole, "angle(x, y)"), {"hole.asc has no value at (", "gdal_fillnodata.py"});
  if (rank() == 0) std::ofstream(in_folder("text.asc")) << "no grid\n";
  MPI_Barrier(PETSC_COMM_WORLD);
  expect_refused(with(in_folder("text.asc"), "angle(x, y)"), {"grids.angle", "text.asc: is no grid that GDAL reads"});
  expect_refused(with(in_folder("absent.asc"), "angle(x, y)"), {"grids.angle", "absent.asc"});
  expect_refused(with(hole, "angle(x)"), {"boundary.base.friction_angle"});
}

/// Soil that lies beside the origin of the mesh, and a water table that has values where the soil lies.
TEST_F(Grids, are_asked_where_soil_lies) {
  const std::string table = grid(
      "table.asc", [](double x, double) { return 0.2 * x; }, 9, 9, 1.5, -1);
  if (rank() == 0)
    std::ofstream(in_folder("box.csv")) << "part,x,y\noutline,2,0\noutline,3,0\noutline,3,1\noutline,2,1\n"
                                           "region_soil,2.5,0.5\n";
  MPI_Barrier(PETSC_COMM_WORLD);
  const auto end_with = [&](const std::string &table) {
    Scene read = parse_scene("phases = \"drained\"\ngravity = 10\n[mesh]\nsection = \"box.csv\"\nsize = 0.3\n" +
                                 ("[grids]\nwater = \"" + in_folder("table.asc")) + "\"\n[water]\ntable = " + table +
                                 "\n[body.soil]\nregion = \"soil\"\nporosity = 0.4\ngrain_density = 2650\n"
                                 "saturation = 0.5\nlaw = \"linear_elastic\"\nyoung_modulus = 1e7\n"
                                 "poisson_ratio = 0.2\n[boundary.walls]\ngroup = [\"base\", \"left\", \"right\"]\n"
                                 "kind = \"roller\"\n[[stage]]\nduration = 0.01\n",
                             in_folder("scene.toml"));
    const auto simulation = make_simulation(PETSC_COMM_WORLD, read, quiet());
    simulation->run();
    return simulation->snapshot();
  };
  expect_same(end_with("\"0.2 * x\""), end_with("\"water(x, 0)\""));
}

/// A grid in another projection than the terrain is refused, whether the mesh is made by the scene or is a file;
/// results of both have the origin of the map.
TEST_F(Grids, have_the_projection_of_the_terrain) {
  const auto zone = [&](const std::string &file, int number) {
    if (rank() == 0)
      std::ofstream(std::filesystem::path(file).replace_extension(".prj"))
          << "PROJCS[\"WGS_1984_UTM_Zone_" << number << "N\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",SPHEROID["
          << "\"WGS_1984\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"Degree\",0.0174532925199433]],"
          << "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\","
          << 6 * number - 183 << "],PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],"
          << "PARAMETER[\"false_northing\",0],UNIT[\"Meter\",1]]";
    MPI_Barrier(PETSC_COMM_WORLD);
  };
  const std::string ground = grid(
      "ground.asc", [](double, double) { return 20; }, 5, 4, 505000, 5.1e6, 10);
  const std::string values = grid(
      "a.asc", [](double, double) { return 1e3; }, 9, 7, 504990, 5.1e6 - 10, 10);
  zone(ground, 32);
  if (rank() == 0) {
    const std::string command = std::string(TALUS_MESH) + " " + ground + " -o " + in_folder("mesh.msh") +
                                " --size 10 --base 0 > " + in_folder("said");
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  std::string soil =
      "[grids]\nstress = \"a.asc\"\n[body.soil]\nregion = \"ground\"\nlaw = \"linear_elastic\"\n"
      "young_modulus = 1e7\npoisson_ratio = 0.3\ndensity = 2000\n"
      "stress = [\"stress(x, y)\", \"0\", \"0\", \"0\", \"0\", \"0\"]\n[[stage]]\nduration = 1e-3\n";
  for (const std::string mesh :
       {"size = 10\n[mesh.terrain]\nfile = \"ground.asc\"\nbase = 0\n", "file = \"mesh.msh\"\n"}) {
    const auto run = [&] {
      Scene scene = parse_scene("dimension = 3\nup = \"z\"\nphases = \"dry\"\ngravity = 0\n[mesh]\n" + mesh + soil,
                                in_folder("scene.toml"));
      RunOptions options = quiet();
      options.directory = in_folder("results"), options.replace = true;
      make_simulation(PETSC_COMM_WORLD, scene, options)->run();
    };
    zone(values, 33);
    expect_refused(run,
                   {"grids.stress", "a.asc: has the projection", "33N", "ground.asc has", "32N", "gdalwarp -t_srs"});
    zone(values, 32);
    run();
    soil += "[output.point.well]\nposition = [505015.125, 5100012, 19]\n";  // a place of the map
    expect_refused(run, {"output.point.well.position", "the nearest particle is",
                         "x and y count from the corner of the mesh, which is at (505000, 5100000) m of the map"});
    soil.erase(soil.find("[output"));
    std::ostringstream origin;
    origin << std::ifstream(in_folder("results/origin.json")).rdbuf();
    for (const char *word : {"\"origin_m\":[505000.0,5100000.0]", "32N", "ground.asc"})
      EXPECT_NE(origin.str().find(word), std::string::npos) << word << " is not in: " << origin.str();
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank() == 0) std::filesystem::remove_all(in_folder("results"));
    MPI_Barrier(PETSC_COMM_WORLD);
  }
}

/// A mesh of terrain says so beside it, and gravity along its y would pull to the south.
TEST_F(Grids, have_z_up_in_meshes_of_terrain) {
  if (rank() == 0) {
    std::ofstream(in_folder("m.msh")) << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    std::ofstream(in_folder("m.origin.json")) << "{\"origin_m\": [5000, 2000]}\n";
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  const auto run = [&] {
    make_simulation(PETSC_COMM_WORLD,
                    parse_scene("dimension = 3\nphases = \"dry\"\ngravity = 9.81\n[mesh]\nfile = \"m.msh\"\n"
                                "[body.soil]\nregion = \"soil\"\nlaw = \"linear_elastic\"\nyoung_modulus = 1e7\n"
                                "poisson_ratio = 0.3\ndensity = 2000\n[[stage]]\nduration = 1\n",
                                in_folder("scene.toml")),
                    quiet());
  };
  expect_refused(run, {"mesh.file", "is a mesh of terrain", "set dimension = 3 and up = \"z\""});
}

/// Seen from above, with y up, north is -z.
TEST_F(Grids, are_not_mirrored) {
  const auto read = [](const std::string &up, const std::string &call) {
    return [=] {
      parse_scene("dimension = 3\nup = \"" + up +
                      "\"\nphases = \"drained\"\ngravity = 9.81\n[mesh]\nfile = \"a.msh\"\n"
                      "[grids]\nbed = \"a.asc\"\n[water]\nexcess = \"" +
                      call +
                      "\"\n[body.soil]\nregion = \"a\"\n"
                      "law = \"linear_elastic\"\nyoung_modulus = 1e7\npoisson_ratio = 0.3\ndensity = 2000\n"
                      "[[stage]]\nduration = 1\n",
                  "scene.toml");
    };
  };
  expect_refused(read("y", "max(0, bed(x + 1, z ) - y)"), {"north is -z", "mirror image", "write bed(x, -z)"});
  EXPECT_NO_THROW(read("y", "bed(x, -z)")());
  EXPECT_NO_THROW(read("z", "bed(x, z)")());
  expect_refused(read("z", "bedd(x, y)"), {"there is no function or grid `bedd`; did you mean `bed`?"});
}

/// Another content of the file is another scene.
TEST_F(Grids, tie_a_resumed_run_to_their_content) {
  const auto constant = [&](double angle) { return grid("a.asc", [=](double, double) { return angle; }); };
  const auto run = [&](bool resume) {
    Scene scene = read_scene(block, {"grids.angle=" + in_folder("a.asc"), "boundary.base.friction_angle=angle(x, y)",
                                     "stage.0.duration=" + std::string(resume ? "0.06" : "0.05")});
    RunOptions options = quiet();
    options.directory = in_folder("results"), options.resume = resume;
    make_simulation(PETSC_COMM_WORLD, scene, options)->run();
  };
  constant(20);
  run(false);
  run(true);
  constant(21);
  expect_refused([&] { run(true); }, {"grids.angle", "is not what it was"});
}

}  // namespace
}  // namespace talus
