#include "output/results_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "output/replace_file.h"
#include "output/together.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

/// Is it the folder of a study, a comparison or a refinement? Each of their runs has a file that says what it depends
/// on.
bool holds_trials(const std::string &path) {
  for (const fs::directory_entry &entry : fs::directory_iterator(path))
    if (fs::exists(entry.path() / "trial")) return true;
  return false;
}

}  // namespace

ResultsFolder::ResultsFolder(MPI_Comm comm, const std::string &path, FolderUse use) {
  on_first_rank(comm, [&] {
    if (fs::exists(path) && !fs::is_directory(path))
      throw std::invalid_argument(path + " is a file, and results need a folder: choose another one with -o");
    make_folder(path);
    if (!lock_.emplace(path).taken())
      throw std::invalid_argument("another run is writing into " + path +
                                  "; wait for its end, or choose another folder with -o");
    if (use == FolderUse::resume) return;
    const bool used = fs::exists(path + "/run.h5") || fs::exists(path + "/history.csv");
    if (used && use == FolderUse::start)
      throw std::invalid_argument(path + " holds the results of a run" +
                                  (fs::exists(path + "/checkpoint/header") ? " (--resume goes on with it)" : "") +
                                  "; choose another folder with -o, or give --force to replace them");
    if (!used && use == FolderUse::start && holds_trials(path))
      throw std::invalid_argument(path +
                                  " holds the runs of a study or a comparison; choose another folder with -o, "
                                  "or give --force to write beside them");
    fs::remove_all(path + "/checkpoint");
  });
}

/// The file of the lock stays there, empty.
FolderLock::FolderLock(const std::string &folder) {
  const std::string name = folder + "/.lock";
  file_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) throw std::runtime_error("cannot write " + name + ": " + std::strerror(errno));
  if (::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(file_), file_ = -1;
}

FolderLock::~FolderLock() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace talus
