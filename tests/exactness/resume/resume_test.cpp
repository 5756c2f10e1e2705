// A run that was interrupted, at whatever step, or killed, and then resumed, is the run that was not: bit for bit on
// the same number of ranks.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "tests/exactness/bad_input/scene.h"

namespace talus {
namespace {

/// Sand that settles and then falls for ever onto a rough base, whose contacts stick and slip; strength falls with
/// plastic strain.
const std::string falling_scene = changed(
    changed(changed(changed(good_scene, "density = 2000", "porosity = 0.3\ngrain_density = 2650"),
                    "[boundary.base]\nkind = \"fixed\"", "[boundary.base]\nkind = \"friction\"\nfriction_angle = 15"),
            "cohesion = 0\nfriction_angle = 30",
            "cohesion = \"1 kPa\"\nfriction_angle = 30\nresidual_cohesion = 0\nshape_factor = 20"),
    "[[stage]]\nname = \"fall\"\nduration = 0.05\n[output]\n",
    "[[stage]]\nname = \"settle\"\nduration = 0.02\ndamping = 0.5\nreset_displacement = true\n"
    "[[stage]]\nname = \"fall\"\nduration = 1000\n[output]\nhistory_interval = 0.003\npoint.tip.position = [1, 0.5]\n"
    "line.down.points = [[1, 0.5], [1, 0.1]]\nline.down.spacing = 0.1\n");

struct Variant {
  const char *name;
  std::vector<std::string> set;
  int ranks = 1, signal = SIGINT;
  std::vector<const char *> until = {"000003"};  ///< snapshots at which the run is ended by the signal
};

void PrintTo(const Variant &variant, std::ostream *out) { *out << variant.name; }

/// A moist soil with a water table in it.
std::vector<std::string> with_pores(std::vector<std::string> set) {
  for (const char *key : {"body.sand.permeability=1e-10", "water.bulk_modulus=1e7", "water.table=[[0, 0.2], [2, 0.2]]",
                          "body.sand.retention.curve=van_genuchten", "body.sand.retention.reference_suction=5e3",
                          "body.sand.retention.shape=0.5", "body.sand.relative_permeability.curve=van_genuchten_mualem",
                          "body.sand.relative_permeability.shape=0.5"})
    set.push_back(key);
  return set;
}

/// A base that loses half of its friction to heat within a few centimetres.
const std::vector<std::string> heated_base{
    "boundary.base.kind=heated_friction", "boundary.base.friction_angle=30",
    "boundary.base.thickness=1e-3",       "boundary.base.hydraulic_conductivity=1e-9",
    "boundary.base.storage=1e-8",         "boundary.base.thermal_pressurisation=1e5",
    "boundary.base.heat_capacity=1e6"};

const std::vector<std::string> shaken{
    "earthquake=[{kind='kanai_tajimi', amplitude=5, duration=10, rise=0.01, strong=9}]", "stage.fall.earthquake=true",
    "body.sand.damping_ratio=0.05", "stage.fall.damping_frequencies=[5, 20]"};

const Variant variants[] = {
    {"dry", {}},
    {"dry_when_killed", {}, 1, SIGKILL},
    {"dry_with_checkpoints_of_their_own_times", {"output.checkpoint_interval=0.007"}, 1, SIGKILL},
    {"dry_on_two_ranks", {}, 2, SIGTERM},
    {"dry_with_particle_stress_and_pic",
     {"transfer.average_stress=false", "transfer.locking=nodal", "transfer.velocity=pic"}},
    {"on_a_base_that_slip_weakens",
     {"boundary.base.friction_angle=10 + 20 * exp(-slip / 0.1)", "stage.settle.softening=false"}},
    {"on_a_base_that_heats_itself", heated_base},
    {"on_a_base_that_heats_itself_on_two_ranks", heated_base, 2, SIGKILL},
    {"on_a_base_that_heats_itself_by_arkode",
     [] {
       std::vector<std::string> set = heated_base;
       set.push_back("integrator.kind=arkode");
       return set;
     }()},
    {"with_strength_by_place",
     {"body.sand.cohesion=1e3 + 500 * x", "body.sand.friction_angle=30 - 4 * y", "transfer.remap_interval=0.05"}},
    {"with_strength_by_place_at_particles_on_two_ranks",
     {"body.sand.cohesion=1e3 + 500 * x", "transfer.average_stress=false", "transfer.locking=nodal"},
     2},
    {"drained", {"phases=drained", "water.table=[[0, 0.3], [2, 0.1]]", "water.excess=100 * t"}},
    {"undrained", {"phases=drained", "water.table=[[0, 0.3], [2, 0.1]]", "body.sand.drainage=undrained"}},
    {"saturated", {"phases=saturated", "body.sand.permeability=1e-10", "water.bulk_modulus=1e7"}},
    {"implicit_pressure",
     {"phases=saturated", "body.sand.permeability=1e-10", "water.pressure=implicit", "boundary.base={kind='fixed'}"}},
    {"implicit_pressure_in_moist_soil_on_two_ranks",
     with_pores({"phases=unsaturated", "water.pressure=implicit", "boundary.base={kind='fixed'}",
                 "boundary.rain.kind=rainfall", "boundary.rain.group=free_surface", "boundary.rain.intensity=0.01"}),
     2, SIGKILL},
    {"unsaturated_in_rain", with_pores({"phases=unsaturated", "boundary.rain.kind=rainfall",
                                        "boundary.rain.group=free_surface", "boundary.rain.intensity=0.01"})},
    {"unsaturated_with_given_pressures_at_first", with_pores({"phases=unsaturated", "stage.0.pore_flow=false"})},
    {"three_phase", with_pores({"phases=three-phase"})},
    {"by_naive_forms",
     with_pores({"phases=unsaturated", "water.storage=rate", "water.drag=explicit", "boundary.rain.kind=rainfall",
                 "boundary.rain.group=free_surface", "boundary.rain.intensity=0.01"})},
    {"balanced_at_every_remap_on_two_ranks", {"mesh.balance_ranks=always"}, 2, SIGKILL},
    {"drained_by_arkode_and_balanced_at_every_remap_on_two_ranks",
     {"phases=drained", "water.table=[[0, 0.3], [2, 0.1]]", "integrator.kind=arkode", "mesh.balance_ranks=always"},
     2,
     SIGTERM,
     {"000002", "000004", "000006", "000008", "000010", "000012", "000014", "000016", "000018", "000020", "000022"}},
    {"in_halved_cells_balanced_at_every_remap_on_two_ranks",
     {"mesh.size=0.2", "mesh.halvings=1", "mesh.balance_ranks=always"},
     2,
     SIGKILL},
    {"in_an_earthquake_on_two_ranks", shaken, 2, SIGKILL},
    {"in_a_wave_that_comes_in",
     [] {
       std::vector<std::string> set = shaken;
       set.insert(set.end(), {"boundary.base={kind='roller'}", "boundary.left.kind=non_reflecting",
                              "boundary.left.incoming_wave=true"});
       return set;
     }()},
    {"between_tied_sides_on_two_ranks",
     [] {
       std::vector<std::string> set = shaken;
       set.insert(set.end(), {"boundary.left.kind=tied", "boundary.left.group=['left', 'right']"});
       return set;
     }(),
     2, SIGKILL},
    {"beside_free_ground_balanced_at_every_remap_on_two_ranks",
     [] {
       std::vector<std::string> set = shaken;
       set.insert(set.end(), {"boundary.left.kind=free_field", "mesh.balance_ranks=always"});
       return set;
     }(),
     2, SIGKILL},
    {"with_hysteretic_soil", {"body.sand.law=hysteretic_mohr_coulomb", "body.sand.reference_strain=1e-3"}},
    {"with_damping_by_arkode",
     [] {
       std::vector<std::string> set = shaken;
       set.push_back("integrator.kind=arkode");
       return set;
     }()},
    {"with_a_fixed_step", {"integrator.step=2e-4"}},
    {"by_arkode", {"integrator.kind=arkode"}, 1, SIGKILL},
    {"by_arkode_with_moving_water", with_pores({"phases=unsaturated", "integrator.kind=arkode"})},
    {"with_steps_by_the_frequency_of_the_mesh", {"integrator.omega_max=mesh"}},
    {"with_moving_water_and_steps_by_the_frequency_of_the_mesh",
     with_pores({"phases=unsaturated", "integrator.omega_max=mesh"})},
    {"in_3d",
     {"dimension=3", "mesh.thickness=0.25", "boundary.front.kind=roller", "boundary.back.kind=roller",
      "output.point.tip.position=[1, 0.5, 0]", "output.line.down.points=[[1, 0.5, 0.1], [1, 0.1, 0.1]]"}},
    {"in_3d_by_default_with_the_frequency_of_the_mesh",
     {"dimension=3", "mesh.thickness=0.5", "mesh.layers=2", "boundary.front.kind=roller", "boundary.back.kind=roller",
      "output.point.tip.position=[1, 0.5, 0]", "output.line.down.points=[[1, 0.5, 0.1], [1, 0.1, 0.1]]"}},
};

class Resumed : public testing::TestWithParam<Variant> {
 protected:
  Resumed() { folder_.write("section.csv", good_section), folder_.write("scene.toml", falling_scene); }

  /// Runs until a snapshot is there, then ends the run by a signal.
  void run_until(const std::string &results, const std::string &snapshot, int signal, bool resume) {
    std::vector<std::string> words{"run", "scene.toml", "-o", results, "--no-pictures"};
    for (const std::string &key : GetParam().set) words.insert(words.end(), {"--set", key});
    if (resume) words.push_back("--resume");
    Program program(folder_, talus_words(words, GetParam().ranks));
    ASSERT_TRUE(program.wait_for(folder_ / results + "/run/" + snapshot + ".h5")) << program.end().output;
    program.signal(signal);
    program.end();
    wait_for_lock(results);
  }

  /// Ranks whose mpirun was killed end a moment after it; until then the folder is theirs.
  void wait_for_lock(const std::string &results) const {
    const int lock = ::open((folder_ / results + "/.lock").c_str(), O_RDWR);
    if (lock < 0) return;
    ::flock(lock, LOCK_EX);
    ::close(lock);
  }

  const Folder folder_;
};

/// The first snapshots value by value, and the rows of history.csv and of a followed line up to them character by
/// character. Each event is there once, in order, but for those that tell that the run goes on.
const char *comparison = R"(
import csv, h5py, json, numpy
runs = [h5py.File(name + '/run.h5')['snapshots'] for name in ('whole', 'resumed')]
for number in [f'{k:06d}' for k in range(24)]:
    a, b = (run[number] for run in runs)
    assert a.attrs['step'] == b.attrs['step'] and a.attrs['time'] == b.attrs['time'], number
    assert a.keys() == b.keys()
    for field in a: assert numpy.array_equal(a[field][...], b[field][...], equal_nan=True), f'{number} {field}'
end = runs[0]['000023'].attrs['time']
for file in ('history.csv', 'line_down.csv'):
    rows = [[line for line in open(f'{name}/{file}')] for name in ('whole', 'resumed')]
    kept = [[line for line in some[1:] if float(line.split(',')[0]) <= end] for some in rows]
    assert kept[0] == kept[1] and len(kept[0]) > 15, file
columns = [row['column'] for row in csv.DictReader(open('resumed/history_columns.csv'))]
assert ['time_s', 'step', 'stage'] + columns == next(csv.reader(open('resumed/history.csv'))), columns
events = [[json.loads(line) for line in open(name + '/events.jsonl')] for name in ('whole', 'resumed')]
resumed = sum(event['kind'] == 'resumed' for event in events[1])
assert resumed <= TIMES, f'resumed {resumed} times'  # a run may be ended before it goes on
events = [[event for event in some if event['time_s'] <= end and event['kind'] not in ('resumed', 'ranks')] for some in events]
assert events[0] == events[1], f'{events[0]} {events[1]}'
assert [event['kind'] for event in events[0]].count('body') == 1 and [event['kind'] for event in events[0]].count('reset') == 1
print('the same')
)";

TEST_P(Resumed, IsTheSameToTheBit) {
  run_until("whole", "000024", SIGINT, false);
  for (bool resume = false; const char *snapshot : GetParam().until)
    run_until("resumed", snapshot, GetParam().signal, resume), resume = true;
  run_until("resumed", "000024", SIGINT, true);
  const std::string script = "TIMES = " + std::to_string(GetParam().until.size()) + comparison;
  const Ending ending = Program(folder_, {PYTHON, "-c", script}).end();
  EXPECT_TRUE(ending.says("the same")) << ending.output;
}

INSTANTIATE_TEST_SUITE_P(All, Resumed, testing::ValuesIn(variants),
                         [](const auto &variant) { return variant.param.name; });

/// A run that changes its number of ranks when it is resumed.
struct Change {
  const char *name;
  std::vector<std::string> set;
  int before = 1, after = 1;
};

void PrintTo(const Change &change, std::ostream *out) { *out << change.name; }

const Change changes[] = {
    {"dry_2_to_1", {}, 2, 1},
    {"dry_1_to_4", {}, 1, 4},
    {"dry_4_to_2", {}, 4, 2},
    {"heated_base_2_to_1", heated_base, 2, 1},
    {"heated_base_1_to_4", heated_base, 1, 4},
    {"particle_stress_4_to_2", {"transfer.average_stress=false", "transfer.locking=nodal"}, 4, 2},
    {"undrained_4_to_2", {"body.sand.drainage=undrained"}, 4, 2},
    {"drained_1_to_4", {"phases=drained", "water.table=[[0, 0.3], [2, 0.1]]", "water.excess=100 * t"}, 1, 4},
    {"unsaturated_2_to_1",
     with_pores({"phases=unsaturated", "boundary.rain.kind=rainfall", "boundary.rain.group=free_surface",
                 "boundary.rain.intensity=0.01"}),
     2, 1},
    {"three_phase_4_to_2", with_pores({"phases=three-phase"}), 4, 2},
    {"by_arkode_1_to_2", {"integrator.kind=arkode"}, 1, 2},
    {"by_the_frequency_of_the_mesh_2_to_1", {"integrator.omega_max=mesh"}, 2, 1},
    {"averaged_strain_1_to_4", {"body.sand.averaging_length=0.3"}, 1, 4},
    {"balanced_4_to_2", {"mesh.balance_ranks=always"}, 4, 2},
    {"halved_cells_4_to_2", {"mesh.size=0.2", "mesh.halvings=1"}, 4, 2},
    {"halved_cells_1_to_2", {"mesh.size=0.4", "mesh.halvings=2"}, 1, 2},
};

class ResumedOnOtherRanks : public testing::TestWithParam<Change> {};

/// Ends in the middle of a Lagrangian part and goes on on other ranks, or on the same: the answers differ by round-off,
/// which some hundred steps leave below 1e-9 of each field's largest value. What goes on on the same ranks is the run
/// without an interruption, to the bit (above). The floor of 1e-14 is for strains that are nothing but round-off.
TEST_P(ResumedOnOtherRanks, IsTheSameButForRoundOff) {
  const Change &change = GetParam();
  const Folder folder;
  folder.write("section.csv", good_section), folder.write("scene.toml", falling_scene);
  const auto run = [&](const std::string &results, const std::string &duration, bool resume, int ranks) {
    std::vector<std::string> words{
        "run", "scene.toml", "-o", results, "--no-pictures", "--set", "stage.1.duration=" + duration};
    for (const std::string &key : change.set) words.insert(words.end(), {"--set", key});
    if (resume) words.push_back("--resume");
    const Ending ending = talus(folder, words, ranks);
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending.output;
  };
  run("whole", "0.0231", false, change.before);
  std::filesystem::copy(folder / "whole", folder / "resumed", std::filesystem::copy_options::recursive);
  run("whole", "0.05", true, change.before);
  const std::string output = run("resumed", "0.05", true, change.after);
  EXPECT_NE(output.find("before it ran on " + std::to_string(change.before)), std::string::npos) << output;
  const Ending ending = Program(folder, {PYTHON, "-c", R"(
import csv, h5py, numpy
ends = [max(h5py.File(name + '/run.h5')['snapshots'].values(), key=lambda s: s.attrs['time']) for name in ('whole', 'resumed')]
order = [numpy.argsort(end['id'][...], kind='stable') for end in ends]
assert numpy.array_equal(*(end['id'][...][k] for end, k in zip(ends, order))), 'ids'
for field in ends[0]:
    a, b = (end[field][...][k] for end, k in zip(ends, order))
    if field == 'mass': assert numpy.array_equal(a, b), field
    if a.dtype.kind == 'f':
        scale = numpy.nanmax(numpy.abs(a)) or 1
        assert numpy.nanmax(numpy.abs(a - b)) <= 1e-9 * scale + 1e-14, (field, numpy.nanmax(numpy.abs(a - b)) / scale)
last = [list(csv.reader(open(name + '/history.csv')))[-1] for name in ('whole', 'resumed')]
rows = [list(csv.reader(open(name + '/history.csv'))) for name in ('whole', 'resumed')]
for k, name in enumerate(rows[0][0]):
    if name in ('stage', 'step'): continue
    scale = max(abs(float(row[k])) for row in rows[0][1:]) or 1
    a, b = float(last[0][k]), float(last[1][k])
    assert abs(a - b) <= 1e-7 * scale + 1e-9 or a != a and b != b, (name, a, b)
print('the same')
)"})
                            .end();
  EXPECT_TRUE(ending.says("the same")) << ending.output;
}

INSTANTIATE_TEST_SUITE_P(All, ResumedOnOtherRanks, testing::ValuesIn(changes),
                         [](const auto &change) { return change.param.name; });

/// Pressures that seepage has found are there again when a drained run goes on behind it, whatever has become of the
/// file that shows them.
TEST(ResumedBehindSeepage, KnowsItsPressures) {
  const Folder folder;
  folder.write("section.csv", good_section);
  folder.write("scene.toml",
               changed(changed(changed(changed(good_scene, "density = 2000",
                                               "porosity = 0.3\ngrain_density = 2650\npermeability = 1e-10"),
                                       "gravity", "phases = \"drained\"\ngravity"),
                               "[body.sand]", "[water]\ntable = [[0, 0.1]]\n[body.sand]"),
                       "[[stage]]",
                       "[boundary.well]\ngroup = \"left\"\nkind = \"pore_pressure\"\npressure = \"3 kPa\"\n"
                       "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n[[stage]]"));
  const auto run = [&](const std::string &results, const std::string &duration, bool resume) {
    std::vector<std::string> words{
        "run", "scene.toml", "-o", results, "--no-pictures", "--set", "stage.1.duration=" + duration};
    if (resume) words.push_back("--resume");
    const Ending ending = talus(folder, words);
    EXPECT_EQ(ending.status, 0) << ending.output;
  };
  run("whole", "0.02", false), run("resumed", "0.01", false);
  folder.write("resumed/pore_pressure.csv", "damaged");
  run("resumed", "0.02", true);
  const Ending ending = Program(folder, {PYTHON, "-c", R"(
import h5py, numpy
ends = [max(h5py.File(name + '/run.h5')['snapshots'].values(), key=lambda s: s.attrs['time']) for name in ('whole', 'resumed')]
for field in ends[0]: assert numpy.array_equal(ends[0][field][...], ends[1][field][...]), field
assert ends[0]['pore_pressure'][...].max() > 2e3
assert open('whole/pore_pressure.csv').read() == open('resumed/pore_pressure.csv').read()
print('the same')
)"})
                            .end();
  EXPECT_TRUE(ending.says("the same")) << ending.output;
}

/// Stages one after another; the run is ended behind each of them, and resumed with the others.
struct Chain {
  const char *name;
  std::vector<std::string> set, stages;
  int ranks = 1;
};

void PrintTo(const Chain &chain, std::ostream *out) { *out << chain.name; }

std::string stage(const std::string &name, const std::string &kind, const std::string &more) {
  return "[[stage]]\nname = \"" + name + "\"\nkind = \"" + kind + "\"\n" + more;
}

/// Sand that softens, with water that comes in from the left.
const std::string wet_scene =
    changed(changed(changed(good_scene, "density = 2000", "porosity = 0.3\ngrain_density = 2650\npermeability = 1e-12"),
                    "cohesion = 0\nfriction_angle = 30",
                    "cohesion = \"3 kPa\"\nresidual_cohesion = \"2 kPa\"\nshape_factor = 50\nfriction_angle = 20"),
            "[[stage]]\nname = \"fall\"\nduration = 0.05\n",
            "[boundary.well]\ngroup = \"left\"\nkind = \"pore_pressure\"\npressure = \"1e3 + 20 * t\"\n"
            "[water]\ntable = [[0, 0.1]]\n");

const Chain chains[] = {
    {"of_seepage_and_equilibrium",
     {"phases=drained", "boundary.base.kind=friction", "boundary.base.friction_angle=25", "boundary.base.adhesion=1e3"},
     {stage("wet", "seepage", "duration = 40\n"), stage("stands", "quasi_static", "duration = 1\nload_steps = 2\n"),
      stage("wetter", "seepage", "duration = 40\n"),
      stage("stands_still", "quasi_static", "duration = 1\nreset_displacement = true\n"),
      stage("moves", "dynamic", "duration = 0.02\n"), stage("wettest", "seepage", "duration = 40\n"),
      stage("rests", "quasi_static", "duration = 1\n")}},
    {"of_consolidated_strength",
     {"phases=drained", "boundary.well={group='left', kind='traction', pressure=0}", "body.sand.drainage=undrained",
      "body.sand.drained_in=stands", "body.sand.shansep={stage='stands', ratio=2, minimum=8e3}"},
     {stage("stands", "quasi_static", "duration = 1\ninitial_stress = \"k0\"\n"),
      stage("stands_still", "quasi_static", "duration = 1\n"), stage("moves", "dynamic", "duration = 0.01\n"),
      stage("rests", "quasi_static", "duration = 1\n")}},
    {"of_consolidation_on_two_ranks",
     {"phases=saturated", "water.bulk_modulus=1e7"},
     {stage("weight", "consolidation", "duration = 4\ninitial_stress = \"k0\"\n"),
      stage("more", "consolidation", "duration = 4\n"), stage("moves", "dynamic", "duration = 0.01\n"),
      stage("rests", "consolidation", "duration = 2\n")},
     2},
};

class ResumedBehindElements : public testing::TestWithParam<Chain> {};

TEST_P(ResumedBehindElements, IsTheSameToTheBit) {
  const Chain &chain = GetParam();
  const Folder folder;
  folder.write("section.csv", good_section);
  const auto run = [&](const std::string &results, size_t stages, bool resume) {
    std::string text = wet_scene;
    for (size_t k = 0; k < stages; ++k) text += chain.stages[k];
    folder.write("scene.toml", text);
    std::vector<std::string> words{"run", "scene.toml", "-o", results, "--no-pictures"};
    for (const std::string &key : chain.set) words.insert(words.end(), {"--set", key});
    if (resume) words.push_back("--resume");
    const Ending ending = talus(folder, words, chain.ranks);
    EXPECT_EQ(ending.status, 0) << ending.output;
  };
  run("whole", chain.stages.size(), false);
  for (size_t ended = 1; ended < chain.stages.size(); ++ended) {
    run("resumed", ended, false);
    run("resumed", chain.stages.size(), true);
    const Ending ending = Program(folder, {PYTHON, "-c", R"(
import csv, h5py, numpy
ends = [max(h5py.File(name + '/run.h5')['snapshots'].values(), key=lambda s: s.attrs['time']) for name in ('whole', 'resumed')]
for field in ends[0]: assert numpy.array_equal(ends[0][field][...], ends[1][field][...], equal_nan=True), field
rows = [list(csv.reader(open(name + '/history.csv'))) for name in ('whole', 'resumed')]
assert rows[0] == rows[1], [(name, a, b) for rest in zip(*rows) for name, a, b in zip(rows[0][0], *rest) if a != b][:9]
print('the same')
)"})
                              .end();
    EXPECT_TRUE(ending.says("the same")) << "behind stage " << ended << ": " << ending.output;
    std::filesystem::remove_all(folder / "resumed");
  }
}

INSTANTIATE_TEST_SUITE_P(All, ResumedBehindElements, testing::ValuesIn(chains),
                         [](const auto &chain) { return chain.param.name; });

class ResumedBehindElementsOnOtherRanks : public testing::TestWithParam<Chain> {};

/// Behind its stages by finite elements a run goes on on other ranks. The ranks' sums are in another order, which was
/// measured to change no field by more than 3e-15 of its largest value; the floor of 1e-14 is that of strains above.
TEST_P(ResumedBehindElementsOnOtherRanks, IsTheSameButForRoundOff) {
  const Chain &chain = GetParam();
  const Folder folder;
  folder.write("section.csv", good_section);
  const auto run = [&](const std::string &results, size_t stages, bool resume, int ranks) {
    std::string text = wet_scene;
    for (size_t k = 0; k < stages; ++k) text += chain.stages[k];
    folder.write("scene.toml", text);
    std::vector<std::string> words{"run", "scene.toml", "-o", results, "--no-pictures"};
    for (const std::string &key : chain.set) words.insert(words.end(), {"--set", key});
    if (resume) words.push_back("--resume");
    const Ending ending = talus(folder, words, ranks);
    EXPECT_EQ(ending.status, 0) << ending.output;
  };
  const size_t ended = chain.stages.size() / 2;
  run("whole", chain.stages.size(), false, chain.ranks);
  run("resumed", ended, false, chain.ranks);
  run("resumed", chain.stages.size(), true, chain.ranks == 1 ? 4 : 1);
  const Ending ending = Program(folder, {PYTHON, "-c", R"(
import h5py, numpy
ends = [max(h5py.File(name + '/run.h5')['snapshots'].values(), key=lambda s: s.attrs['time']) for name in ('whole', 'resumed')]
order = [numpy.argsort(end['id'][...], kind='stable') for end in ends]
for field in ends[0]:
    a, b = (end[field][...][k] for end, k in zip(ends, order))
    if numpy.isnan(a).all() and numpy.isnan(b).all(): continue
    apart = numpy.nanmax(numpy.abs(a - b) - 1e-14) / (numpy.nanmax(numpy.abs(a)) or 1)
    assert apart <= 1e-11, (field, apart)
print('the same')
)"})
                            .end();
  EXPECT_TRUE(ending.says("the same")) << ending.output;
}

INSTANTIATE_TEST_SUITE_P(All, ResumedBehindElementsOnOtherRanks, testing::ValuesIn(chains),
                         [](const auto &chain) { return chain.param.name; });

/// Where the cut between two ranks runs along the ground, a rank has nodes that only cells of the other one fill with
/// soil, and rows of them in the checkpoint. In cells of this size it does.
TEST(ResumedBehindElements, OnRanksThatShareNodesOfEmptyCells) {
  const Folder folder;
  folder.write("slope.csv",
               "part,x,y\noutline,0,0\noutline,40,0\noutline,40,14\noutline,0,14\ninterface0,0,12\n"
               "interface0,14,12\ninterface0,24,4\ninterface0,40,4\nregion_air,35,10\nregion_soil,5,3\n");
  const std::string scene =
      "dimension = 2\ngravity = 9.81\n[mesh]\nsection = \"slope.csv\"\nsize = 0.6\n[body.soil]\nregion = \"soil\"\n"
      "density = 1800\nlaw = \"linear_elastic\"\nyoung_modulus = \"20 MPa\"\npoisson_ratio = 0.44\n"
      "[boundary.base]\nkind = \"fixed\"\n[boundary.left]\nkind = \"roller\"\n[boundary.right]\nkind = \"roller\"\n"
      "[quasi_static]\nelements = \"patches\"\n" +
      stage("gravity", "quasi_static", "duration = 1\nhold_loads = true\n");
  const auto run = [&](const std::string &text, int ranks) {
    folder.write("scene.toml", text);
    std::vector<std::string> words{"run", "scene.toml", "-o", "results", "--no-pictures"};
    if (ranks > 1) words.push_back("--resume");
    const Ending ending = talus(folder, words, ranks);
    EXPECT_EQ(ending.status, 0) << ending.output;
  };
  run(scene, 1);
  run(scene + stage("moves", "dynamic", "duration = 0.01\n"), 2);
}

}  // namespace
}  // namespace talus
