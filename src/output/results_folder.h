#pragma once
/// The folder of a run's results: one run at a time writes into it, and none replaces another's results unasked.
#include <mpi.h>

#include <string>

namespace talus {

/// What a run means to do in a folder.
enum class FolderUse {
  start,    ///< results of another run are in the way
  replace,  ///< those are given up
  resume,   ///< goes on with what is there
};

class ResultsFolder {
 public:
  /// Makes the folder and locks it while this object lives. A run that replaces another removes its checkpoints first,
  /// so that nobody goes on from them. Throws std::invalid_argument where another run writes there, or has written and
  /// is not to be replaced; std::runtime_error where the folder cannot be made. Collective, the same on all ranks.
  ResultsFolder(MPI_Comm comm, const std::string &path, FolderUse use);
  ResultsFolder(const ResultsFolder &) = delete;
  ResultsFolder &operator=(const ResultsFolder &) = delete;
  ~ResultsFolder();

 private:
  int lock_ = -1;  // file descriptor on rank 0; the system ends the lock with the program, however that ends
};

}  // namespace talus
