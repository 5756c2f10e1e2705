#pragma once
/// The folder of a run's results: one run at a time writes into it, and none replaces another's results unasked.
#include <mpi.h>

#include <optional>
#include <string>

namespace talus {

/// What a run means to do in a folder.
enum class FolderUse {
  start,    ///< results of another run are in the way
  replace,  ///< those are given up
  resume,   ///< goes on with what is there
};

/// Keeps other programs out of a folder as long as this object lives; the system ends the lock with the program,
/// however that ends. A file system without locks lets all pass.
class FolderLock {
 public:
  /// Takes the lock if nobody has it. Throws std::runtime_error where the folder cannot be written.
  explicit FolderLock(const std::string &folder);
  FolderLock(const FolderLock &) = delete;
  FolderLock &operator=(const FolderLock &) = delete;
  ~FolderLock();
  bool taken() const { return file_ >= 0; }

 private:
  int file_;  // descriptor
};

class ResultsFolder {
 public:
  /// Makes the folder and locks it while this object lives. A run that replaces another removes its checkpoints first,
  /// so that nobody goes on from them. Throws std::invalid_argument where another run writes there, or has written and
  /// is not to be replaced; std::runtime_error where the folder cannot be made. Collective, the same on all ranks.
  ResultsFolder(MPI_Comm comm, const std::string &path, FolderUse use);
  ResultsFolder(const ResultsFolder &) = delete;
  ResultsFolder &operator=(const ResultsFolder &) = delete;

 private:
  std::optional<FolderLock> lock_;  // on rank 0
};

}  // namespace talus
