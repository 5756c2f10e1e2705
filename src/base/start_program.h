#pragma once
/// Programs that this one starts.
#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace talus {

/// Starts a program with a variable NAME=VALUE in its environment, but without what mpirun put there: with it, it would
/// take itself for a rank of this run and wait for the others. With `screen` its errors go into that file, and its
/// output nowhere. Throws std::runtime_error where it cannot be started.
inline pid_t start_program(const std::string &path, std::vector<std::string> words, std::string variable,
                           const std::string &screen = "") {
  std::vector<char *> argv, environment{variable.data()};
  for (std::string &word : words) argv.push_back(word.data());
  for (char **one = environ; *one; ++one) {
    const std::string_view text(*one);
    if (!text.starts_with("OMPI_") && !text.starts_with("PMIX_") && !text.starts_with("PMI_") &&
        !text.starts_with("ORTE_") && !text.starts_with("PRTE_"))
      environment.push_back(*one);
  }
  argv.push_back(nullptr), environment.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (!screen.empty()) {
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 2, screen.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  }
  pid_t child = -1;
  const int error = posix_spawn(&child, path.c_str(), &actions, nullptr, argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error) throw std::runtime_error("cannot start " + path + ": " + std::strerror(error));
  return child;
}

}  // namespace talus
