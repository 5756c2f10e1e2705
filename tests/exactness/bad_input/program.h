#pragma once
/// The program as a user runs it: in a folder of its own, to its end or to a signal.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace talus {

/// A folder for one claim, removed with it.
class Folder {
 public:
  Folder() {
    std::string path = (std::filesystem::temp_directory_path() / "bad_input-XXXXXX").string();
    if (!mkdtemp(path.data())) throw std::runtime_error("cannot make " + path);
    path_ = path;
  }
  Folder(const Folder &) = delete;
  Folder &operator=(const Folder &) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string &name) const { return (path_ / name).string(); }
  const std::filesystem::path &path() const { return path_; }
  void write(const std::string &name, const std::string &text) const { std::ofstream(path_ / name) << text; }

 private:
  std::filesystem::path path_;
};

/// How a program ended, and what it printed.
struct Ending {
  int status = -1;  ///< exit status; -1: ended by a signal
  std::string output;

  bool says(const std::string &words) const { return output.find(words) != std::string::npos; }
  int count(const std::string &words) const {
    int found = 0;
    for (std::size_t at = 0; (at = output.find(words, at)) != std::string::npos; at += words.size()) ++found;
    return found;
  }
};

/// A program that runs in a folder. Its output goes to a file without a name, its own: another program may run there
/// too.
class Program {
 public:
  Program(const Folder &folder, std::vector<std::string> words) : output_(std::tmpfile()) {
    if (!output_) throw std::runtime_error("cannot make a temporary file");
    std::vector<char *> arguments;
    for (std::string &word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    process_ = fork();
    if (process_) return;
    dup2(fileno(output_), 1), dup2(fileno(output_), 2);
    if (chdir(folder.path().c_str())) _exit(126);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  ~Program() {
    if (process_ > 0) kill(process_, SIGKILL), waitpid(process_, nullptr, 0);
    std::fclose(output_);
  }
  Program(const Program &) = delete;
  Program &operator=(const Program &) = delete;

  void signal(int number) const { kill(process_, number); }
  /// From now on its files cannot grow beyond this, as on a full disk.
  void limit_files(rlim_t bytes) const {
    const rlimit limit{bytes, bytes};
    prlimit(process_, RLIMIT_FSIZE, &limit, nullptr);
  }
  /// Waits until a file exists; false when the program ends or five minutes pass before that: machines may be slow.
  bool wait_for(const std::string &file) {
    for (int i = 0; i < 30000 && !ended(); ++i) {
      if (std::filesystem::exists(file)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  Ending end() {
    int status = 0;
    if (process_ > 0 && waitpid(process_, &status, 0) > 0) exit_ = status, process_ = -1;
    std::string text;
    char part[4096];
    for (ssize_t got; (got = pread(fileno(output_), part, sizeof part, static_cast<off_t>(text.size()))) > 0;)
      text.append(part, static_cast<std::size_t>(got));
    return {WIFEXITED(exit_) ? WEXITSTATUS(exit_) : -1, text};
  }

 private:
  bool ended() {
    int status = 0;
    if (waitpid(process_, &status, WNOHANG) != process_) return false;
    exit_ = status, process_ = -1;
    return true;
  }

  std::FILE *output_;
  pid_t process_;
  int exit_ = 0;
};

/// The command line of `talus` on one rank or, by mpirun, on several.
inline std::vector<std::string> talus_words(const std::vector<std::string> &arguments, int ranks = 1) {
  std::vector<std::string> words;
  if (ranks > 1) words = {MPIEXEC, "--allow-run-as-root", "--oversubscribe", "-n", std::to_string(ranks)};
  words.push_back(TALUS);
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

inline Ending talus(const Folder &folder, const std::vector<std::string> &arguments, int ranks = 1) {
  return Program(folder, talus_words(arguments, ranks)).end();
}

}  // namespace talus
