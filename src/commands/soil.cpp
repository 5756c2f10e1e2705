#include <petscsys.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "commands/commands.h"
#include "commands/gallery.h"
#include "output/pictures.h"
#include "physics/laws/element_test.h"
#include "scene/body_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/words.h"

namespace talus {
namespace {

struct SoilArguments {
  std::string file, body, directory;
  std::vector<std::string> set;
  bool no_pictures = false;
};

/// What is tested, how, and what it is called.
struct Job {
  std::string title;
  Law law;
  std::vector<ElementTest> tests;
};

/// Tests of a scene's soil: only --set gives them.
struct ScenesTests {
  std::vector<ElementTest> test;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.named("test", test, "tests of the soil");
  }
};

/// The tests have pore water of their own.
Law drained(const DeferredTable &table) { return read_law(table).drained_as(Law()); }

Job from_scene(const std::string &file, const SoilArguments &arguments) {
  std::vector<std::string> of_scene, of_tests;
  for (const std::string &one : arguments.set) (one.starts_with("test.") ? of_tests : of_scene).push_back(one);
  const Scene scene = read_scene(file, of_scene);
  std::vector<std::string> names;
  for (const BodySource &body : scene.body) names.push_back(body.name);
  if (arguments.body.empty() && names.size() > 1)
    throw SceneError(file + " has several soils: choose one by --body, of " + join(names));
  const std::string wanted = arguments.body.empty() ? names[0] : arguments.body;
  const auto at = std::find(names.begin(), names.end(), wanted);
  if (at == names.end())
    throw SceneError("--body " + wanted + " is no soil of " + file + "; " + suggestion(wanted, names));
  ScenesTests tests;
  TableReader::from_text("", "--set", of_tests).fill(tests);
  if (tests.test.empty()) tests.test.emplace_back().name = "triaxial_compression";
  return {scene.title + ": " + wanted, drained(scene.body[at - names.begin()].law), tests.test};
}

Job from_soil_file(const TableReader &root, const SoilArguments &arguments) {
  if (!arguments.body.empty())
    throw SceneError("--body chooses a soil of a scene; " + arguments.file + " has one [material]");
  SoilFile soil;
  TableReader(root).fill(soil);
  if (!root.has("material"))
    root.complain("material", "is missing: add a table [material] with law and its parameters");
  if (soil.test.empty()) root.complain("test", "is missing: add a table [test.NAME] with its type");
  return {soil.title, drained(soil.material.law), soil.test};
}

/// Law by law the same columns, then what the law remembers. Pressures and q are positive in compression, strain and
/// stress in tension.
void write_csv(const std::string &path, const Job &job, const ElementTest &test,
               const std::vector<ElementState> &states) {
  std::ofstream csv(path);
  csv << "step";
  for (const char *name : Control::strain_keys) csv << ',' << name;
  for (const char *name : Control::stress_keys) csv << ',' << name << "_Pa";
  csv << ",pore_pressure_Pa,mean_pressure_Pa,deviator_Pa,compression,void_ratio,suction_Pa,time_s";
  const auto fields = history_fields(job.law);
  for (const HistoryField &field : fields)
    if (!field.of_tensor) csv << ',' << field.name;
  csv << '\n';
  csv.precision(12);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const ElementState &s = states[k];
    csv << k;
    for (double e : s.strain) csv << ',' << e;
    for (double component : s.stress) csv << ',' << component;
    csv << ',' << s.pore_pressure << ',' << s.mean_pressure() << ',' << s.deviator() << ',' << s.compression() << ',';
    if (test.void_ratio > 0) csv << (1 + test.void_ratio) * std::exp(-s.compression()) - 1;
    csv << ',' << s.suction << ',' << s.time;
    for (std::size_t h = 0; h < fields.size(); ++h)
      if (!fields[h].of_tensor) csv << ',' << s.history[h];
    csv << '\n';
  }
  csv.close();
  if (!csv) throw std::runtime_error("cannot write " + path);
}

void summarise(const ElementTest &test, const std::vector<ElementState> &states) {
  const ElementState *peak = &states[0];
  for (const ElementState &s : states)
    if (s.deviator() > peak->deviator()) peak = &s;
  const ElementState &end = states.back();
  std::printf("%-24s %10.4g %10.4g %10.4g %10.4g %10.4g %10.4g\n", test.name.c_str(), peak->deviator() / 1e3,
              peak->mean_pressure() / 1e3, end.deviator() / 1e3, end.mean_pressure() / 1e3, end.pore_pressure / 1e3,
              100 * end.compression());
}

int test_soil(const SoilArguments &arguments) {
  const std::string file = find_scene(arguments.file);
  const TableReader root = TableReader::from_file(file, arguments.set);
  const Job job = root.has("body") ? from_scene(file, arguments) : from_soil_file(root, arguments);
  const std::string name = short_name(file);
  const std::string dir = arguments.directory.empty() ? "results/soil-" + name : arguments.directory;
  const std::string problem = law_problem(job.law, 3);
  if (!problem.empty()) throw SceneError(file + ": the law cannot be used: " + problem);
  for (const ElementTest &test : job.tests) refuse_unsuitable(job.law, test);
  std::filesystem::create_directories(dir);

  std::printf("%s (%s)\n%-24s %10s %10s %10s %10s %10s %10s\n", job.title.c_str(), law_name(job.law), "test",
              "peak q kPa", "at p' kPa", "end q kPa", "p' kPa", "u kPa", "-eps_v %");
  std::vector<std::string> names;
  for (const ElementTest &test : job.tests) {
    const std::vector<ElementState> states = drive(job.law, test);
    summarise(test, states);
    write_csv(dir + "/" + test.name + ".csv", job, test, states);
    names.push_back(test.name);
  }
  const bool drawn = !arguments.no_pictures && draw_element_tests(dir, names, job.title);
  std::printf("results are in %s: %sone CSV file per test\n", dir.c_str(), drawn ? "soil.png, " : "");
  return drawn || arguments.no_pictures ? 0 : 1;
}

}  // namespace

Action add_soil(CLI::App &app) {
  auto arguments = std::make_shared<SoilArguments>();
  CLI::App *command = app.add_subcommand(
      "soil", "run element tests of a soil: triaxial, biaxial, oedometer, shear; write CSV files and a plot");
  command->add_option("FILE", arguments->file, "file with [material] and [test.NAME], or a scene")->required();
  command->add_option("--body", arguments->body, "soil of the scene");
  command->add_option("-o,--output", arguments->directory, "folder of the results (default results/soil-NAME)");
  command
      ->add_option("--set", arguments->set,
                   "override a key: material.cohesion=5e3; test.NAME.type=oedometer adds a test")
      ->take_all();
  command->add_flag("--no-pictures", arguments->no_pictures, "do not draw the plot");
  return [arguments] {
    int rank;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    return rank ? 0 : test_soil(*arguments);
  };
}

}  // namespace talus
