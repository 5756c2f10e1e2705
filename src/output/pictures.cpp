#include "output/pictures.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>

#include "base/child_environment.h"
#include "base/version.h"
#include "output/strength.h"

namespace talus {
namespace {

/// A script of the source tree this program was built in, else the one installed beside the program.
std::string script(const char *name) {
  const std::filesystem::path source = std::filesystem::path(TALUS_PLOTS) / name;
  if (std::filesystem::exists(source)) return source;
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "share/talus/plots" / name;
}

bool warn(const std::string &dir, const std::string &cause) {
  std::fprintf(stderr, "warning: no pictures of %s: %s\n", dir.c_str(), cause.c_str());
  return false;
}

/// Runs a script on the results in `dir`.
bool draw(const char *name, const std::string &dir, const std::vector<std::string> &options) {
  std::vector<std::string> words{TALUS_PYTHON, "-B", script(name), dir};  // -B: no caches among the sources
  words.insert(words.end(), options.begin(), options.end());
  std::vector<char *> arguments;
  for (auto &word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  pid_t child;
  auto environment = environment_without_mpi();
  std::string drawn_by = std::string("TALUS_PROGRAM=") + program;
  environment.insert(environment.begin(), drawn_by.data());
  if (const int error = posix_spawn(&child, TALUS_PYTHON, nullptr, nullptr, arguments.data(), environment.data()))
    return warn(dir, std::string("cannot start " TALUS_PYTHON ": ") + std::strerror(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return warn(dir, std::strerror(errno));
  if (!WIFEXITED(status) || WEXITSTATUS(status)) return warn(dir, words[2] + " failed");
  return true;
}

}  // namespace

bool draw_pictures(const std::string &dir, const PictureChoice &choice) {
  std::vector<std::string> options;
  if (!choice.fields.empty()) options.push_back("--fields");
  options.insert(options.end(), choice.fields.begin(), choice.fields.end());
  if (!choice.times.empty()) options.push_back("--times");
  options.insert(options.end(), choice.times.begin(), choice.times.end());
  if (choice.logarithmic) options.push_back("--log");
  try {
    write_strength(dir);
  } catch (const std::exception &) {  // stress paths are then drawn without envelopes
  }
  return draw("talus_plot.py", dir, options);
}

bool draw_comparison(const std::string &dir) { return draw("talus_compare.py", dir, {}); }

bool draw_element_tests(const std::string &dir, const std::vector<std::string> &tests, const std::string &title) {
  std::vector<std::string> options{"--title", title, "--tests"};
  options.insert(options.end(), tests.begin(), tests.end());
  return draw("talus_soil.py", dir, options);
}

}  // namespace talus
