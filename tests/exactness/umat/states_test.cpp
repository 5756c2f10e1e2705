// A UMAT with forty state variables: each goes through remaps, results, checkpoints and a resume as the first one does.
#include <gtest/gtest.h>

#include "bad_input/program.h"
#include "bad_input/scene.h"

namespace talus {
namespace {

/// Variables of the same component of strain are multiples of one another, in each snapshot, to the round-off of sums
/// over the steps; and the resumed run is the other one to the last bit.
const char *comparison = R"(
import h5py, numpy
runs = [h5py.File(name + '/run.h5')['snapshots'] for name in ('whole', 'resumed')]
assert list(runs[0]) == list(runs[1]) and len(runs[0]) > 5
for number in runs[0]:
    a, b = (run[number] for run in runs)
    assert a.keys() == b.keys()
    for field in a: assert numpy.array_equal(a[field][...], b[field][...]), f'{number} {field}'
end = runs[0][max(runs[0])]
states = [end['first' if k == 0 else f'state_{k + 1}'][:, 0] for k in range(40)]
assert 'state_41' not in end
for k in range(3):
    assert numpy.ptp(states[k]) > 1e-6, 'strain differs from place to place'
for k in range(40):
    base = states[k % 3] / (k % 3 + 1)
    assert numpy.abs(states[k] / (k + 1) - base).max() < 1e-12 * numpy.abs(base).max(), f'state {k + 1}'
rows = [open(name + '/history.csv').read() for name in ('whole', 'resumed')]
assert rows[0] == rows[1]
print('forty ok')
)";

class ManyStates : public testing::TestWithParam<std::tuple<int, bool>> {};

TEST_P(ManyStates, are_written_and_resumed_as_one_is) {
  const auto &[ranks, averaged] = GetParam();
  const Folder folder;
  const std::string law =
                        "law = \"mohr_coulomb\"\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.3\ncohesion = 0\n"
                        "friction_angle = 30\n",
                    umat = "law = \"umat\"\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.3\nlibrary = \"" UMATS
                           "/umat_many_states.so\"\nprops = [\"1 MPa\", 0.3]\nnstatv = 40\nstate = [\"first\"]\n";
  std::string scene =
      changed(changed(good_scene, law, umat), "density = 2000", "density = 2000\nvelocity = [\"3\", \"0\"]");
  if (!averaged) scene += "[transfer]\naverage_stress = false\nlocking = \"nodal\"\n";
  folder.write("section.csv", good_section);
  folder.write("first.toml", scene);
  folder.write("both.toml", changed(scene, "[output]", "[[stage]]\nduration = 0.05\n[output]"));
  const auto run = [&](const std::string &name, const std::string &results, const std::vector<std::string> &more) {
    std::vector<std::string> words{"run", name, "-o", results, "--no-pictures"};
    words.insert(words.end(), more.begin(), more.end());
    const Ending ending = talus(folder, words, ranks);
    ASSERT_EQ(ending.status, 0) << ending.output;
  };
  run("both.toml", "whole", {}), run("first.toml", "resumed", {}), run("both.toml", "resumed", {"--resume"});
  const Ending read = Program(folder, {PYTHON, "-c", comparison}).end();
  EXPECT_TRUE(read.says("forty ok")) << read.output;
}

INSTANTIATE_TEST_SUITE_P(UmatStates, ManyStates, testing::Combine(testing::Values(1, 2), testing::Bool()));

}  // namespace
}  // namespace talus
