// A boundary kind is one file: kinds that only this test knows support, rub, load, damp and pass water wherever the
// kinds of the house do, and a kind that leaves a statement out is none. The soil is the unit square, the boundary its
// side y = 0 of length 1; expected values are exact, so errors are round-off of a few operations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "physics/boundary/kinds.h"
#include "physics/boundary/pore_conditions.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/scene.h"
#include "solvers/quasi_static/loads.h"
#include "solvers/quasi_static/pore_flow.h"
#include "solvers/quasi_static/supports.h"
#include "square.h"

namespace talus {
namespace {

using test::sum;

constexpr double round_off = 1e-12;

/// Rubs against the soil and drains it: the base of a laboratory flume of porous stone.
struct PorousStone {
  static constexpr const char *name = "porous_stone";
  static constexpr OnSoil in_motion = OnSoil::contact, quasi_static = OnSoil::refused;
  static constexpr OnWater water = OnWater::pressure;
  static constexpr OnGas gas = OnGas::atmosphere;
  static constexpr bool open_water = false;
  double friction = 0.5;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("friction", friction, one, {0, 1}, "coefficient of friction");
  }
  double friction_coefficient(double, double, double, double, double) const { return friction; }
  double adhesion(double, double, double, double, double) const { return 2; }
  double outside(double x, double, double, double t, const LiquidBeyond &) const { return 3000 + 100 * x + 10 * t; }
};

/// Loads the soil and waters it: a lawn sprinkler on a raft.
struct WetRaft {
  static constexpr const char *name = "wet_raft";
  static constexpr OnSoil in_motion = OnSoil::load, quasi_static = OnSoil::load;
  static constexpr OnWater water = OnWater::flux;
  static constexpr OnGas gas = OnGas::atmosphere;
  template <class Visitor>
  void fields(Visitor &&) {}
  bool follows() const { return false; }
  template <int dim>
  Vec<dim> load(const Vec<dim> &, const Vec<dim> &, double t) const {
    Vec<dim> force{};
    force[0] = 7, force[1] = -5 * t;
    return force;
  }
  double inflow(double, double, double, double t) const { return 1e-6 * t; }
};

/// Pushes the soil along the face, which it seals.
struct Conveyor {
  static constexpr const char *name = "conveyor";
  static constexpr OnSoil in_motion = OnSoil::support, quasi_static = OnSoil::support;
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::wall;
  static constexpr int precedence = 0;
  std::vector<Function> rates{0.25, 0.5, 0.75};
  template <class Visitor>
  void fields(Visitor &&v) {
    v.functions("rates", rates, metre_per_second, of::place_and_time, "rates of the belt");
  }
  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &) const {
    return {all_axes<dim>()[0]};
  }
  template <int dim>
  double speed(const Vec<dim> &direction, const Vec<dim> &, double t) const {
    return rates[0](t) * direction[0] + t;
  }
};

/// Damps motion in the same way in all directions, however stiff the soil is, and leaves the pore fluids alone.
struct Cushion {
  static constexpr const char *name = "cushion";
  static constexpr OnSoil in_motion = OnSoil::dashpot, quasi_static = OnSoil::none;
  static constexpr OnWater water = OnWater::surface;
  static constexpr OnGas gas = OnGas::surface;
  template <class Visitor>
  void fields(Visitor &&) {}
  template <int dim>
  Square<dim> dashpot(const std::array<double, 2> &, const Vec<dim> &) const {
    return 3 * Square<dim>::Identity();
  }
};

// ---- what a kind must state ----

static_assert(BoundaryKind<PorousStone> && BoundaryKind<WetRaft> && BoundaryKind<Conveyor> && BoundaryKind<Cushion>);

struct LeavesTheSoilAlone {
  static constexpr OnSoil in_motion = OnSoil::none, quasi_static = OnSoil::none;
};
struct LeavesTheFluidsAlone {
  static constexpr OnWater water = OnWater::surface;
  static constexpr OnGas gas = OnGas::surface;
};
struct Complete : LeavesTheSoilAlone, LeavesTheFluidsAlone {};
static_assert(BoundaryKind<Complete>);

struct ForgetsWater : LeavesTheSoilAlone {
  static constexpr OnGas gas = OnGas::wall;
};
struct ForgetsGas : LeavesTheSoilAlone {
  static constexpr OnWater water = OnWater::wall;
};
struct ForgetsQuasiStaticStages : LeavesTheFluidsAlone {
  static constexpr OnSoil in_motion = OnSoil::none;
};
struct RubsWithoutFriction : LeavesTheFluidsAlone {
  static constexpr OnSoil in_motion = OnSoil::contact, quasi_static = OnSoil::refused;
};
struct LoadThatNobodyAsksFor : Complete {
  bool follows() const { return false; }
  template <int dim>
  Vec<dim> load(const Vec<dim> &, const Vec<dim> &, double) const {
    return {};
  }
};
struct PressureThatNobodyAsksFor : Complete {
  static constexpr bool open_water = false;
  double outside(double, double, double, double, const LiquidBeyond &) const { return 0; }
};
struct StopsTheLiquidAlone : LeavesTheSoilAlone {
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::atmosphere;
};
static_assert(!StatesWater<ForgetsWater> && !BoundaryKind<ForgetsWater>);
static_assert(!StatesGas<ForgetsGas> && !BoundaryKind<ForgetsGas>);
static_assert(!StatesSoil<ForgetsQuasiStaticStages> && !BoundaryKind<ForgetsQuasiStaticStages>);
static_assert(!CompleteOnSoil<RubsWithoutFriction> && !BoundaryKind<RubsWithoutFriction>);
static_assert(!CompleteOnSoil<LoadThatNobodyAsksFor> && !BoundaryKind<LoadThatNobodyAsksFor>);
static_assert(!CompleteOnFluids<PressureThatNobodyAsksFor> && !BoundaryKind<PressureThatNobodyAsksFor>);
static_assert(!PossibleOnFluids<StopsTheLiquidAlone> && !BoundaryKind<StopsTheLiquidAlone>);

// ---- what the parts of the program make of it ----

TEST(OwnBoundary, IsReadByAListThatNamesIt) {
  Scene scene =
      parse_host_scene(std::string(Square1m::text) + "[boundary.base]\nkind = 'porous_stone'\nfriction = 0.75", "own");
  using Kinds = std::variant<Fixed, PorousStone>;
  const Boundary read = read_boundary_of<Kinds>(scene.boundary[0].kind);
  EXPECT_EQ(read.in_motion, OnSoil::contact);
  EXPECT_EQ(read.friction_coefficient(0, 0, 0, 0, 0), 0.75);
  EXPECT_THROW(read_boundary(scene.boundary[0].kind), SceneError);  // the list of the house does not have it
}

TEST(OwnBoundary, TellsTheVectorsThatTheSceneGives) {
  const Boundary belt{Conveyor{}};
  ASSERT_EQ(belt.vectors.size(), 1u);
  EXPECT_EQ(belt.vectors[0].first, "rates");
  EXPECT_EQ(belt.vectors[0].second, 3);
}

TEST(OwnBoundary, RubsWhereSoilPresses) {
  Square1m soil({{"base", {"base"}, PorousStone{}}});
  constexpr double step = 0.1, length = 1;  // of the base [m]
  std::vector<Vec<2>> v(soil.grid.node_count(), Vec<2>{1, -0.5});
  soil.conditions.resolve(0, step, soil.grid, v.data());
  for (int i = 0; i < soil.grid.node_count(); ++i) {
    EXPECT_NEAR(v[i][1], soil.at_base(i) ? 0 : -0.5, round_off);
    if (!soil.at_base(i)) {
      EXPECT_EQ(v[i][0], 1);
    }
  }
  // 1 kg stops from 0.5 m/s at every node; friction is half of that, adhesion 2 Pa on the whole base
  const Vec<2> impulse = soil.impulse();
  EXPECT_NEAR(impulse[1], 0.5 * soil.base_nodes(), round_off);
  EXPECT_NEAR(impulse[0], -0.5 * 0.5 * soil.base_nodes() - 2 * length * step, round_off);
}

TEST(OwnBoundary, PrescribesVelocity) {
  Square1m soil({{"base", {"base"}, Conveyor{}}});
  std::vector<Vec<2>> v(soil.grid.node_count(), Vec<2>{1, -0.5});
  soil.conditions.resolve(2, 0.1, soil.grid, v.data());
  for (int i = 0; i < soil.grid.node_count(); ++i) {
    EXPECT_EQ(v[i][0], soil.at_base(i) ? 2.25 : 1);
    EXPECT_EQ(v[i][1], -0.5);
  }
}

TEST(OwnBoundary, DampsMotion) {
  Square1m soil({{"base", {"base"}, Cushion{}}});
  EXPECT_TRUE(soil.conditions.has_dashpots());
  std::vector<Vec<2>> v(soil.grid.node_count(), Vec<2>{1, -0.5}), force(v.size(), Vec<2>{});
  soil.conditions.project(v.data(), force.data());  // the matrix of a node times its velocity
  double pull[2]{};
  for (int i = 0; i < soil.grid.node_count(); ++i)
    for (int d = 0; d < 2; ++d) pull[d] += soil.mesh.owned[soil.grid.mesh_node[i]] * force[i][d];
  EXPECT_NEAR(sum(pull[0]), -3, round_off);
  EXPECT_NEAR(sum(pull[1]), 1.5, round_off);
}

TEST(OwnBoundary, LoadsTheParticlesBehindIt) {
  Square1m soil({{"base", {"base"}, WetRaft{}}});
  EXPECT_TRUE(soil.conditions.loads(0));
  std::vector<std::unique_ptr<Body<2>>> bodies;
  bodies.push_back(std::make_unique<Body<2>>());
  SurfaceLoads<2> &loads = soil.conditions.surface_loads();
  BodySource &source = soil.scene.body[0];
  source.particles_per_cell = 3;
  ASSERT_EQ(bodies[0]->create(soil.mesh.comm(), source, read_law(source.law), 0, loads.face_count()), 0);
  seed<2>(*bodies[0], soil.mesh, 8, [](const Vec<2> &) { return 1600.; });
  loads.share(soil.mesh, std::vector<char>(soil.mesh.cell_count(), 1));
  loads.seed(*bodies[0], soil.mesh);
  ASSERT_EQ(bodies[0]->sort(soil.mesh.cell_count()), 0);
  loads.begin(bodies, soil.grid);
  std::vector<Vec<2>> force(soil.grid.node_count(), Vec<2>{});
  loads.add(2, soil.grid, soil.grid.position.data(), force.data());
  double total[2]{};
  for (const Vec<2> &f : force)
    for (int d = 0; d < 2; ++d) total[d] += f[d];
  EXPECT_NEAR(sum(total[0]), 7, round_off);
  EXPECT_NEAR(sum(total[1]), -10, round_off);
}

TEST(OwnBoundary, PassesWaterOfAPressureAndStopsNone) {
  Square1m soil({{"base", {"base"}, PorousStone{}}});
  PoreConditions<2> pores;
  ASSERT_EQ(pores.setup(soil.mesh, soil.sources, false, 1, {0, 1}), 0);
  const std::vector<Vec<2>> nothing(soil.grid.node_count(), Vec<2>{});
  ASSERT_EQ(pores.begin(soil.grid, soil.filling, nothing, nothing), 0);
  double push = 0;
  pores.pressures(0, soil.grid, 1e4, [&](int node, double p, const Vec<2> &area, const Vec<2> &load) {
    EXPECT_NEAR(p, 3000 + 100 * soil.grid.position[node][0], 1e-9);
    EXPECT_EQ(load, Vec<2>{});
    if (soil.mesh.owned[soil.grid.mesh_node[node]]) push += area[1] / p;
  });
  EXPECT_NEAR(sum(push), -1, round_off);  // the whole base, with its outer normal
  pores.limits(
      0, soil.grid, 1000, 1e4,
      [](int) {
        return LiquidAtNode{1, 1};
      },
      [](int, const FlowLimits<2> &) { ADD_FAILURE() << "a limit or wall where water moves freely"; });
}

TEST(OwnBoundary, LimitsAndWallsTheLiquid) {
  Square1m raft({{"base", {"base"}, WetRaft{}}}), belt({{"base", {"base"}, Conveyor{}}}),
      cushion({{"base", {"base"}, Cushion{}}});
  for (Square1m *soil : {&raft, &belt, &cushion}) {
    PoreConditions<2> pores;
    ASSERT_EQ(pores.setup(soil->mesh, soil->sources, false, 1, {0, 1}), 0);
    const std::vector<Vec<2>> nothing(soil->grid.node_count(), Vec<2>{});
    ASSERT_EQ(pores.begin(soil->grid, soil->filling, nothing, nothing), 0);
    double walls = 0, limits = 0, base = 0;
    for (int i = 0; i < soil->grid.node_count(); ++i) base += soil->at_base(i);
    pores.limits(
        3, soil->grid, 1000, 1e4,
        [](int) {
          return LiquidAtNode{1000, 2};
        },
        [&](int node, const FlowLimits<2> &all) {
          for (int k = 0; k < all.count; ++k) {
            const FlowLimit<2> &one = all.all[k];
            const bool here = soil->at_base(node) && one.n[1] == -1;
            walls += one.wall && here, limits += !one.wall && here;
            EXPECT_NEAR(one.low, one.wall ? 0 : -3e-6 * 2, 1e-18);  // times density over density at the node
            EXPECT_EQ(one.high, one.low);
          }
        });
    EXPECT_EQ(walls, soil == &belt ? base : 0);
    EXPECT_EQ(limits, soil == &raft ? base : 0);
  }
}

/// In motion too rain counts per level area: on ground that slopes by 30 degrees (the vertical is turned) it brings the
/// cosine of its intensity, and under an overhang none.
TEST(OwnBoundary, RainsOnTheAreaOfTheMap) {
  Square1m soil({{"rain", {"base"}, Rainfall{1e-6}}});
  const std::vector<Vec<2>> nothing(soil.grid.node_count(), Vec<2>{});
  for (const auto &[upward, part] :
       {std::pair{Vec<2>{0, -1}, 1.}, std::pair{Vec<2>{0.5, -std::sqrt(0.75)}, std::sqrt(0.75)},
        std::pair{Vec<2>{0, 1}, 0.}}) {
    PoreConditions<2> pores;
    ASSERT_EQ(pores.setup(soil.mesh, soil.sources, false, 1, upward), 0);
    ASSERT_EQ(pores.begin(soil.grid, soil.filling, nothing, nothing), 0);
    int limits = 0;
    pores.limits(
        0, soil.grid, 1000, 1e4,
        [](int) {
          return LiquidAtNode{1000, 1};
        },
        [&](int, const FlowLimits<2> &all) {
          limits += all.count;
          for (int k = 0; k < all.count; ++k) EXPECT_NEAR(all.all[k].low, -part * 1e-6, 1e-18) << part;
        });
    EXPECT_GT(sum(limits), 0);
  }
}

/// A square whose base rises from its middle on; the group `middle` is this part of the base.
test::BoxMesh bent_square(double rise) {
  test::BoxMesh box(2, 4);
  std::vector<std::vector<int>> facets;
  std::vector<int> tags;
  for (std::size_t f = 0; f < box.facet.size(); ++f) {
    if (box.facet_tag[f] == 13) continue;
    const double x = (box.node[box.facet[f][0]][0] + box.node[box.facet[f][1]][0]) / 2;
    facets.push_back(box.facet[f]), tags.push_back(box.facet_tag[f] == 11 && x > 0.5 ? 13 : box.facet_tag[f]);
  }
  box.facet = facets, box.facet_tag = tags;
  for (auto &x : box.node) {
    if (x[1] == 0) x[0] = std::round(4 * x[0]) / 4;
    x[1] += (1 - x[1]) * rise * std::max(0., x[0] - 0.5);
  }
  return box;
}

/// Velocities of the liquid against the skeleton after all limits and walls, from rest.
std::vector<Vec<2>> pumped(Square1m &soil, PoreConditions<2> &pores) {
  EXPECT_EQ(pores.setup(soil.mesh, soil.sources, false, 1, {0, 1}), 0);
  std::vector<Vec<2>> w(soil.grid.node_count(), Vec<2>{}), surface = w;
  for (int c = 0; c < soil.mesh.cell_count(); ++c) {
    const auto gradient = barycentric_gradients<2>(soil.mesh.cells[c]);
    for (int k = 0; k <= 2; ++k)
      add_scaled<2>(surface[soil.grid.find_node(soil.mesh.cells[c].node[k])], soil.mesh.volume[c], gradient[k]);
  }
  EXPECT_EQ(soil.grid.sum(surface[0].data(), 2), 0);
  EXPECT_EQ(pores.begin(soil.grid, soil.filling, surface, w), 0);
  pores.limits(
      1, soil.grid, 1000, 1e4,
      [](int) {
        return LiquidAtNode{1000, 1};
      },
      [&](int node, FlowLimits<2> &all) {
        hold_within<2>(all, w[node]);
        for (int k = 0; k < all.count; ++k) add_scaled<2>(w[node], all.all[k].taken, all.all[k].n);
      });
  return w;
}

/// An edge whose sides let no water in lets none in, and out no more than drives out: one side after the other would
/// let water through at any angle but a right one.
TEST(OwnBoundary, HoldsWaterAtBothSidesOfAnEdge) {
  constexpr double open = 1e300;
  for (const double degrees : {30., 60., 90., 120., 150., 175.}) {  // within the soil
    const double turn = (180 - degrees) * std::atan(1.) / 45;
    const Vec<2> first{0, 1}, second{std::sin(turn), std::cos(turn)};
    const auto held = [&](const Vec<2> &w, double low) {
      FlowLimits<2> all;
      all.add({first, low, open, false}), all.add({second, 0, open, false});
      hold_within<2>(all, w);
      Vec<2> end = w;
      for (int k = 0; k < all.count; ++k) add_scaled<2>(end, all.all[k].taken, all.all[k].n);
      return end;
    };
    Vec<2> inwards{};
    add_scaled<2>(inwards, -1, first), add_scaled<2>(inwards, -0.5, second);
    for (const double x : held(inwards, 0)) EXPECT_NEAR(x, 0, 1e-6) << degrees;
    const Vec<2> along{first[1], -first[0]};  // slides along the first side, out of the second
    for (int d = 0; d < 2; ++d) EXPECT_NEAR(held(along, 0)[d], along[d], 1e-12) << degrees;
    const Vec<2> rained = held(inwards, -0.1);
    EXPECT_GE(dot<2>(rained, first), -0.1 - 1e-6) << degrees;
    EXPECT_GE(dot<2>(rained, second), -1e-6) << degrees;
  }
}

/// All the water that a flux over both sides of an edge states comes in, in the direction that gives each its own: by
/// one boundary over both, by one for each, and beside a wall, which lets none pass. On a flat face too, where the node
/// in between has one velocity for both sides.
TEST(OwnBoundary, PumpsThroughTheSidesOfAnEdge) {
  struct Pump {
    std::vector<Square1m::Source> sources;
    double base, rise;  ///< inflow [m/s]
  };
  const Boundary whole{Flux{1.}}, half{Flux{0.5}};
  for (const double rise : {1., 0.1, -5., 0.})  // an edge of 45 degrees, relief, an edge of 79 degrees, none
    for (const Pump &pump : {Pump{{{"both", {"base", "middle"}, whole}}, 1, 1},
                             Pump{{{"base", {"base"}, whole}, {"rise", {"middle"}, half}}, 1, 0.5},
                             Pump{{{"base", {"base"}, whole}, {"rain", {"middle"}, Rainfall{}}}, 1, 0},
                             Pump{{{"base", {"base"}, whole}, {"rise", {"middle"}, Roller{}}}, 1, 0}}) {
      Square1m soil(pump.sources, bent_square(rise));
      PoreConditions<2> pores;
      const std::vector<Vec<2>> w = pumped(soil, pores);
      double in = 0, stated = 0;
      for (const auto &[group, inflow] : {std::pair{"base", pump.base}, std::pair{"middle", pump.rise}})
        for (const Facet<2> &f : soil.mesh.facets(group))
          for (const int node : f.node) {
            stated += f.area / 2 * inflow;
            in -= f.area / 2 * dot<2>(w[soil.grid.find_node(node)], f.normal);
          }
      EXPECT_NEAR(sum(in), sum(stated), 1e-12) << "rise " << rise << ", boundaries " << pump.sources.size();
    }
}

TEST(OwnBoundary, SupportsAndLoadsFiniteElements) {
  Square1m soil({{"base", {"base"}, Conveyor{}}, {"top", {"top"}, WetRaft{}}});
  SoilData<2> data;
  data.density = [](const BodySource &, const Vec<2> &, double) { return 1600.; };
  const std::vector<Law> laws{read_law(soil.scene.body[0].law)};
  SoilElements<2> elements(soil.mesh, soil.scene, laws, data);
  ASSERT_EQ(elements.activate({1}), 0);
  Supports<2> supports;
  ASSERT_EQ(supports.setup(soil.mesh, elements.nodes(), elements.active(), soil.sources), 0);
  EXPECT_TRUE(supports.moves());
  for (int i = 0; i < elements.nodes().count(); ++i) {
    const Vec<2> &x = elements.nodes().position[i];
    ASSERT_EQ(supports.at(i) != nullptr, x[1] == 0);
    if (supports.at(i)) {
      EXPECT_NEAR(supports.increment(i, x, 1, 3)[0], 2 * (0.25 + 2), round_off);
    }
  }
  Loads<2> loads(elements, soil.scene, soil.sources, data);
  loads.activate();
  std::vector<double> force;
  loads.force(2, force);
  double total[2]{};
  for (size_t i = 0; i < force.size(); ++i) total[i % 2] += force[i];
  EXPECT_NEAR(sum(total[0]), 7, round_off);
  EXPECT_NEAR(sum(total[1]), -10, round_off);
}

TEST(OwnBoundary, DrainsAndWatersSeepage) {
  Square1m soil({{"base", {"base"}, PorousStone{}}, {"top", {"top"}, WetRaft{}}});
  PoreFlow<2> flow(soil.mesh, soil.scene, soil.sources, false);
  ASSERT_EQ(flow.activate(std::vector<char>(soil.mesh.cell_count(), 1), [](const Vec<2> &) { return 0.; }), 0);
  ASSERT_EQ(flow.begin(1, 0, 0, 1), 0);
  for (int i = 0; i < flow.nodes().count(); ++i)
    if (const Vec<2> &x = flow.nodes().position[i]; x[1] == 0) {
      EXPECT_TRUE(flow.fixed(i));
      EXPECT_NEAR(flow.pressure[i], 3010 + 100 * x[0], 1e-9);
    }
  flow.commit(4, 1, std::vector<double>(flow.nodes().count(), 0));
  EXPECT_NEAR(flow.inflow()[1], 4e-6, 1e-18);  // over the top, whose length is 1 m
}

}  // namespace
}  // namespace talus
