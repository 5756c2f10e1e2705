#include "program.h"

#include <petscsys.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <map>
#include <new>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "base/blas_buffer.h"
#include "base/temporary_folder.h"
#include "base/version.h"
#include "commands/starter.h"
#include "output/pictures.h"
#include "output/script.h"
#include "scene/words.h"
#include "simulation.h"

namespace talus {
namespace {

constexpr const char *out_of_memory =
    "the memory of this machine, or a limit of it (ulimit -v), does not suffice: take larger cells (mesh.size), fewer "
    "mesh.halvings or particles_per_cell, or ranks on more machines; talus check says what a scene takes";

/// Errors reach all ranks alike. Where one rank fails alone, such as by a file that only it cannot read, the others
/// would wait for it for ever: a rank that failed waits for them to fail too, and otherwise ends all.
void end_together(MPI_Comm failures, int rank, const char *cause, int status) {
  constexpr double patience = 10;  // [s]; ranks that fail alike do so within milliseconds
  MPI_Request all;
  MPI_Ibarrier(failures, &all);
  int here = 0;
  for (const double begin = MPI_Wtime(); !here && MPI_Wtime() - begin < patience; usleep(1000))
    MPI_Test(&all, &here, MPI_STATUS_IGNORE);
  if (here) return;
  std::fprintf(stderr, "talus: rank %d alone: %s\n", rank, cause);
  MPI_Abort(failures, status);
}

/// The commands of the program, and those that the launcher adds.
std::vector<std::string> command_names(const CLI::App &app) {
  std::vector<std::string> names;
  for (const CLI::App *command : app.get_subcommands([](const CLI::App *) { return true; }))
    names.push_back(command->get_name());
  if (const char *launchers = std::getenv("TALUS_LAUNCHER_COMMANDS")) {
    std::istringstream words(launchers);
    names.insert(names.end(), std::istream_iterator<std::string>(words), {});
  }
  return names;
}

/// Names the words that a command does not know, in the order in which they were typed, with the option that may be
/// meant; empty where an option is right and its value is not.
std::string unknown_words(const CLI::App &app, int argc, char **argv) {
  const auto chosen = app.get_subcommands();
  if (chosen.empty()) return "";
  std::vector<std::string> left = app.remaining(true), options, values, known;
  for (int i = 1; i < argc; ++i)
    if (const auto at = std::find(left.begin(), left.end(), argv[i]); at != left.end())
      (at->starts_with('-') ? options : values).push_back(*at), left.erase(at);
  for (const CLI::Option *option : chosen[0]->get_options())
    for (const std::string &name : option->get_lnames()) known.push_back(name);
  std::string text = "talus: " + chosen[0]->get_name() + " ";
  if (options.empty()) return values.empty() ? "" : text + "takes nothing more, and there is " + join(values) + " too";
  text += "has no option ";
  for (std::size_t k = 0; k < options.size(); ++k) {
    const std::string word = options[k].substr(0, options[k].find('=')),
                      near = nearest(word.substr(std::min(word.find_first_not_of('-'), word.size())), known);
    text += (k ? ", and no " : "") + word + (near.empty() ? "" : "; did you mean `--" + near + "`?");
  }
  return text + "\n`talus " + chosen[0]->get_name() + " --help` describes all of them";
}

/// Runs the chosen command; owned PETSc objects die in here, before PetscFinalize.
int perform(int argc, char **argv, std::initializer_list<AddCommand> commands, MPI_Comm failures, int rank) {
  const bool speaks = rank == 0;
  CLI::App app{
      "Talus: simulation of landslides by the material point method, from initial stress to the end of the run-out"};
  app.set_version_flag("--version", std::string("talus ") + version);
  app.add_flag_callback(
      "--python-path",
      [&] {
        if (speaks) std::puts(script_folder().c_str());
        throw CLI::Success();
      },
      "Print the folder of the Python module talus_results, which reads results, and exit");
  app.require_subcommand(1);
  std::map<CLI::App *, Action> actions;
  for (const AddCommand add : commands) {
    const auto before = app.get_subcommands({}).size();
    const Action action = add(app);
    actions[app.get_subcommands({})[before]] = action;
  }
  const std::set<std::string> parallel{"run", "solve", "check", "compare", "verify", "bench"};
  for (CLI::App *command : app.get_subcommands({}))
    if (const std::string name = command->get_name(); parallel.count(name))
      command->footer("On several MPI ranks: ./talus " + name +
                      " ... -n RANKS, or without the launcher mpiexec -n RANKS talus " + name + " ...");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError &error) {
    if (!speaks) return error.get_exit_code() ? 2 : 0;
    if (dynamic_cast<const CLI::ExtrasError *>(&error))
      if (const std::string sentence = unknown_words(app, argc, argv); !sentence.empty()) {
        std::fprintf(stderr, "%s\n", sentence.c_str());
        return 2;
      }
    const std::vector<std::string> names = command_names(app);
    const std::string word = argc > 1 ? argv[1] : "";
    if (word.empty() || word[0] == '-' || std::find(names.begin(), names.end(), word) != names.end())
      return app.exit(error) ? 2 : 0;
    std::fprintf(stderr, "talus: %s is no command; %s\n", word.c_str(), suggestion(word, names).c_str());
    return 2;
  }
  try {
    for (CLI::App *chosen : app.get_subcommands()) return actions.at(chosen)();
  } catch (const std::invalid_argument &error) {
    if (speaks) std::fprintf(stderr, "talus: %s\n", error.what());
    end_together(failures, rank, error.what(), 2);
    return 2;
  } catch (const BrokenOff &error) {
    if (speaks) std::fprintf(stderr, "talus: %s\n", error.what());
    end_together(failures, rank, error.what(), 1);
    if (speaks) (void)draw_pictures(error.results, {.fields = error.fields, .times = {}});  // no rank waits now
    return 1;
  } catch (const std::bad_alloc &) {
    if (speaks) std::fprintf(stderr, "talus: %s\n", out_of_memory);
    end_together(failures, rank, out_of_memory, 1);
    return 1;
  } catch (const std::exception &error) {
    if (speaks) std::fprintf(stderr, "talus: %s\n", error.what());
    end_together(failures, rank, error.what(), 1);
    return 1;
  }
  return 0;
}

/// Starts PETSc and MPI. Open MPI keeps files of all programs of a user that mpirun has not started in one folder of
/// TMPDIR: version 4 removes it when the last of them ends, and a program that starts at that moment fails; version 5
/// leaves it. Here each such program has `files` for that, as long as it lives. Version 5 also leaves a file of shared
/// memory, which one rank does not need.
PetscErrorCode start(int *count, char ***arguments, TemporaryFolder &files) {
  PetscFunctionBeginUser;
  constexpr const char *ranks_of[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_NAMESPACE", "PMI_RANK"};
  const bool alone =
      std::none_of(std::begin(ranks_of), std::end(ranks_of), [](auto name) { return std::getenv(name); });
  const char *const set = std::getenv("TMPDIR");
  const std::string usual = set ? set : "";
  if (alone) setenv("OMPI_MCA_btl", "self", 0);
  if (alone && files.make()) setenv("TMPDIR", files.path().c_str(), 1);
  PetscCall(PetscInitialize(count, arguments, nullptr, nullptr));
  if (set)
    setenv("TMPDIR", usual.c_str(), 1);
  else
    unsetenv("TMPDIR");
  PetscFunctionReturn(0);
}

/// MPI starts with files in the folder for temporary ones, and says little where it cannot write them.
bool can_write_temporary_files() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  std::string name = folder / "talus-XXXXXX";
  const int file = error ? -1 : mkstemp(name.data());
  const std::string page(4096, ' ');
  const ssize_t size = file >= 0 ? write(file, page.data(), page.size()) : -1;
  const bool written = size == static_cast<ssize_t>(page.size());
  const int cause = error ? error.value() : size >= 0 ? ENOSPC : errno;
  if (file >= 0) close(file), unlink(name.c_str());
  if (!written)
    std::fprintf(stderr, "talus: cannot write temporary files in %s: %s; set TMPDIR to a folder with room\n",
                 error ? std::getenv("TMPDIR") : folder.c_str(), std::strerror(cause));
  return written;
}

}  // namespace

int run_program(int argc, char **argv, std::initializer_list<AddCommand> commands) {
  end_with_starter();
  if (!can_write_temporary_files()) return 1;
  TemporaryFolder files_of_mpi;
  // everything behind a lone "--" is PETSc's
  int own = argc;
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]) == "--") own = i;
  std::vector<char *> petsc_arguments{argv[0]};
  for (int i = own + 1; i < argc; ++i) petsc_arguments.push_back(argv[i]);
  int petsc_count = static_cast<int>(petsc_arguments.size());
  petsc_arguments.push_back(nullptr);
  char **petsc_argv = petsc_arguments.data();
  if (start(&petsc_count, &petsc_argv, files_of_mpi)) return 1;
  std::signal(SIGPIPE, SIG_IGN);  // who reads the output may leave early; PETSc takes it for a fault of the program
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm failures;  // of its own, so that its messages are not taken for others
  MPI_Comm_dup(PETSC_COMM_WORLD, &failures);
  int status = 1;
  if (take_blas_buffer())
    status = status_for_starter(perform(own, argv, commands, failures, rank));
  else if (rank == 0)
    std::fprintf(stderr, "talus: %s\n", out_of_memory);
  MPI_Comm_free(&failures);
  if (PetscFinalize()) return 1;
  return status;
}

}  // namespace talus
