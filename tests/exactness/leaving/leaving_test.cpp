// Particles that leave the mesh (mesh.leaving_particles): a block is shot out through an open side. Each particle is in
// the mesh or in the ledger, never in both; mass, water and momentum close; the ledger is the same on several ranks and
// after a resume.
#include <gtest/gtest.h>

#include "bad_input/program.h"
#include "bad_input/scene.h"

namespace talus {
namespace {

/// An elastic block that flies to the right at 12 m/s, shaking, through free space: its front reaches the side at x = 3
/// m after 0.17 s, its back after 0.21 s.
const std::string shot = R"(gravity = 0
[mesh]
section = ")" TALUS_MESHES R"(/flight.csv"
size = 0.15
leaving_particles = "remove"
[body.block]
region = "block"
porosity = 0.4
grain_density = 2650
law = "linear_elastic"
young_modulus = "1 MPa"
poisson_ratio = 0.3
[body.block.retention]
curve = "van_genuchten"
reference_suction = "5 kPa"
shape = 0.5
[body.block.relative_permeability]
curve = "van_genuchten_mualem"
shape = 0.5
[output]
interval = 0.01
history_interval = 0.01
)";
const std::string way_out = "[[stage]]\nname = \"out\"\nduration = 0.19\n", rest = "[[stage]]\nduration = 0.06\n";

struct Variant {
  const char *name;
  std::vector<std::string> set;
};
void PrintTo(const Variant &variant, std::ostream *out) { *out << variant.name; }

const std::vector<std::string> straight{"body.block.velocity=[\"12 + 6 * (y - 0.75)\", \"3 * (x - 0.75)\"]"},
    in_3d{"dimension=3",
          "mesh.thickness=0.3",
          "mesh.layers=0",
          "mesh.size=0.25",
          "boundary.sides.kind=roller",
          "boundary.sides.group=[\"front\", \"back\"]",
          "body.block.velocity=[\"12 + 6 * (y - 0.75)\", \"3 * (x - 0.75)\", \"0\"]"},
    wet{"phases=saturated", "body.block.permeability=1e-9", "water.bulk_modulus=1e7"},
    moist{"phases=unsaturated", "body.block.permeability=1e-12", "water.bulk_modulus=1e7", "water.suction=2e3"};

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string> &b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

class Leaving : public testing::Test {
 protected:
  Leaving() {
    folder_.write("out.toml", shot + way_out);
    folder_.write("whole.toml", shot + way_out + rest);
  }
  Ending run(const std::string &scene, const std::string &results, const std::vector<std::string> &set, int ranks = 1,
             const std::vector<std::string> &more = {}) {
    std::vector<std::string> words{"run", scene, "-o", results, "--no-pictures"};
    for (const std::string &key : set) words.insert(words.end(), {"--set", key});
    return talus(folder_, words + more, ranks);
  }
  void expect(const std::vector<std::string> &words) {
    const Ending ending = Program(folder_, std::vector<std::string>{PYTHON, LEDGER} + words).end();
    EXPECT_TRUE(ending.says(" ok")) << ending.output;
  }

  const Folder folder_;
};
class EachLeaving : public Leaving, public testing::WithParamInterface<Variant> {};

/// Half of the block is gone at 0.19 s, all of it at 0.25 s. The run that ends when half of it has left goes on with
/// one more stage and is then the whole one to the bit; on several ranks it is the same but for round-off.
TEST_P(EachLeaving, ClosesItsLedgerOnSeveralRanksAndGoesOnToTheBit) {
  for (const int ranks : {1, 2, 4}) {
    SCOPED_TRACE(ranks);
    const std::string whole = "whole" + std::to_string(ranks), resumed = "resumed" + std::to_string(ranks);
    const Ending all = run("whole.toml", whole, GetParam().set, ranks);
    ASSERT_EQ(all.status, 0) << all.output;
    EXPECT_TRUE(all.says(" left by right: mass ") && all.says("; no soil is left")) << all.output;
    expect({"closes", whole, "all"});
    if (ranks > 1) expect({"agree", "whole1", whole});
    if (ranks > 2) continue;
    const Ending half = run("out.toml", resumed, GetParam().set, ranks);
    ASSERT_EQ(half.status, 0) << half.output;
    EXPECT_TRUE(half.says("particles leave the mesh, the first near (3, ")) << half.output;
    expect({"closes", resumed});
    const Ending ending = run("whole.toml", resumed, GetParam().set, ranks, {"--resume"});
    ASSERT_EQ(ending.status, 0) << ending.output;
    expect({"same", whole, resumed});
  }
}

const Variant variants[] = {
    {"dry", straight},
    {"dry_at_particles",
     straight + std::vector<std::string>{"transfer.average_stress=false", "transfer.locking=nodal"}},
    {"dry_with_a_remap_in_every_step", straight + std::vector<std::string>{"transfer.remap_interval=0"}},
    {"saturated", straight + wet},
    {"saturated_at_particles",
     straight + wet + std::vector<std::string>{"transfer.average_stress=false", "transfer.locking=nodal"}},
    {"unsaturated", straight + moist},
    {"dry_in_3d", in_3d},
    {"saturated_in_3d", in_3d + wet}};
INSTANTIATE_TEST_SUITE_P(All, EachLeaving, testing::ValuesIn(variants),
                         [](const auto &variant) { return variant.param.name; });

/// A run that a leaving particle has ended says how it can go on; so it does, and is then the run that removed
/// particles from the start.
TEST_F(Leaving, GoesOnWhereItHadEnded) {
  for (const int ranks : {1, 2}) {
    const std::string whole = "whole" + std::to_string(ranks), resumed = "resumed" + std::to_string(ranks);
    ASSERT_EQ(run("whole.toml", whole, straight, ranks).status, 0);
    const Ending ended =
        run("whole.toml", resumed, straight + std::vector<std::string>{"mesh.leaving_particles=stop"}, ranks);
    EXPECT_EQ(ended.status, 1);
    for (const char *words :
         {"a particle left the mesh near (3, ", "mesh.leaving_particles = \"remove\"", "--resume goes on from t = 0.1"})
      EXPECT_TRUE(ended.says(words)) << words << "\n" << ended.output;
    EXPECT_FALSE(std::filesystem::exists(folder_ / resumed + "/escaped.csv"));
    const Ending ending = run("whole.toml", resumed, straight, ranks, {"--resume"});
    ASSERT_EQ(ending.status, 0) << ending.output;
    EXPECT_TRUE(ending.says("since then the scene has another mesh.leaving_particles")) << ending.output;
    expect({"same", whole, resumed});
  }
}

/// What the checkpoint depends on may not change, and the refusal says why.
TEST_F(Leaving, GoesOnWithTheSameMeshAndBoundaries) {
  ASSERT_EQ(run("out.toml", "results", straight).status, 0);
  const Ending mesh =
                   run("whole.toml", "results", straight + std::vector<std::string>{"mesh.size=0.2"}, 1, {"--resume"}),
               boundary = run("whole.toml", "results", straight + std::vector<std::string>{"boundary.right.kind=fixed"},
                              1, {"--resume"});
  EXPECT_EQ(mesh.status, 2);
  EXPECT_TRUE(mesh.says("belong to the cells of the mesh") && mesh.says("mesh.leaving_particles")) << mesh.output;
  EXPECT_EQ(boundary.status, 2);
  EXPECT_TRUE(boundary.says("the checkpoint holds reactions, contacts and work")) << boundary.output;
}

/// A point of the output whose particle has left has no values, and a stage that watches it ends with that reason.
TEST_F(Leaving, PointsThatHaveLeftHaveNoValues) {
  const std::vector<std::string> point =
      straight + std::vector<std::string>{"output.point.front.position=[0.98, 0.75]"};
  ASSERT_EQ(run("out.toml", "results", point).status, 0);
  const Ending read = Program(folder_, {PYTHON, "-c",
                                        "import csv\nrows = list(csv.DictReader(open('results/history.csv')))\n"
                                        "print([row['front_velocity_m_s'] for row in (rows[1], rows[-1])])"})
                          .end();
  EXPECT_TRUE(read.says("', 'nan']") || read.says("', '-nan']")) << read.output;
  EXPECT_FALSE(read.says("['nan") || read.says("['-nan")) << read.output;
  const Ending watched = run("out.toml", "watched",
                             point + std::vector<std::string>{"stage.0.until=failure", "stage.0.failure_point=front",
                                                              "stage.0.failure_speed=1000"});
  EXPECT_EQ(watched.status, 1);
  EXPECT_TRUE(watched.says("watches has left the mesh")) << watched.output;
}

/// A run from which nothing leaves has no ledger, and a run that replaces another does not keep its ledger.
TEST_F(Leaving, LedgersAreOfTheirRun) {
  ASSERT_EQ(run("out.toml", "results", straight).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "results/escaped.csv"));
  ASSERT_EQ(run("out.toml", "results", {"body.block.velocity=[\"1\", \"0\"]"}, 1, {"--force"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results/escaped.csv"));
}

/// Soil that comes to a wall at the end of the mesh is said once, with place and stage, the same on several
/// ranks; so is none where soil does not move or where it is let out.
TEST_F(Leaving, TheEndOfTheMeshIsSaid) {
  const std::vector<std::string> wall{"mesh.leaving_particles=stop", "boundary.right.kind=roller",
                                      "body.block.velocity=[\"12\", \"0\"]"};
  const std::string warning = "warning: moving soil has come to the end of the mesh at x = 3 m, near (";
  const auto said = [&](const std::string &results) {
    std::ostringstream text;
    text << std::ifstream(folder_ / (results + "/run.log")).rdbuf();
    return Ending{0, text.str()};
  };
  std::string first;
  for (const int ranks : {1, 2}) {
    const std::string results = "wall" + std::to_string(ranks);
    ASSERT_EQ(run("out.toml", results, wall, ranks).status, 0);
    ASSERT_EQ(run("whole.toml", results, wall, ranks, {"--resume"}).status, 0);
    const Ending log = said(results);
    EXPECT_EQ(log.count(warning), 1) << log.output;
    EXPECT_TRUE(log.says(" m, in stage out: from now on its run-out is that of the mesh"));
    const std::string sentence = log.output.substr(log.output.find(warning), 100);
    EXPECT_TRUE(sentence.find(warning + "2.") == 0 || sentence.find(warning + "3, ") == 0) << sentence;
    EXPECT_EQ(first.empty() ? first = sentence : first, sentence);
  }
  ASSERT_EQ(run("out.toml", "still", {wall[0], wall[1]}).status, 0);
  EXPECT_EQ(said("still").count(warning), 0);
  ASSERT_EQ(run("out.toml", "open", straight).status, 0);
  EXPECT_EQ(said("open").count(warning), 0);
}

/// None leaves, and none is missed either: the mass of as many particles of equal mass differs with the order of its
/// sum.
TEST_F(Leaving, MissesNoneOfManyEqualParticles) {
  folder_.write("dam.toml", R"(gravity = 9.81
[mesh]
section = ")" TALUS_MESHES R"(/dam.csv"
size = 0.014
[body.soil]
region = "soil"
density = 2000
particles_per_cell = 16
law = "linear_elastic"
young_modulus = "1 MPa"
poisson_ratio = 0.3
[boundary.base]
kind = "fixed"
[boundary.left]
kind = "roller"
[[stage]]
duration = 3e-4
[output]
interval = 0
history_interval = 0
)");
  const Ending ending = run("dam.toml", "dam", {"transfer.remap_interval=0"});
  EXPECT_EQ(ending.status, 0) << ending.output;
}

}  // namespace
}  // namespace talus
