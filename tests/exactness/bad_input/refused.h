#pragma once
/// Tables of bad input in the folder refused/: what is changed in a sound scene, section or mesh, and what the
/// complaint has to say. README.md there describes their form.
#include <gtest/gtest.h>

#include <cctype>

#include "scene.h"

namespace talus {

/// One fault: what is changed in which file, and what the complaint has to say.
struct Fault {
  std::string name;
  std::string base = "dry";         ///< the sound scene: see `sound_scene`
  std::string file = "scene.toml";  ///< the file that is changed, or "section.csv" or "mesh.msh"
  std::string from, to;             ///< without `from`, `to` is added at the end
  std::vector<std::string> words;
  int ranks = 1;
};

inline void PrintTo(const Fault &fault, std::ostream *out) { *out << fault.name; }

/// Sound scenes by name. `dry`: a block of sand; `drained`, `saturated`, `unsaturated`, `three-phase`: the same with
/// pore water; `still`: its equilibrium by finite elements; `mesh`: two triangles of sand from a file; `solid`: in 3D.
inline std::string sound_scene(const std::string &base) {
  constexpr const char *section = "section = \"section.csv\"\nsize = 0.25\n";
  if (base == "dry") return good_scene;
  if (base == "still") return changed(good_scene, "name = \"fall\"", "name = \"fall\"\nkind = \"quasi_static\"");
  if (base == "mesh")
    return changed(changed(good_scene, section, "file = \"mesh.msh\"\n\n"), "[boundary.left]\nkind = \"roller\"\n", "");
  if (base == "solid")
    return changed(good_scene, "gravity = 9.81", "gravity = 9.81\ndimension = 3") +
           "[boundary.front]\nkind = \"roller\"\n[boundary.back]\nkind = \"roller\"\n";
  const std::string wet = changed(changed(good_scene, "gravity", "phases = \"" + base + "\"\ngravity"),
                                  "density = 2000", "porosity = 0.4\ngrain_density = 2600\npermeability = 1e-10") +
                          "[water]\ntable = [[0, 0.5], [2, 0.5]]\n";
  if (base == "drained" || base == "saturated") return wet;
  if (base == "unsaturated" || base == "three-phase")
    return wet +
           "[body.sand.retention]\ncurve = \"van_genuchten\"\nreference_suction = 5e3\nshape = 0.5\n"
           "[body.sand.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.5\n";
  throw std::logic_error("no sound scene is called " + base);
}

/// Reads a table of faults. Throws std::logic_error with file and line where it is not in its form.
inline std::vector<Fault> read_faults(const std::string &file) {
  std::ifstream in(file);
  std::vector<Fault> faults;
  std::string line;
  bool has_from = false, has_to = false;
  const auto append = [](std::string &text, bool &has_some, const std::string &one) {
    text += (has_some ? "\n" : "") + one;
    has_some = true;
  };
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    const std::string rest = line.size() > 2 ? line.substr(2) : "";
    if (line[0] == '=') {
      faults.emplace_back().name = rest;
      has_from = has_to = false;
    } else if (faults.empty()) {
      throw std::logic_error(file + " line " + std::to_string(number) + ": a fault begins with `= NAME`");
    } else if (line[0] == '@') {
      Fault &fault = faults.back();
      if (rest.find(" ranks") != std::string::npos)
        fault.ranks = std::stoi(rest);
      else if (rest.find('.') != std::string::npos)
        fault.file = rest;
      else
        fault.base = rest;
    } else if (line[0] == '-') {
      append(faults.back().from, has_from, rest);
    } else if (line[0] == '+') {
      append(faults.back().to, has_to, rest);
    } else if (line[0] == '?') {
      faults.back().words.push_back(rest);
    } else {
      throw std::logic_error(file + " line " + std::to_string(number) + ": a line begins with =, @, -, +, ? or #");
    }
  }
  for (Fault &fault : faults) {
    if (fault.words.empty()) throw std::logic_error(file + ": " + fault.name + " expects no words");
    if (fault.file == "mesh.msh") fault.base = "mesh";
  }
  if (faults.empty()) throw std::logic_error(file + " has no faults");
  return faults;
}

/// The fault in a folder: the commands refuse it with status 2 and one message that has these words, and nothing is
/// written.
inline void expect_refused(const Fault &fault, const std::vector<std::string> &commands) {
  std::string scene = sound_scene(fault.base), section = good_section, mesh = good_mesh;
  std::string &spoilt = fault.file == "mesh.msh" ? mesh : fault.file == "section.csv" ? section : scene;
  spoilt = fault.from.empty() ? spoilt + fault.to + "\n" : changed(spoilt, fault.from, fault.to);
  const Folder folder;
  folder.write("scene.toml", scene), folder.write("section.csv", section), folder.write("mesh.msh", mesh);
  for (const std::string &command : commands) {
    std::vector<std::string> line{command, "scene.toml"};
    if (command == "run") line.insert(line.end(), {"-o", "results", "--no-pictures"});
    const Ending ending = talus(folder, line, fault.ranks);
    EXPECT_EQ(ending.status, 2);
    for (const std::string &words : fault.words) EXPECT_TRUE(ending.says(words)) << words;
    EXPECT_EQ(ending.count("talus: "), 1) << "one message";
    EXPECT_FALSE(ending.says("PETSC ERROR"));
    EXPECT_FALSE(std::filesystem::exists(folder / "results"));
    if (testing::Test::HasFailure()) ADD_FAILURE() << command << ": " << ending.output;
  }
}

/// The faults of a table as tests, each by its name: TALUS_REFUSES(Table, file, commands).
#define TALUS_REFUSES(Table, file, ...)                                                    \
  class Table : public testing::TestWithParam<Fault> {};                                   \
  TEST_P(Table, AreRefused) { expect_refused(GetParam(), {__VA_ARGS__}); }                 \
  INSTANTIATE_TEST_SUITE_P(All, Table, testing::ValuesIn(read_faults(TALUS_REFUSED file)), \
                           [](const auto &fault) { return fault.param.name; })

}  // namespace talus
