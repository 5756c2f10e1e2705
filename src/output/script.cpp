#include "output/script.h"

#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "base/start_program.h"
#include "base/version.h"

namespace talus {

std::string script_folder() {
  if (std::filesystem::exists(TALUS_PLOTS)) return TALUS_PLOTS;
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "share/talus/plots";
}

int run_script(const std::string &name, const std::vector<std::string> &arguments) {
  std::vector<std::string> words{TALUS_PYTHON, "-B",
                                 std::filesystem::path(script_folder()) / name};  // -B: no caches among the sources
  words.insert(words.end(), arguments.begin(), arguments.end());
  const pid_t child = start_program(TALUS_PYTHON, words, std::string("TALUS_PROGRAM=") + program);
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::runtime_error(std::strerror(errno));
  if (!WIFEXITED(status)) throw std::runtime_error(words[2] + " was ended by a signal");
  return WEXITSTATUS(status);
}

}  // namespace talus
