// Claims of output/output_field.h and simulation/output_fields.h.
#include "output/output_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "physics/laws/laws.h"
#include "scene/body_source.h"
#include "simulation/output_fields.h"

namespace talus {
namespace {

struct Point {
  std::array<double, 2> place, speed;
  double pressure;
  std::array<double, 4> stress{6, 7, 8, 9};
};

OutputFields<Point> three_fields() {
  OutputFields<Point> fields;
  fields.add("place", "m", "where it is", Tracked::coordinates, [](const Point &p) { return p.place; });
  fields.add("speed", "m/s", "how fast it moves", Tracked::magnitude, [](const Point &p) { return p.speed; });
  fields.add("pressure", "Pa", "of the water", Tracked::value, [](const Point &p) { return p.pressure; });
  fields.add("stress", "Pa", "in the soil", Tracked::components, [](const Point &p) { return p.stress; });
  fields.add("way", "m", "where it went", Tracked::vector, [](const Point &p) { return p.speed; });
  fields.add("wet", "-", "1 under pressure", Tracked::no, [](const Point &p) { return p.pressure > 0; });
  return fields;
}

TEST(OutputFields, fill_the_columns_of_a_snapshot) {
  const auto fields = three_fields();
  auto columns = fields.columns(3);
  fields.append({{1, 2}, {3, 4}, 5}, columns);
  fields.append({{6, 7}, {8, 9}, -1}, columns);
  ASSERT_EQ(columns.size(), 6u);
  EXPECT_EQ(columns[1].name, "speed");
  EXPECT_EQ(columns[1].unit, "m/s");
  EXPECT_EQ(columns[1].meaning, "how fast it moves");
  EXPECT_EQ(columns[1].components, 2);
  EXPECT_EQ(columns[2].components, 1);
  EXPECT_EQ(columns[0].values, (std::vector<double>{1, 2, 6, 7}));
  EXPECT_EQ(columns[1].values, (std::vector<double>{3, 4, 8, 9}));
  EXPECT_EQ(columns[2].values, (std::vector<double>{5, -1}));
  EXPECT_EQ(columns[3].values, (std::vector<double>{6, 7, 8, 9, 6, 7, 8, 9}));
  EXPECT_EQ(columns[5].values, (std::vector<double>{1, 0}));
}

TEST(OutputFields, name_and_fill_the_history_of_a_tracked_point) {
  const auto fields = three_fields();
  std::vector<std::string> names;
  for (const auto &[quantity, unit] : fields.tracked())
    names.push_back(column_of("point", "crest", quantity, unit).name);
  EXPECT_EQ(names, (std::vector<std::string>{"crest_x_m", "crest_y_m", "crest_speed_m_s", "crest_pressure_Pa",
                                             "crest_stress_xx_Pa", "crest_stress_yy_Pa", "crest_stress_zz_Pa",
                                             "crest_stress_xy_Pa", "crest_way_m", "crest_way_x_m", "crest_way_y_m"}));
  const Point point{{1, 2}, {3, 4}, 5};
  std::vector<double> row{-1};
  fields.append_tracked(&point, row);
  EXPECT_EQ(row, (std::vector<double>{-1, 1, 2, 5, 5, 6, 7, 8, 9, 5, 3, 4}));
  fields.append_tracked(nullptr, row);  // on another rank
  EXPECT_EQ(row, (std::vector<double>{-1, 1, 2, 5, 5, 6, 7, 8, 9, 5, 3, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
}

using Names = std::vector<std::string>;

template <class Point>
Names names_of(const PhaseTraits &phases) {
  Names names;
  const auto fields = output_fields<Point>(phases, {});
  for (const auto &field : fields.list()) names.push_back(field.name);
  return names;
}

TEST(OutputFields, exist_where_the_phase_model_has_them) {
  EXPECT_EQ(names_of<ParticleState<2>>(traits_of<Dry>),
            (Names{"position", "displacement", "velocity", "stress", "mean_pressure", "deviator", "volume", "mass"}));
  EXPECT_EQ(names_of<ParticleState<3>>(traits_of<Drained>),
            (Names{"position", "displacement", "velocity", "stress", "mean_pressure", "deviator", "volume", "mass",
                   "pore_pressure"}));
  EXPECT_EQ(names_of<ParticleState<2>>(traits_of<ThreePhase>),
            (Names{"position", "displacement", "velocity", "stress", "mean_pressure", "deviator", "volume", "mass",
                   "pore_pressure", "gas_pressure", "suction", "saturation", "porosity", "surface"}));
  EXPECT_EQ(names_of<GaussPointState<2>>(traits_of<Unsaturated>),
            (Names{"position", "displacement", "stress", "mean_pressure", "deviator", "volume", "mass", "shear_strain",
                   "pore_pressure", "saturation"}));
}

TEST(OutputFields, of_laws_are_not_a_number_where_a_body_has_another_law) {
  BodySource source;
  std::vector<std::unique_ptr<Body<2>>> bodies(2);
  for (auto &body : bodies) body = std::make_unique<Body<2>>();
  ASSERT_EQ(bodies[0]->create(MPI_COMM_SELF, source, MohrCoulomb{}, 0, 0), 0);
  ASSERT_EQ(bodies[1]->create(MPI_COMM_SELF, source, LinearElastic{}, 0, 0), 0);
  const auto fields = output_fields<GaussPointState<2>>(traits_of<Dry>, bodies);
  auto columns = fields.columns(3);
  const double history[] = {0.25, 0.5};
  GaussPointState<2> point;
  point.history = history;
  for (point.body = 0; point.body < 2; ++point.body) fields.append(point, columns);
  ASSERT_EQ(columns.back().name, "dilation");
  EXPECT_EQ(columns.back().values[0], 0.5);
  EXPECT_TRUE(std::isnan(columns.back().values[1]));
}

TEST(RunRow, names_what_it_holds_and_closes_its_ledgers) {
  RunRow<2> row;
  row.energy = {
      .balance = {.kinetic = 1, .strain = 2}, .first = 30, .escaped = 9, .of_boundary = {11, 14}, .work = {4, 5, -6}};
  row.escaped = {.particles = 3, .mass = 50, .fluid_mass = {6, 0}, .momentum = {70, -80}, .energy = 9};
  row.fluids = {{100, 7, 2}}, row.first_fluid = {104}, row.handed = {3};
  const RigidBases<2>::Report base{.slip = 15, .friction = 16, .temperature = 17, .hottest = 18, .pressure = 19};
  row.boundaries = {{.name = "base",
                     .inflow = true,
                     .is_base = true,
                     .remembers = true,
                     .heats = true,
                     .value = {8, 9},
                     .water = 10,
                     .clearance = 20,
                     .base = base},
                    {.name = "footing", .loads = true, .value = {12, 13}}};
  Names names;
  std::map<std::string, double> value;
  std::map<std::string, HistoryColumn> column;
  row.visit([&](const HistoryColumn &one, double number) {
    names.push_back(one.name);
    value[one.name] = number, column[one.name] = one;
  });
  const auto says = [&](const char *name) {
    const HistoryColumn &one = column.at(name);
    return one.quantity + "; " + one.unit + "; " + one.of + "; " + one.which;
  };
  EXPECT_EQ(says("kinetic_J"), "energy; J; run; kinetic");
  EXPECT_EQ(says("mass_kg"), "mass; kg; run; ");
  EXPECT_EQ(says("escaped_momentum_x_kg_m_s"), "escaped_momentum; kg m/s; run; x");
  EXPECT_EQ(says("water_kg"), "water_ledger; kg; run; stored");
  EXPECT_EQ(says("water_out_kg"), "water_ledger; kg; run; out");
  EXPECT_EQ(says("base_inflow_m3_s"), "inflow; m3/s; boundary; base");
  EXPECT_EQ(says("footing_displacement_x_m"), "displacement_x; m; boundary; footing");
  EXPECT_EQ(names, (Names{"kinetic_J",
                          "strain_J",
                          "potential_J",
                          "mass_kg",
                          "particles",
                          "load_time_s",
                          "escaped_particles",
                          "escaped_mass_kg",
                          "escaped_momentum_x_kg_m_s",
                          "escaped_momentum_y_kg_m_s",
                          "escaped_energy_J",
                          "water_kg",
                          "water_out_kg",
                          "water_given_kg",
                          "water_escaped_kg",
                          "water_handed_kg",
                          "water_error_kg",
                          "base_inflow_m3_s",
                          "base_force_x_N",
                          "base_force_y_N",
                          "footing_displacement_x_m",
                          "footing_displacement_y_m",
                          "base_slip_m",
                          "base_friction",
                          "base_clearance_m",
                          "base_temperature_K",
                          "base_hottest_K",
                          "base_excess_pressure_Pa",
                          "base_heat_J",
                          "work_base_J",
                          "work_footing_J",
                          "work_gravity_J",
                          "work_imposed_J",
                          "work_damping_J",
                          "dissipated_J"}));
  EXPECT_EQ(value["water_error_kg"], 100 + 7 - 2 + 6 - 3 - 104);  // stored, and gone, and not put in, since the start
  EXPECT_EQ(value["escaped_momentum_y_kg_m_s"], -80);
  EXPECT_EQ(value["base_inflow_m3_s"], 10);
  EXPECT_EQ(value["base_force_y_N"], 9);
  EXPECT_EQ(value["footing_displacement_x_m"], 12);
  EXPECT_EQ(value["base_friction"], 16);
  EXPECT_EQ(value["base_clearance_m"], 20);
  EXPECT_EQ(value["base_excess_pressure_Pa"], 19);
  // energy at the start, work, energy now and that of what has left
  EXPECT_EQ(value["dissipated_J"], 30 + 11 + 14 + 4 + 5 - 6 - (1 + 2 + 9));
}

}  // namespace
}  // namespace talus
