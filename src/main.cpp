/// The program `talus` and its commands.
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <filesystem>

#include "program.h"

namespace {

/// `talus verify` is a program beside this one, tests/verify, which installations lack.
int start_verify(char **argv) {
  std::error_code error;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  execv((folder / "talus-verify").c_str(), argv);
  std::fprintf(stderr, "talus: verify belongs to the source tree, where `./talus verify` builds and starts it\n");
  return 2;
}

}  // namespace

int main(int argc, char **argv) {
  if (argc > 1 && std::strcmp(argv[1], "verify") == 0) return start_verify(argv);
  using namespace talus;
  return run_program(argc, argv,
                     {add_run, add_solve, add_mesh, add_check, add_soil, add_record, add_newmark, add_plot, add_maps,
                      add_bench, add_compare, add_converge, add_study, add_describe});
}
