// A run that starts at the state of another goes on as that one would have, with the keys that may be others in effect;
// the keys that the state is tied to are refused.
#include <gtest/gtest.h>

#include "tests/exactness/bad_input/scene.h"

namespace talus {
namespace {

const std::string stages = "[[stage]]\nname = \"fall\"\nduration = 0.05\n";

/// Sand with some cohesion, whose loads begin with the stage `fall`.
const std::string soil =
    changed(changed(changed(changed(good_scene, stages, ""), "cohesion = 0", "cohesion = \"1 kPa\""), "density = 2000",
                    "porosity = 0.3\ngrain_density = 2650"),
            "[boundary.base]\nkind = \"fixed\"", "[boundary.base]\nkind = \"friction\"\nfriction_angle = 15");
const std::string settle =
    "[[stage]]\nname = \"settle\"\nduration = 0.03\ndamping = 0.5\nhold_loads = true\nreset_displacement = true\n";
const std::string balance = "[[stage]]\nname = \"balance\"\nkind = \"quasi_static\"\nduration = 1\nhold_loads = true\n";
const std::string fall = "[[stage]]\nname = \"fall\"\nduration = 0.03\n";
const std::string from_source = "[start_from]\nfolder = \"results/source\"\n";

struct Variant {
  const char *name;
  std::string first;  ///< stage of the source
  std::vector<std::string> set;
  int ranks = 1;
};

void PrintTo(const Variant &variant, std::ostream *out) { *out << variant.name; }

const std::vector<std::string> moist{"phases=unsaturated",
                                     "body.sand.permeability=1e-10",
                                     "water.bulk_modulus=1e7",
                                     "water.table=[[0, 0.2], [2, 0.2]]",
                                     "body.sand.retention.curve=van_genuchten",
                                     "body.sand.retention.reference_suction=5e3",
                                     "body.sand.retention.shape=0.5",
                                     "body.sand.relative_permeability.curve=van_genuchten_mualem",
                                     "body.sand.relative_permeability.shape=0.5",
                                     "boundary.rain.kind=rainfall",
                                     "boundary.rain.group=free_surface",
                                     "boundary.rain.intensity=0.01"};

const Variant variants[] = {
    {"after_motion", settle, {}},
    {"after_motion_on_two_ranks", settle, {}, 2},
    {"after_equilibrium", balance, {"body.sand.cohesion=5e3", "boundary.base.friction_angle=30"}},
    {"after_motion_of_moist_soil", settle, moist},
    {"drained_with_a_rising_table", settle, {"phases=drained", "water.table=[[0, 0.3]]", "water.level=t"}},
    {"with_strength_by_place", settle, {"body.sand.cohesion=1e3 + 500 * x"}},
};

class Work {
 public:
  Work() { folder.write("section.csv", good_section); }
  Ending run(const std::string &scene, const std::string &results, const std::vector<std::string> &set, int ranks = 1,
             const std::vector<std::string> &more = {}) const {
    folder.write("scene.toml", scene);
    std::vector<std::string> words{"run", "scene.toml", "-o", "results/" + results, "--no-pictures"};
    for (const std::string &key : set) words.insert(words.end(), {"--set", key});
    words.insert(words.end(), more.begin(), more.end());
    return talus(folder, words, ranks);
  }
  void expect_python(const std::string &text) const {
    const Ending ending = Program(folder, {PYTHON, "-c", reading + text + "\nprint('as expected')"}).end();
    EXPECT_TRUE(ending.says("as expected")) << ending.output;
  }

  const Folder folder;

 private:
  const std::string reading = R"(
import csv, h5py, numpy
def end(run):
    last = max(h5py.File(f'results/{run}/run.h5')['snapshots'].values(), key=lambda s: s.attrs['step'])
    order = numpy.argsort(last['id'][...])
    return {name: field[...][order] for name, field in last.items()}
def rows(run, stage):
    return [row for row in csv.DictReader(open(f'results/{run}/history.csv')) if row['stage'] == stage]
)";
};

class Started : public testing::TestWithParam<Variant> {};

/// The same up to round-off: particles come in another order, and times are sums from another start. A step changes the
/// state by 1e-2 and more of its size; what is left out or counted twice shows far above 1e-7.
TEST_P(Started, GoesOnLikeTheRunThatWasNotParted) {
  const Variant &variant = GetParam();
  const Work work;
  for (const auto &[scene, results] : {std::pair{soil + variant.first + fall, "whole"},
                                       {soil + variant.first, "source"},
                                       {soil + fall + from_source, "started"}}) {
    const Ending ending = work.run(scene, results, variant.set, variant.ranks);
    ASSERT_EQ(ending.status, 0) << ending.output;
  }
  work.expect_python(R"(
whole, started = end('whole'), end('started')
assert whole.keys() == started.keys()
for field in whole:
    a, b = whole[field], started[field]
    assert a.shape == b.shape, field
    assert numpy.allclose(a, b, rtol=0, atol=1e-7 * numpy.abs(a).max(initial=0) + 1e-15, equal_nan=True), f'{field} {numpy.abs(a - b).max()} of {numpy.abs(a).max()}'
assert numpy.abs(whole['velocity']).max() > 1e-4
a, b = rows('whole', 'fall')[-1], rows('started', 'fall')[-1]
before = [row for row in csv.DictReader(open('results/whole/history.csv')) if row['stage'] != 'fall'][-1]
for name in a:
    if name.startswith('work_'):
        moved = float(a[name]) - float(before[name])
        assert abs(moved - float(b[name])) <= 1e-7 * (abs(float(a[name])) + abs(float(before[name])) + 1e-3), name
)");
}

INSTANTIATE_TEST_SUITE_P(All, Started, testing::ValuesIn(variants),
                         [](const auto &variant) { return variant.param.name; });

class AfterSource : public testing::Test {
 protected:
  AfterSource() {
    const Ending ending = work_.run(soil + settle, "source", {});
    EXPECT_EQ(ending.status, 0) << ending.output;
  }
  Ending start(const std::string &results, const std::vector<std::string> &set, int ranks = 1,
               const std::vector<std::string> &more = {}) {
    return work_.run(soil + fall + from_source, results, set, ranks, more);
  }
  void expect_refused(const std::vector<std::string> &set, const std::vector<std::string> &words, int ranks = 1) {
    const Ending ending = start("refused", set, ranks);
    EXPECT_EQ(ending.status, 2) << ending.output;
    for (const std::string &word : words) EXPECT_TRUE(ending.says(word)) << word << "\n" << ending.output;
    EXPECT_EQ(ending.count("talus: "), 1) << ending.output;
    EXPECT_FALSE(std::filesystem::exists(work_.folder / "results/refused")) << set[0];
  }
  const Work work_;
};

TEST_F(AfterSource, OtherKeysHaveEffect) {
  ASSERT_EQ(start("same", {}).status, 0);
  for (const char *key :
       {"body.sand.friction_angle=10", "body.sand.young_modulus=2e6", "boundary.base.friction_angle=2", "gravity=20",
        "integrator.kind=arkode", "integrator.step=1e-5", "transfer.remap_interval=0",
        "stage.fall.seismic_coefficient=[0.3, 0]", "body.sand.body_acceleration=[\"t * 1e3\", \"0\"]"}) {
    const Ending ending = start("other", {key}, 1, {"--force"});
    EXPECT_EQ(ending.status, 0) << ending.output;
    EXPECT_TRUE(ending.says("starts at the state of the run in results/source, t = 0.03 s")) << ending.output;
    SCOPED_TRACE(key);
    work_.expect_python(
        "assert not numpy.allclose(end('same')['position'], end('other')['position'], rtol=0, atol=1e-12)");
  }
}

/// Round-off is all that the number of ranks changes, and 1e-9 of the size of the box leaves it room.
TEST_F(AfterSource, StartsOnAnyNumberOfRanks) {
  ASSERT_EQ(start("alone", {}).status, 0);
  for (const int ranks : {2, 4}) {
    const Ending ending = start("shared", {}, ranks, {"--force"});
    EXPECT_EQ(ending.status, 0) << ending.output;
    work_.expect_python(R"(
alone, shared = end('alone'), end('shared')
order = [numpy.argsort(run['id'][...]) for run in (alone, shared)]
assert numpy.array_equal(alone['id'][...][order[0]], shared['id'][...][order[1]])
assert numpy.abs(alone['position'][...][order[0]] - shared['position'][...][order[1]]).max() < 1e-9
)");
  }
}

/// Finite elements have nodes on edges, which go to other ranks too, though this scene has no stage of theirs.
TEST(StartedBehindElements, StartsOnAnotherNumberOfRanks) {
  const Work work;
  const std::vector<std::string> firm{"body.sand.cohesion=5e3", "boundary.base.friction_angle=30"};
  for (const int ranks : {1, 2}) {
    const Ending source = work.run(soil + balance, "source", firm, ranks, {"--force"});
    ASSERT_EQ(source.status, 0) << source.output;
    const std::string name = "from" + std::to_string(ranks);
    const Ending ending = work.run(soil + fall + from_source, name, firm, 3 - ranks);
    EXPECT_EQ(ending.status, 0) << ending.output;
  }
  work.expect_python("a, b = end('from1'), end('from2')\nassert numpy.abs(a['position'] - b['position']).max() < 1e-9");
}

TEST_F(AfterSource, SaysWhatIsDifferent) {
  const Ending ending = start("other", {"body.sand.friction_angle=10"});
  EXPECT_TRUE(ending.says("since then the scene has another body.sand.friction_angle")) << ending.output;
}

TEST_F(AfterSource, WhatTheStateIsTiedToIsRefused) {
  for (const char *key : {"body.sand.porosity=0.31", "body.sand.region=air", "body.sand.law=drucker_prager",
                          "body.sand.particles_per_cell=6", "body.sand.stress=[1e3, 0, 0, 0]",
                          "body.sand.velocity=[1, 0]", "body.sand.averaging_length=0.5", "boundary.left.kind=fixed",
                          "boundary.left.group=right", "transfer.average_stress=false", "transfer.locking=none",
                          "transfer.integration=cell", "quasi_static.elements=linear"})
    expect_refused({key}, {std::string(key, std::string(key).find('=')), "that start_from names"});
  expect_refused({"boundary.right.kind=roller"}, {"boundary.right", "that start_from names"});
  expect_refused({"phases=drained", "water.table=[[0, 0.1]]"}, {"phases", "that start_from names"});
  expect_refused({"mesh.size=0.2"}, {"mesh.size", "its mesh was another one", "belong to the cells of that mesh"});
  expect_refused({"body.sand.cohesion=1e3 + 500 * x"},
                 {"body.sand.cohesion", "strength that varies with place stays with the particles"});
  ASSERT_EQ(work_.run(soil + settle, "varied", {"body.sand.cohesion=1e3 + 500 * x"}).status, 0);
  expect_refused({"start_from.folder=results/varied"}, {"start_from.folder", "strength that varies with place there"});
}

/// Unit weights are densities by the gravity of the first run, and its particles bring their masses from there.
TEST_F(AfterSource, AnotherGravityIsRefusedWhereUnitWeightsGiveTheDensity) {
  const std::string heavy = changed(soil, "porosity = 0.3\ngrain_density = 2650", "unit_weight = \"20 kN/m3\"");
  ASSERT_EQ(work_.run(heavy + settle, "heavy", {}).status, 0);
  const auto start_there = [&](const std::string &gravity) {
    return work_.run(changed(heavy, "gravity = 9.81", gravity) + fall + "[start_from]\nfolder = \"results/heavy\"\n",
                     "refused", {});
  };
  const Ending ending = start_there("gravity = 20");
  EXPECT_EQ(ending.status, 2) << ending.output;
  EXPECT_TRUE(ending.says("line 2: gravity = 20 is not the 9.81 m/s2 of the run") &&
              ending.says("the unit weights of sand"))
      << ending.output;
  EXPECT_EQ(start_there("gravity = [5.886, -7.848]").status, 0) << "turned, of the same size";
}

TEST_F(AfterSource, AFolderWithoutAStateIsRefused) {
  expect_refused({"start_from.folder=results/nobody"}, {"start_from.folder", "contains no checkpoint"});
  const Ending own = start("source", {}, 1, {"--force"});
  EXPECT_EQ(own.status, 2);
  EXPECT_TRUE(own.says("own results")) << own.output;
  std::filesystem::remove(work_.folder / "results/source/checkpoint/header");
  std::filesystem::remove(work_.folder / "results/source/checkpoint/header.before");
  expect_refused({"gravity=9"}, {"results/source contains no checkpoint"});
  work_.folder.write("results/source/checkpoint/header", "?");
  expect_refused({"gravity=9"}, {"is no checkpoint of this version"});
}

TEST_F(AfterSource, DisplacementIsKeptUnlessAskedOtherwise) {
  ASSERT_EQ(work_.run(soil + changed(settle, "reset_displacement = true\n", ""), "kept", {}).status, 0);
  ASSERT_EQ(start("kept_on", {"start_from.folder=results/kept"}).status, 0);
  ASSERT_EQ(start("zeroed", {"start_from.folder=results/kept", "start_from.reset_displacement=true"}).status, 0);
  work_.expect_python(R"(
def first(run): return h5py.File(f'results/{run}/run.h5')['snapshots/000000']['displacement'][...]
assert numpy.abs(first('kept_on')).max() > 1e-4 and numpy.abs(first('zeroed')).max() == 0
)");
}

/// The run has its state in its own checkpoint: the source is not asked again.
TEST_F(AfterSource, IsResumedToTheBitWithoutTheSource) {
  ASSERT_EQ(start("whole", {}).status, 0);
  ASSERT_EQ(start("resumed", {"stage.fall.duration=0.02"}).status, 0);
  std::filesystem::remove_all(work_.folder / "results/source");
  const Ending ending = start("resumed", {}, 1, {"--resume"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  work_.expect_python(
      "a, b = end('whole'), end('resumed')\nfor f in a: assert numpy.array_equal(a[f], b[f], equal_nan=True), f");
}

TEST_F(AfterSource, CheckStartsThereToo) {
  work_.folder.write("scene.toml", soil + fall + from_source);
  const Ending good = talus(work_.folder, {"check", "scene.toml"});
  EXPECT_EQ(good.status, 0) << good.output;
  std::filesystem::remove_all(work_.folder / "results/source");
  const Ending bad = talus(work_.folder, {"check", "scene.toml"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_TRUE(bad.says("contains no checkpoint")) << bad.output;
}

}  // namespace
}  // namespace talus
