/// The program talus-verify. `talus verify` starts it with the same words.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "output/script.h"
#include "program.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/words.h"
#include "tests/verify/case_page.h"
#include "tests/verify/rungs.h"

namespace talus {
namespace {

struct VerifyArguments {
  std::vector<std::string> cases, only;
  bool json = false, list = false, longer = false, gallery = false, pages = false, write = false;
};

struct Outcome {
  const LadderEntry *entry;
  std::string page;  ///< README.md beside the scene
  std::vector<Checked> quantities;
  std::string error;  ///< why it ended before its last quantity

  bool holds() const {
    return error.empty() && std::all_of(quantities.begin(), quantities.end(), [](const auto &q) { return q.holds(); });
  }
};

std::string scene_of(const LadderEntry &entry) {
  return std::string(TALUS_LADDER "/") + entry.label + "/" + entry.name + "/scene.toml";
}

std::vector<const LadderEntry *> choose(const std::vector<std::string> &names) {
  std::vector<const LadderEntry *> chosen;
  std::vector<std::string> known;
  for (const LadderEntry &entry : ladder) known.emplace_back(entry.name);
  for (const std::string &name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) throw SceneError("there is no case " + name + "; " + suggestion(name, known));
    chosen.push_back(&ladder[found - known.begin()]);
  }
  if (names.empty())
    for (const LadderEntry &entry : ladder) chosen.push_back(&entry);
  return chosen;
}

Outcome climb(const LadderEntry &entry, bool longer) {
  const std::string scene = scene_of(entry);
  Rung rung(scene, longer);
  Outcome outcome{&entry, std::filesystem::path(scene).replace_filename("README.md"), {}, ""};
  try {
    entry.check(rung);
  } catch (const RunError &error) {
    outcome.error = error.what();
  }
  outcome.quantities = rung.quantities();
  return outcome;
}

void print_header() {
  std::printf("%-22s %-52s %13s %13s %9s %9s %8s\n", "case", "quantity", "exact", "computed", "error", "tolerance",
              "wall s");
}

void print(const Outcome &outcome) {
  for (const Checked &q : outcome.quantities) {
    const bool claimed = std::isfinite(q.tolerance);
    std::printf("%-22s %-52s %13.6g %13.6g %9.2e ", outcome.entry->name, q.name.c_str(), q.exact, q.computed,
                q.relative_error);
    claimed ? std::printf("%9.2e", q.tolerance) : std::printf("%9s", "-");
    std::printf(" %8.2f  %s\n", q.wall_seconds, !claimed ? "reported" : q.holds() ? "pass" : "FAIL");
  }
  if (!outcome.error.empty()) std::printf("%-22s FAIL: %s\n", outcome.entry->name, outcome.error.c_str());
  std::fflush(stdout);
}

/// Claims only. A case that broke off has a last entry without numbers.
void print_json(const std::vector<Outcome> &outcomes) {
  nlohmann::ordered_json cases = nlohmann::ordered_json::array();
  const auto put = [&](const std::string &name, const Checked &q) {
    cases.push_back({{"name", name},
                     {"quantity", q.name},
                     {"exact", q.exact},
                     {"computed", q.computed},
                     {"relative_error", q.relative_error},
                     {"tolerance", q.tolerance},
                     {"wall_seconds", q.wall_seconds}});
  };
  for (const Outcome &outcome : outcomes) {
    for (const Checked &q : outcome.quantities)
      if (std::isfinite(q.tolerance)) put(outcome.entry->name, q);
    if (!outcome.error.empty()) put(outcome.entry->name, {"completed", 1, 0, 1, 0, NAN});
  }
  std::printf("%s\n", nlohmann::ordered_json{{"cases", cases}}.dump(1).c_str());
}

/// Writes the table of the case's page, or says what of it is not what was computed; true if the page is in step.
bool put_in_step(const Outcome &outcome, const VerifyArguments &arguments) {
  if (arguments.write) {
    write_case_page(outcome.page, arguments.longer, outcome.quantities);
    return true;
  }
  const std::string difference = difference_from_page(outcome.page, arguments.longer, outcome.quantities);
  if (!difference.empty())
    std::fprintf(stderr, "talus: %s: %s; `./talus verify %s%s --write` makes its table anew\n", outcome.page.c_str(),
                 difference.c_str(), outcome.entry->name, arguments.longer ? " --long" : "");
  return difference.empty();
}

/// The numbers of the gallery: a script reruns the scenes behind them and compares.
int verify_gallery(const VerifyArguments &arguments) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  std::vector<std::string> words{TALUS_GALLERY, program.parent_path() / "talus"};
  words.insert(words.end(), arguments.cases.begin(), arguments.cases.end());
  if (arguments.longer) words.push_back("--long");
  if (arguments.write) words.push_back("--write");
  if (arguments.pages) words.push_back("--pages");
  if (arguments.list) words.push_back("--list");
  for (const std::string &name : arguments.only) words.insert(words.end(), {"--only", name});
  return run_script(PAGE_NUMBERS, words);
}

int verify(const VerifyArguments &arguments) {
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (arguments.gallery) return rank == 0 ? verify_gallery(arguments) : 0;
  const auto chosen = choose(arguments.cases);
  if (arguments.list) {
    if (rank == 0)
      for (const LadderEntry *entry : chosen)
        std::printf("%-22s %-12s %s\n", entry->name, entry->label, entry->meaning);
    return 0;
  }
  const bool table = rank == 0 && !arguments.json;
  std::vector<Outcome> outcomes;
  if (table) print_header();
  for (const LadderEntry *entry : chosen) {
    outcomes.push_back(climb(*entry, arguments.longer));
    if (table) print(outcomes.back());
    if (rank == 0 && arguments.json && !outcomes.back().error.empty())
      std::fprintf(stderr, "talus: %s: %s\n", entry->name, outcomes.back().error.c_str());
  }
  if (rank == 0 && arguments.json) print_json(outcomes);
  bool good = std::all_of(outcomes.begin(), outcomes.end(), [](const Outcome &o) { return o.holds(); });
  if (rank == 0 && (arguments.pages || arguments.write))
    for (const Outcome &outcome : outcomes) good = outcome.holds() && put_in_step(outcome, arguments) && good;
  return good ? 0 : 1;
}

Action add_verify(CLI::App &app) {
  auto arguments = std::make_shared<VerifyArguments>();
  CLI::App *command =
      app.add_subcommand("verify", "run cases with an exact solution: computed value, error, tolerance");
  command->add_option("CASE", arguments->cases, "names of cases (default: all)");
  command->add_flag("--json", arguments->json, "print the results as one JSON document");
  command->add_flag("--list", arguments->list, "list the cases with their descriptions");
  command->add_flag("--long", arguments->longer, "include the finer studies, which take minutes");
  command->add_flag("--gallery", arguments->gallery,
                    "instead of cases, the numbers that pages of the gallery state: reruns their scenes and compares; "
                    "CASE is then the name of a page");
  command->add_option("--only", arguments->only, "with --gallery, only this run or study of numbers.toml")
      ->take_all()
      ->allow_extra_args(false);
  command->add_flag("--pages", arguments->pages,
                    "compare the tables of the pages too; with --gallery compare them alone and run nothing");
  command->add_flag("--write", arguments->write,
                    "write what is computed into the tables of the pages (and, with --gallery, into numbers.toml)");
  return [arguments] { return verify(*arguments); };
}

}  // namespace
}  // namespace talus

int main(int argc, char **argv) { return talus::run_program(argc, argv, {talus::add_verify}); }
