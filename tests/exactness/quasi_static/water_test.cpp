// Seepage and consolidation where the answer is known.
#include "scene/scene.h"
#include "solved.h"

namespace talus {
namespace {

const std::string wet_block = R"(
gravity = 10
phases = "saturated"
[mesh]
section = "box.csv"
size = 0.3
[water]
table = [[0, 0.5]]
bulk_modulus = "100 GPa"
[body.soil]
region = "soil"
porosity = 0.3
grain_density = 2600
permeability = 1e-12
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
[boundary.walls]
group = ["base", "left", "right"]
kind = "roller"
)";

/// Full pores, open to the atmosphere above: whatever the pressure was, it becomes that of water at rest, and no force
/// acts on particles that take it over but their weight under water.
TEST(Water, comes_to_rest_and_stays) {
  const std::string text = wet_block +
                           "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n"
                           "[[stage]]\nname = \"soil\"\nkind = \"quasi_static\"\nduration = 1\n";
  for (const int dim : {2, 3}) {
    const Solved solved = solve(text, std::vector<std::string>{"quasi_static.tolerance=1e-8"} +
                                          (dim == 3 ? in_3d + std::vector<std::string>{"boundary.front.kind=roller",
                                                                                       "boundary.back.kind=roller"}
                                                    : std::vector<std::string>{}));
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        return solved.value("pore_pressure", p) / 1e4 - (1 - solved.value("position", p, 1));
                      }),
              1e-6);  // a hundred times the tolerance, which is above the round-off of so slow a flux, 4e-10
    const double weight = 10 * (0.7 * 2600 - 0.7 * 1000);  // of the grains less that of the water they displace
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        return solved.value("stress", p, 1) / weight + (1 - solved.value("position", p, 1));
                      }),
              1e-6);
  }
}

/// Rain that the ground can take passes through full pores at its own rate: pressure falls by what Darcy's law leaves
/// of the weight of the water, and as much leaves below.
TEST(Water, passes_through_at_the_rate_of_the_rain) {
  constexpr double rain = 5e-6, weight = 1e4, conductivity = 1e-12 / 1e-3;
  const std::string text = wet_block +
                           "[boundary.rain]\ngroup = \"surface\"\nkind = \"flux\"\ninflow = 5e-6\n"
                           "[boundary.well]\ngroup = \"base\"\nkind = \"pore_pressure\"\npressure = 7e3\n"
                           "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n";
  for (const int dim : {2, 3}) {
    const Solved solved =
        solve(text, std::vector<std::string>{"quasi_static.tolerance=1e-8"} +
                        (dim == 3 ? in_3d + std::vector<std::string>{"boundary.sides.group=[\"front\", \"back\"]",
                                                                     "boundary.sides.kind=roller"}
                                  : std::vector<std::string>{}));
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        const double y = solved.value("position", p, 1);
                        return (solved.value("pore_pressure", p) - 7e3 + (weight - rain / conductivity) * y) / 7e3;
                      }),
              1e-6)
        << dim;  // a hundred times the tolerance, as above
    EXPECT_NEAR(solved.history.column("rain_inflow_m3_s").back(), rain, 1e-6 * rain);
    EXPECT_NEAR(solved.history.column("well_inflow_m3_s").back(), -rain, 1e-5 * rain);
  }
}

/// Rain counts per level area: soil whose ground slopes by 30 degrees (gravity is turned) catches the cosine of it,
/// named or as the free surface, and a wall and an overhang nothing.
TEST(Water, of_rain_falls_on_the_area_of_the_map) {
  constexpr double rain = 1e-6;
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"silt\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.27\n"
                           "[boundary.rain]\nkind = \"rainfall\"\nintensity = 1e-6\n"
                           "[[stage]]\nname = \"rain\"\nkind = \"seepage\"\nduration = 1000\n";
  const auto entered = [&](const std::vector<std::string> &keys, double part) {
    const Solved solved = solve(text, std::vector<std::string>{"phases=unsaturated", "water.table=[[0, -9]]",
                                                               "water.suction=20e3", "water.bulk_modulus=1e7"} +
                                          keys);
    EXPECT_NEAR(solved.history.column("rain_inflow_m3_s").back(), part * rain, 1e-12 * rain) << keys[0] << keys[1];
  };
  const double slope = std::sqrt(0.75);
  for (const char *group : {"boundary.rain.group=\"surface\"", "boundary.rain.group=\"free_surface\""}) {
    entered({group, "gravity=[0, -10]"}, 1);
    entered({group, "gravity=[5, -8.660254037844386]"}, slope);
    entered({group, "gravity=0"}, 1);
  }
  const char *left = "boundary.rain.group=\"left\"";
  entered({left, "gravity=[0, -10]", "boundary.walls.group=[\"base\", \"right\"]"}, 0);
  entered({left, "gravity=[-5, -8.660254037844386]", "boundary.walls.group=[\"base\", \"right\"]"}, 0);
  entered({left, "gravity=[5, -8.660254037844386]", "boundary.walls.group=[\"base\", \"right\"]"}, 0.5);
}

/// A drain across the soil takes the water that comes from a pond above; below it, over a closed base, water is at
/// rest.
const std::string drained_block =
    wet_block + "[boundary.pond]\ngroup = \"surface\"\nkind = \"head\"\nlevel = 1.2\n" +
    "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = \"1 day\"\n";
const std::vector<std::string> with_drain{"mesh.section=" + std::string(TALUS_DRAIN), "water.table=[[0, 1.2]]",
                                          "body.soil.region=[\"upper\", \"lower\"]"};

TEST(Water, leaves_by_a_drain_inside_the_soil) {
  constexpr double taken = 1e-5 * (1.2 - 0.4) / 0.6;  // conductivity, head and length of the way from the pond
  for (const int dim : {2, 3})
    for (const std::vector<std::string> &kind :
         {std::vector<std::string>{"boundary.drain.kind=pore_pressure"},
          {"boundary.drain.kind=head", "boundary.drain.level=0.4"},
          {"boundary.drain.kind=flux", "boundary.drain.inflow=-6.6666666667e-6"}}) {
      const Solved solved = solve(
          drained_block, with_drain + kind +
                             (dim == 3 ? in_3d + std::vector<std::string>{"boundary.ends.group=[\"front\", \"back\"]",
                                                                          "boundary.ends.kind=roller"}
                                       : std::vector<std::string>{}));
      EXPECT_NEAR(solved.history.column("drain_inflow_m3_s").back(), -taken, 1e-5 * taken) << dim << kind[0];
      EXPECT_LT(largest(solved, 1,
                        [&](size_t p, int) {
                          const double y = solved.value("position", p, 1);
                          const double exact = y > 0.4 ? 2e3 * (y - 0.4) / 0.6 : 1e4 * (0.4 - y);
                          return (solved.value("pore_pressure", p) - exact) / 1e4;
                        }),
                1e-5)
          << dim << kind[0];
    }
}

/// Motion knows no drains and seepage no walls there, and a face on which a stage puts soil is the ground alone.
TEST(Water, has_no_other_boundaries_inside_the_soil) {
  const auto complaint = [&](const std::vector<std::string> &keys) {
    try {
      (void)solve(drained_block, with_drain + keys);
    } catch (const SceneError &error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto refused = [&](const std::vector<std::string> &keys) {
    const std::string said = complaint(keys);
    return said.find("boundary.drain.kind") != std::string::npos &&
           said.find("lies inside the soil") != std::string::npos;
  };
  EXPECT_TRUE(refused({"boundary.drain.kind=pore_pressure", "stage.0={kind='dynamic', duration=1}"}));
  EXPECT_FALSE(refused({"boundary.drain.kind=pore_pressure"}));
  EXPECT_TRUE(refused({"boundary.drain.kind=impermeable"}));
  EXPECT_TRUE(refused({"boundary.drain.kind=rainfall"}));
  const Solved filled =
      solve(drained_block,
            with_drain + std::vector<std::string>{
                             "boundary.drain.kind=pore_pressure", "body.soil.region=lower", "stage.0.add=fill",
                             "body.fill={region='upper', porosity=0.3, grain_density=2600, permeability=1e-12, "
                             "law='linear_elastic', young_modulus=1e7, poisson_ratio=0.3}"});
  EXPECT_EQ(filled.history.column("drain_inflow_m3_s").back(), 0);
}

/// Half of a strip of 4 m on clay whose undrained strength grows with depth, loaded within an hour.
const std::string loaded_clay = R"(
phases = "saturated"
gravity = 9.81
[mesh]
size = 1
[body.clay]
region = "clay"
porosity = 0.5
grain_density = 2700
hydraulic_conductivity = "1e-9 m/s"
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.33
cohesion = "5 kPa"
friction_angle = 25
[water]
table = [[0, 6], [12, 6]]
[boundary.base]
kind = "fixed"
[boundary.sides]
group = ["left", "right"]
kind = "roller"
[boundary.strip]
kind = "traction"
[[stage]]
kind = "quasi_static"
duration = 1
initial_stress = "k0"
[[stage]]
name = "fill"
kind = "consolidation"
duration = 3600
[output.point.ground]
position = [0, 6]
[output.point.below]
position = [0, 5.5]
)";
const std::vector<std::string> strip{"mesh.section=" + std::string(TALUS_STRIP)};

/// A load that the clay bears is borne, and one of twice its undrained limit ends the stage in few steps.
TEST(Water, of_clay_that_fails_undrained_ends_its_consolidation) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (ranks > 1) return;  // once is enough
  const Solved stands =
      solve(loaded_clay, strip + std::vector<std::string>{"boundary.strip.pressure=[[1, 0], [3601, 20e3]]"});
  EXPECT_LT(stands.history.column("time_s").size(), 40u);
  EXPECT_EQ(stands.history.column("ground_pore_pressure_Pa").back(), 0) << "beyond the layer that drains";
  EXPECT_GT(stands.history.column("below_pore_pressure_Pa").back(), 1e4);
  try {
    (void)solve(loaded_clay, strip + std::vector<std::string>{"boundary.strip.pressure=[[1, 0], [3601, 80e3]]"});
    ADD_FAILURE();
  } catch (const RunError &error) {
    const std::string said = error.what();
    EXPECT_NE(said.find(" % of the time of stage fill ("), std::string::npos) << said;
    EXPECT_NE(said.find(" s of 3600 s): the soil fails before its pore water can flow"), std::string::npos) << said;
  }
}

/// A load that grows for days, in cells that drainage crosses meanwhile: were the pressure of the ground to jump then,
/// steps would become so short that it takes 290 of them, or the stage breaks off.
TEST(Water, goes_on_when_drainage_has_crossed_a_cell) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (ranks > 1) return;  // once is enough
  const Solved loaded = solve(
      loaded_clay, strip + std::vector<std::string>{
                               "mesh.size=0.75", "body.clay.cohesion=1e6", "body.clay.young_modulus=3e6",
                               "boundary.strip.pressure=[[1, 0], [604800, 25e3]]", "stage.fill.duration=1728000"});
  EXPECT_LT(loaded.history.column("time_s").size(), 150u);
}

/// A flux that jumps at an edge of the mesh, or in the middle of one, brings what its function says.
TEST(Water, enters_on_the_side_of_a_jump_where_it_is_pumped) {
  const std::string text = wet_block +
                           "[boundary.rain]\ngroup = \"surface\"\nkind = \"flux\"\ninflow = \"x < 0.5 ? 5e-6 : 0\"\n"
                           "[boundary.well]\ngroup = \"base\"\nkind = \"pore_pressure\"\npressure = 7e3\n"
                           "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n";
  for (const char *size : {"mesh.size=0.25", "mesh.size=0.35"}) {
    const Solved solved = solve(text, {size});
    EXPECT_NEAR(solved.history.column("rain_inflow_m3_s").back(), 2.5e-6, 1e-14) << size;
    EXPECT_NEAR(solved.history.column("well_inflow_m3_s").back(), -2.5e-6, 1e-10) << size;
  }
}

/// A seepage face lets water out and draws none in, theory of seepage (4.1): wet ground above a low water table hangs
/// on it by suction.
TEST(Water, is_not_drawn_from_the_air) {
  const std::string text =
      wet_block +
      "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = \"10 kPa\"\nshape = 0.5\n"
      "[body.soil.relative_permeability]\ncurve = \"hillel\"\n"
      "[boundary.well]\ngroup = \"base\"\nkind = \"pore_pressure\"\npressure = -5e3\n"
      "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1e5\n";
  const Solved solved = solve(text, {"phases=unsaturated", "water.table=[[0, 1]]", "quasi_static.tolerance=1e-8"});
  EXPECT_LT(largest(solved, 1,
                    [&](size_t p, int) {
                      return (solved.value("pore_pressure", p) + 5e3 + 1e4 * solved.value("position", p, 1)) / 1e4;
                    }),
            1e-5);  // a thousand times the tolerance, since dry soil conducts a sixth of what full soil does
}

/// A lake presses on its bed as much as its water presses in the pores: effective stress is the weight under water,
/// however deep the lake, and whether its boundary names the ground or the free surface.
TEST(Water, of_a_lake_rests_on_the_ground) {
  const std::string text = wet_block +
                           "[boundary.lake]\ngroup = \"surface\"\nkind = \"head\"\nlevel = 4\n"
                           "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n"
                           "[[stage]]\nname = \"soil\"\nkind = \"quasi_static\"\nduration = 1\n";
  for (const char *group : {"boundary.lake.group=surface", "boundary.lake.group=free_surface"}) {
    const Solved solved = solve(text, {"quasi_static.tolerance=1e-8", group});
    const double weight = 10 * (0.7 * 2600 - 0.7 * 1000);
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        return solved.value("stress", p, 1) / weight + (1 - solved.value("position", p, 1));
                      }),
              1e-5);  // of 30 kPa of water above, at 1e-6 as where water comes to rest
  }
}

/// Its weight is part of the total stress of soil at rest, of whose effective part the sides have a share.
TEST(Water, of_a_lake_counts_in_the_earth_pressure_at_rest) {
  const std::string text =
      wet_block +
      "[boundary.lake]\ngroup = \"free_surface\"\nkind = \"head\"\nlevel = 4\n"
      "[[stage]]\nname = \"soil\"\nkind = \"quasi_static\"\nduration = 1\ninitial_stress = \"k0\"\n";
  const Solved solved = solve(text, {"body.soil.k0=0.6", "water.table=[[0, 4]]"});
  const double weight = 10 * (0.7 * 2600 - 0.7 * 1000);
  for (const int k : {0, 1})
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        return solved.value("stress", p, k) / weight +
                               (k == 0 ? 0.6 : 1) * (1 - solved.value("position", p, 1));
                      }),
              1e-4)  // of 30 kPa of water above
        << k;
}

/// Soft soil bulges into the lake beside it, whose water is that of the seepage and not of the table before it: a lake
/// that has risen, and one that was drawn down. Without seepage a table at its level gives the same
/// water.
TEST(Water, of_a_lake_is_there_into_which_soil_slides) {
  const std::string seeps =
      "[boundary.lake]\ngroup = \"free_surface\"\nkind = \"head\"\n"
      "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\nhold_loads = true\n";
  const std::string bulges =
      "[[stage]]\nname = \"bulge\"\nduration = 0.3\n[output]\nhistory_interval = 0.01\n"
      "[output.point.edge]\nposition = [1, 0.3]\n";
  const auto way = [&](const std::string &stages, const std::string &table, std::vector<std::string> more) {
    const Solved solved =
        solve(wet_block + stages + bulges,
              more + std::vector<std::string>{"phases=drained", "mesh.section=" TALUS_LAKE, "mesh.size=0.15",
                                              "body.soil.young_modulus=5 kPa", "body.soil.saturation=1",
                                              "boundary.walls.group=[\"base\", \"left\"]",
                                              "water.table=[[0, " + table + "]]"});
    return solved.history.column("edge_displacement_m").back();
  };
  for (const auto &[level, table] : {std::pair{"1.3", "0.2"}, {"0.3", "1.6"}}) {
    const double expected = way("", level, {});
    EXPECT_GT(expected, 0.15);  // out of the cells where it was
    EXPECT_NEAR(way(seeps, table, {std::string("boundary.lake.level=") + level}) / expected, 1, 1e-6) << level;
  }
}

/// Suction is no stress in net stress; in Bishop's it acts with the degree of saturation.
TEST(Water, that_is_sucked_acts_as_the_stress_variable_says) {
  const std::string text = wet_block +
                           "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = 1\nshape = 0.5\n"
                           "residual_saturation = 0.5\n[body.soil.relative_permeability]\ncurve = \"constant\"\n"
                           "[[stage]]\nname = \"soil\"\nkind = \"quasi_static\"\nduration = 1\n";
  const double weight = 10 * (0.7 * 2600 + 0.3 * 0.5 * 1000);
  for (const bool bishop : {false, true}) {
    const Solved solved = solve(text, {"phases=unsaturated", "water.table=[[0, -2]]",
                                       std::string("water.stress=") + (bishop ? "bishop" : "net")});
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        const double y = solved.value("position", p, 1);
                        return (solved.value("stress", p, 1) + weight * (1 - y) + (bishop ? 0.5 * 1e4 * (2 + y) : 0)) /
                               weight;
                      }),
              1e-3)  // a suction of 20 kPa leaves 2.5e-5 above the residual saturation; of the water's weight 1 / 13
        << bishop;
  }
}

/// In a drained scene seepage finds the pressure of the stages after it: through a confined block it falls linearly,
/// soil bears its gradient as in a saturated scene, and particles that take over keep still.
TEST(Water, seeps_through_drained_soil) {
  const std::string text =
      wet_block +
      "[boundary.in]\ngroup = \"left\"\nkind = \"pore_pressure\"\npressure = 8e3\n[boundary.out]\ngroup = "
      "\"right\"\nkind = \"pore_pressure\"\n"
      "[boundary.lid]\ngroup = [\"base\", \"surface\"]\nkind = \"impermeable\"\n"
      "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n"
      "[[stage]]\nname = \"soil\"\nkind = \"quasi_static\"\nduration = 1\nreset_displacement = true\n";
  const std::vector<std::string> keys{"phases=drained",
                                      "gravity=0",
                                      "water.open_water_load=false",
                                      "quasi_static.elements=patches",
                                      "quasi_static.tolerance=1e-8",
                                      "boundary.walls.kind=fixed",
                                      "boundary.walls.group=base"};
  for (const int dim : {2, 3}) {
    const Solved drained =
        solve(text, keys + (dim == 3 ? in_3d +
                                           std::vector<std::string>{
                                               "boundary.lid.group=[\"base\", \"surface\", \"front\", \"back\"]"}
                                     : std::vector<std::string>{}));
    EXPECT_LT(largest(drained, 1,
                      [&](size_t p, int) {
                        return drained.value("pore_pressure", p) / 8e3 - (1 - drained.value("position", p, 0));
                      }),
              1e-9)
        << dim;
  }
  const Solved iterative = solve(text, keys + std::vector<std::string>{"quasi_static.linear_solver=iterative"});
  EXPECT_LT(largest(iterative, 1,
                    [&](size_t p, int) {
                      return iterative.value("pore_pressure", p) / 8e3 - (1 - iterative.value("position", p, 0));
                    }),
            1e-7);  // ten times Newton's tolerance
  const std::vector<std::string> fine =
      keys + std::vector<std::string>{"quasi_static.elements=quadratic"};  // patches average pressure in another way
  const Solved given = solve(text, fine), moving = solve(text, fine + std::vector<std::string>{"phases=saturated"});
  EXPECT_LT(
      largest(given, 4,
              [&](size_t p, int k) { return (given.value("stress", p, k) - moving.value("stress", p, k)) / 8e3; }),
      1e-6);
  EXPECT_GT(largest(given, 1, [&](size_t p, int) { return given.value("stress", p, 0) / 8e3; }), 0.1);
  const Solved moved =
      solve(text + "[[stage]]\nname = \"rest\"\nduration = 0.5\n[output.point.top]\nposition = [0.5, 1]\n", keys);
  const auto way = moved.history.column("top_displacement_m");
  EXPECT_LT(*std::max_element(way.end() - 50, way.end()), 1e-9);
}

/// Water that rises by seepage makes a drained column lighter: effective stress follows the table where it stands, in
/// static stages and at the particles.
TEST(Water, rises_in_drained_soil) {
  const std::string text =
      wet_block +
      "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = \"1 kPa\"\nshape = 0.5\n"
      "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.5\n"
      "[boundary.well]\ngroup = \"base\"\nkind = \"pore_pressure\"\npressure = \"min(9e3, 4e3 + t)\"\n"
      "[[stage]]\nname = \"before\"\nkind = \"quasi_static\"\nduration = 1\nhold_loads = true\n"
      "[[stage]]\nname = \"rise\"\nkind = \"seepage\"\nduration = 1e6\n"
      "[[stage]]\nname = \"after\"\nkind = \"quasi_static\"\nduration = 1\nhold_loads = true\nreset_displacement = "
      "true\n"
      "[[stage]]\nname = \"rest\"\nduration = 0.5\n[output.point.foot]\nposition = [0.5, "
      "0.02]\n[output.point.top]\nposition = [0.5, 1]\n";
  const std::vector<std::string> keys{"phases=drained", "water.table=[[0, 0.4]]", "output.history_interval=0.005",
                                      "quasi_static.elements=patches", "quasi_static.tolerance=1e-8"};
  Scene scene = parse_scene(text, meshes + "/scene.toml", keys);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  const auto pressure = simulation->history().column("foot_pore_pressure_Pa"),
             way = simulation->history().column("top_displacement_m");
  EXPECT_NEAR(pressure.front(), 4e3, 1e3);  // the point is near the base, not at it
  EXPECT_NEAR(pressure.back() - pressure.front(), 5e3,
              5e3 * 1e-3);  // hydrostatic at last: time is a thousand times that of the flow
  EXPECT_LT(*std::max_element(way.end() - 50, way.end()), 1e-7);
}

/// Soil above the water weighs what its retention curve holds at the suction that seepage has found: 10 kPa at the top,
/// where a linear curve to 20 kPa leaves half. Particles at rest on a base under them press it with the same weight.
TEST(Water, weighs_what_the_retention_curve_holds) {
  const std::string text = wet_block +
                           "[body.soil.retention]\ncurve = \"linear\"\ndrying_suction = 20e3\n"
                           "[body.soil.relative_permeability]\ncurve = \"constant\"\n"
                           "[boundary.well]\ngroup = \"base\"\nkind = \"pore_pressure\"\npressure = 0\n"
                           "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n"
                           "[[stage]]\nname = \"soil\"\nkind = \"quasi_static\"\nduration = 1\n"
                           "[[stage]]\nname = \"still\"\nduration = 0.2\ndamping = 0.5\n";
  const Solved solved = solve(text, {"phases=drained", "water.table=[[0, 0]]"});
  const double moist = 10 * (0.7 * 2600 + 0.75 * 0.3 * 1000);
  const std::vector<double> time = solved.history.column("time_s"), force = solved.history.column("walls_force_y_N");
  const size_t elements = std::find(time.begin(), time.end(), 2.) - time.begin();
  ASSERT_LT(elements, time.size());
  EXPECT_NEAR(force[elements] / moist, 1, 1e-6);
  EXPECT_NEAR(force.back() / moist, 1, 0.02);  // of three particles in a cell; without the water it would be 0.89
}

const std::string pressed =
    "[boundary.surface]\nkind = \"traction\"\npressure = \"1 kPa\"\n[boundary.drain]\ngroup = "
    "\"surface\"\nkind = \"pore_pressure\"\n"
    "[[stage]]\nname = \"press\"\nkind = \"consolidation\"\nduration = 500\n";

/// What consolidation has pressed out when it is over is what the soil has lost in volume.
TEST(Water, leaves_as_the_soil_settles) {
  const std::string text = wet_block + pressed;
  const Solved solved = solve(text, {"gravity=0"});
  const auto time = solved.history.column("time_s"), inflow = solved.history.column("drain_inflow_m3_s"),
             way = solved.history.column("surface_displacement_y_m");
  double water = 0;
  for (size_t i = 1; i < time.size(); ++i) water += (time[i] - time[i - 1]) * inflow[i];
  EXPECT_LT(way.back(), -1e-5);
  EXPECT_NEAR(water, way.back(), 1e-6 * std::abs(way.back()));
}

/// Slow rain above a water table changes pressures by little: steps do not follow the round-off of these changes, and
/// residuals of 1e-10 m3 are not said to be nothing.
TEST(Water, moves_on_where_little_changes) {
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"silt\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.27\n"
                           "[boundary.rain]\ngroup = \"surface\"\nkind = \"rainfall\"\nintensity = 1e-8\n"
                           "[[stage]]\nname = \"rain\"\nduration = \"1 day\"\n";
  for (const char *kind : {"stage.rain.kind=seepage", "stage.rain.kind=consolidation"})
    for (const char *table : {"water.table=[[0, 0.5]]", "water.table=[[0, 0]]"}) {
      const Solved solved = solve(text, {"phases=unsaturated", "body.soil.permeability=1e-13", table, kind});
      EXPECT_LT(solved.history.column("time_s").size(), 100u) << table << kind;
    }
}

/// The steady state of a closed column above a water table is that of rest, from whatever suction it starts, though
/// sand that dries hardly conducts; and ground at the level of a head is wet.
TEST(Water, ends_at_rest_whatever_it_starts_from) {
  const std::string text = wet_block +
                           "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = 1e3\nshape = 0.7\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.7\n"
                           "[boundary.well]\ngroup = \"base\"\nkind = \"pore_pressure\"\npressure = 0\n"
                           "[boundary.cover]\ngroup = \"surface\"\nkind = \"impermeable\"\n"
                           "[[stage]]\nname = \"rest\"\nkind = \"seepage\"\nsteady = true\nduration = \"1 day\"\n";
  for (const char *start : {"water.suction=4e3", "water.suction=20e3"}) {
    const Solved solved = solve(text, {"phases=unsaturated", "water.table=[[0, 0]]", start});
    EXPECT_LT(
        largest(solved, 1,
                [&](size_t p, int) { return solved.value("pore_pressure", p) / 1e4 + solved.value("position", p, 1); }),
        1e-4)
        << start;  // of a metre of water; a balance of the sum over all nodes leaves 0.1
  }
}

TEST(Water, enters_ground_at_its_level) {
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"loam\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.36\n"
                           "[boundary.film]\ngroup = \"surface\"\nkind = \"head\"\n"
                           "[[stage]]\nname = \"wetting\"\nkind = \"seepage\"\nduration = \"2 h\"\n";
  const auto entered = [&](const char *level) {
    const Solved solved = solve(text, {"phases=unsaturated", "water.table=[[0, -9]]", "water.suction=50e3", level});
    return -solved.history.column("water_out_kg").back();
  };
  const double above = entered("boundary.film.level=1.001");
  EXPECT_GT(above, 10);
  EXPECT_NEAR(entered("boundary.film.level=1"), above, 0.01 * above);
  EXPECT_LT(entered("boundary.film.level=0.999"), 1e-6 * above);
}

/// Dry soil that is wetted from one side takes as much water in cells that are wider than its front as in fine ones:
/// 1.04 in cells of 0.3 m, 1.00 in 0.15 m, of what it takes in 0.05 m; with the mean of the vertices 1.44 and 1.21.
TEST(Water, enters_dry_soil_alike_in_coarse_cells) {
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"loam\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.36\n"
                           "[boundary.wet]\ngroup = \"left\"\nkind = \"pore_pressure\"\npressure = 0\n"
                           "[[stage]]\nname = \"wetting\"\nkind = \"seepage\"\nduration = \"1.5 day\"\n";
  const auto entered = [&](const char *size, int dim = 2) {
    const Solved solved =
        solve(text, std::vector<std::string>{"phases=unsaturated", "gravity=0", "water.table=[[0, -9]]",
                                             "body.soil.permeability=1e-13", "water.suction=50e3", size} +
                        (dim == 3 ? in_3d : std::vector<std::string>{}));
    return -solved.history.column("water_out_kg").back();
  };
  const double fine = entered("mesh.size=0.05");
  EXPECT_NEAR(entered("mesh.size=0.3") / fine, 1, 0.1);
  EXPECT_NEAR(entered("mesh.size=0.15") / fine, 1, 0.1);
  EXPECT_NEAR(entered("mesh.size=0.25", 3) / fine, 1, 0.1);
}

/// Water that is at rest everywhere stays so without a search: its balance is round-off, and so is what it is measured
/// by.
TEST(Water, stays_where_nothing_moves_it) {
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"loam\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.36\n"
                           "[[stage]]\nname = \"rest\"\nduration = \"1 day\"\n";
  for (const char *kind : {"stage.rest.kind=seepage", "stage.rest.kind=consolidation"}) {
    const Solved solved =
        solve(text, {"phases=unsaturated", "gravity=0", "water.table=[[0, -3]]", "water.suction=40e3", kind});
    EXPECT_LT(largest(solved, 1, [&](size_t p, int) { return solved.value("displacement", p, 1); }), 1e-12) << kind;
    EXPECT_LT(largest(solved, 1, [&](size_t p, int) { return solved.value("pore_pressure", p) / 40e3 + 1; }), 1e-9)
        << kind;
  }
}

/// Rain of an hour within ten days that are otherwise dry is not stepped over, whether a table or an expression gives
/// it, and comes in by its integral.
TEST(Water, rains_when_it_rains) {
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"silt\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.27\n"
                           "[boundary.rain]\ngroup = \"surface\"\nkind = \"rainfall\"\nintensity = 0\n"
                           "[[stage]]\nname = \"rain\"\nkind = \"seepage\"\nduration = \"10 days\"\n";
  for (const char *intensity : {"boundary.rain.intensity=[[431999, 0], [432000, 1e-6], [435600, 1e-6], [435601, 0]]",
                                "boundary.rain.intensity='1e-6*(t > 432000)*(t < 435601)'"}) {
    const Solved solved =
        solve(text, {"phases=unsaturated", "water.table=[[0, 0]]", "body.soil.permeability=1e-12", intensity});
    EXPECT_NEAR(solved.history.column("water_out_kg").back(), -1000 * 1e-6 * 3601, 1e-3 * 3.6) << intensity;
    EXPECT_LT(solved.history.column("time_s").size(), 400u) << intensity;
  }
}

/// More water than there is cannot be drawn from soil, and none be pumped for ever into soil without a way out.
TEST(Water, is_not_drawn_from_dry_soil) {
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"silt\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.27\n"
                           "[boundary.pump]\ngroup = \"surface\"\nkind = \"flux\"\ninflow = -1e-7\n"
                           "[[stage]]\nname = \"pump\"\nkind = \"seepage\"\nduration = \"100 days\"\n";
  const auto complaint = [&](const std::vector<std::string> &keys) -> std::string {
    try {
      (void)solve(text, keys);
    } catch (const RunError &error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint({"phases=unsaturated"}).find("more water is drawn from the soil than it can give"),
            std::string::npos);
  EXPECT_NE(complaint({"phases=unsaturated", "boundary.pump.inflow=1e-7", "stage.pump.steady=true"})
                .find("water that enters has no way out"),
            std::string::npos);
}

/// A stage that computes the water goes on from what it computes, whatever the stage before prescribed.
TEST(Water, is_computed_after_it_was_prescribed) {
  const std::string text = wet_block +
                           "[boundary.well]\ngroup = \"base\"\nkind = \"pore_pressure\"\npressure = 20e3\n"
                           "[[stage]]\nname = \"before\"\nkind = \"quasi_static\"\nduration = 1\npore_flow = false\n"
                           "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n"
                           "[[stage]]\nname = \"after\"\nduration = 1e-6\n";
  const Solved solved = solve(text, {"water.bulk_modulus=2.2e9"});
  EXPECT_LT(largest(solved, 1,
                    [&](size_t p, int) {
                      return solved.value("pore_pressure", p) / 20e3 - (1 - solved.value("position", p, 1));
                    }),
            0.2);  // cells have one pressure each, 0.15; the prescribed one is 0.75 away
}

/// The books of the water go on through motion, seepage and motion: rain on elements has entered, what particles do not
/// take of it is named, and nothing else is missing.
TEST(Water, is_counted_through_all_stages) {
  constexpr double rain = 1e-6, lasts = 5e3;
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"silt\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.27\n"
                           "[boundary.rain]\ngroup = \"surface\"\nkind = \"rainfall\"\nintensity = 1e-6\n"
                           "[[stage]]\nname = \"before\"\nduration = 0.2\ndamping = 0.5\n"
                           "[[stage]]\nname = \"rain\"\nkind = \"seepage\"\nduration = 5e3\n"
                           "[[stage]]\nname = \"after\"\nduration = 0.2\ndamping = 0.5\n";
  const Solved solved = solve(text, {"phases=unsaturated", "water.table=[[0, 0.2]]", "water.bulk_modulus=1e7"});
  const auto column = [&](const char *name) { return solved.history.column(name); };
  const auto time = column("time_s"), out = column("water_out_kg"), handed = column("water_handed_kg"),
             error = column("water_error_kg"), stored = column("water_kg");
  const auto row_at = [&](double t) {
    return static_cast<size_t>(std::lower_bound(time.begin(), time.end(), t - 1e-9) - time.begin());
  };
  const size_t moved = row_at(0.2), rained = row_at(lasts + 0.2);
  ASSERT_LT(rained, time.size() - 1);
  EXPECT_NEAR(out[moved] - out[rained], 1000 * rain * lasts, 1e-6);  // 5 kg a metre
  EXPECT_GT(std::abs(handed[rained]), 1e-3);
  EXPECT_EQ(handed.back(), handed[rained]);
  EXPECT_NEAR(stored[rained] - stored[moved], 5 + handed[rained], 1e-6);
  for (const double e : error) EXPECT_NEAR(e, 0, 1e-9 * stored[0]);
}

/// Ground at the level of a water table above which suction is uniform is wet, and loses nothing by standing still.
TEST(Water, stays_below_a_table_at_the_ground) {
  const std::string text = wet_block +
                           "[body.soil.retention]\nmaterial = \"silt\"\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.27\n"
                           "[boundary.cover]\ngroup = \"surface\"\nkind = \"impermeable\"\n"
                           "[[stage]]\nname = \"rest\"\nkind = \"quasi_static\"\nduration = 1\n";
  for (const char *level : {"water.table=[[0, 1]]", "water.table=[[0, 0]]"}) {  // wet, dry
    const Solved solved = solve(text, {"phases=unsaturated", "water.suction=20e3", "water.bulk_modulus=1e7", level});
    const auto stored = solved.history.column("water_kg");
    EXPECT_NEAR(stored.back(), stored.front(), 1e-6 * stored.front()) << level;
  }
}

/// Nodes that motion leaves as they were are those of flow without motion: five turns would lose two thirds of the rain
/// if nodes began with the mean of the particles around them.
TEST(Water, is_not_flattened_by_motion_in_between) {
  const std::string text = wet_block +
                           "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = 2.5e3\nshape = 0.55\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.55\n"
                           "[boundary.rain]\ngroup = \"surface\"\nkind = \"rainfall\"\nintensity = 4e-6\n";
  const auto held = [&](bool moves) {
    std::string stages;
    for (const char *turn : {"1", "2", "3", "4", "5"}) {
      stages += std::string("[[stage]]\nname = \"rain") + turn + "\"\nkind = \"seepage\"\nduration = 1200\n";
      if (moves) stages += std::string("[[stage]]\nname = \"move") + turn + "\"\nduration = 1e-3\ndamping = 0.5\n";
    }
    const Solved solved = solve(
        text + stages, {"phases=unsaturated", "water.table=[[0, -9]]", "water.suction=20e3", "water.bulk_modulus=1e7"});
    const auto stored = solved.history.column("water_kg");
    return stored.back() - stored.front();
  };
  const double still = held(false);
  EXPECT_GT(still, 12);  // of 24 kg
  EXPECT_NEAR(held(true), still, 0.02 * still);
}

/// What nodes knew beyond the mean of their particles is of the soil that was there: soil that has settled by more than
/// half a cell brings its own pressure, none above that of any particle.
TEST(Water, goes_with_soil_that_has_moved) {
  const std::string text = wet_block +
                           "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = 2.5e3\nshape = 0.55\n"
                           "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.55\n"
                           "[boundary.rain]\ngroup = \"surface\"\nkind = \"flux\"\ninflow = \"t < 1800 ? 4e-6 : 0\"\n"
                           "[[stage]]\nname = \"rain\"\nkind = \"seepage\"\nduration = 1800\n"
                           "[[stage]]\nname = \"settles\"\nduration = 1\ndamping = 0.5\nreset_displacement = false\n"
                           "[[stage]]\nname = \"after\"\nkind = \"seepage\"\nduration = 1e-3\n"
                           "[output.point.corner]\nposition = [1, 1]\n";
  const std::vector<std::string> keys{"phases=unsaturated",           "water.table=[[0, -9]]",
                                      "water.suction=20e3",           "water.bulk_modulus=1e7",
                                      "body.soil.young_modulus=40e3", "body.soil.poisson_ratio=0"};
  std::vector<double> settles;
  for (const char *reset : {"stage.settles.reset_displacement=false", "stage.settles.reset_displacement=true"}) {
    const Solved solved = solve(text, keys + std::vector<std::string>{reset});
    EXPECT_LT(solved.history.column("corner_pore_pressure_Pa").back(), -10e3) << reset;  // -5 kPa where it stays behind
    const double settled = largest(solved, 1, [&](size_t p, int) { return solved.value("displacement", p, 1); });
    settles.push_back(settled);
    bool told = false;
    for (const auto &event : solved.events) told |= event.text.find("of it is there no more") != std::string::npos;
    EXPECT_TRUE(told) << reset;
  }
  const auto of_particles = [&](const std::string &stages) {
    const Solved solved = solve(stages, keys);  // ends with motion, so that it has the state of the particles
    std::map<long long, double> settled;
    for (size_t p = 0; p < solved.points.id.size(); ++p)
      settled[solved.points.id[p]] = solved.value("displacement", p, 1);
    return settled;
  };
  const auto before = of_particles(text.substr(0, text.find("[[stage]]\nname = \"after\""))),
             after = of_particles(text.substr(0, text.find("[output.point")) +
                                  "[[stage]]\nname = \"then\"\nduration = 1e-9\n");
  ASSERT_EQ(before.size(), after.size());
  for (const auto &[id, u] : before) EXPECT_NEAR(after.at(id), u, 1e-6) << id;  // soil at rest keeps what it had
  EXPECT_GT(settles[0], 0.15);  // half a cell; displacement goes on through motion and flow
  EXPECT_LT(settles[1], 1e-12);
}

/// The error of a step is of second order in its length, theory of seepage (3.1): a quarter of the permitted error
/// takes twice as many steps.
TEST(Water, takes_steps_by_the_root_of_their_error) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (ranks > 1) return;  // once is enough for so many steps
  const std::string text = wet_block + pressed;
  const auto steps = [&](const char *error) {
    return solve(text, {"gravity=0", std::string("quasi_static.step_error=") + error}).history.column("time_s").size();
  };
  const double ratio = static_cast<double>(steps("2.5e-4")) / static_cast<double>(steps("1e-3"));
  EXPECT_NEAR(ratio, 2, 0.3);  // 1.86: the first steps, of 1e-4 of the duration, are the same ones
}

/// Sums of several ranks have an order of their own; steps follow from their error, so that a digit would decide on
/// them.
TEST(Water, repeats_to_the_bit) {
  const std::vector<std::string> keys{"gravity=0"};
  const Solved first = solve(wet_block + pressed, keys);
  for (int run = 0; run < 8; ++run) {
    const Solved again = solve(wet_block + pressed, keys);
    EXPECT_EQ(again.history.column("time_s"), first.history.column("time_s"));
    EXPECT_EQ(again.history.column("water_out_kg"), first.history.column("water_out_kg"));
    EXPECT_EQ(again.column("pore_pressure").values, first.column("pore_pressure").values);
  }
}

/// PETSc's search for a critical point says "converged" where force and step are perpendicular; here it is made to say
/// so of any step.
TEST(Water, does_not_flow_by_a_search_that_gives_up) {
  PetscOptionsSetValue(nullptr, "-talus_flow_snes_linesearch_atol", "1e9");
  EXPECT_THROW(solve(wet_block + pressed, {"gravity=0"}), RunError);
  PetscOptionsClearValue(nullptr, "-talus_flow_snes_linesearch_atol");
}

/// A linear pressure passes from nodes to particles as it is.
TEST(Water, is_handed_to_particles) {
  Scene scene = parse_scene(wet_block +
                                "[boundary.top]\ngroup = \"surface\"\nkind = \"pore_pressure\"\npressure = 7e3\n"
                                "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n",
                            meshes + "/scene.toml", {"water.bulk_modulus=2.2e9"});
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  const Snapshot end = simulation->snapshot();
  std::map<long long, std::array<double, 2>> cells;  // sums over the three particles of a cell
  Solved particles{end, simulation->history(), simulation->events()};
  for (size_t i = 0; i < end.id.size(); ++i) {
    auto &cell = cells[end.id[i] / 3];
    cell[0] += particles.value("pore_pressure", i) / 3,
        cell[1] += (7e3 + 1e4 * (1 - particles.value("position", i, 1))) / 3;
  }
  for (const auto &[id, cell] : cells) EXPECT_NEAR(cell[0], cell[1], 1e-5 * cell[1]);
}

}  // namespace
}  // namespace talus
