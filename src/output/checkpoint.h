#pragma once
/// Checkpoints of a run: DIR/checkpoint/NUMBER.RANK holds the state of a rank, DIR/checkpoint/header says which number
/// counts and which run it belongs to, and DIR/checkpoint/header.before the same of the checkpoint before it, which
/// stays in case the newest one is damaged. Every file appears whole. The header is written last, and older states are
/// removed after it, so that a run can be resumed whenever it died, and also from a full disk. All functions are
/// collective over `comm` and fail alike on all ranks.
#include <mpi.h>

#include <string>
#include <vector>

#include "base/archive.h"

namespace talus {

struct CheckpointHeader {
  std::string program;  ///< name and version of the program
  std::string scene;    ///< values of the scene as run
  double time = 0;      ///< simulated [s]
  long long step = 0;
  long long number = 0;  ///< of the checkpoint, never used twice
  int stage = 0, ranks = 0;
  unsigned long long mesh = 0;                ///< fingerprint of the mesh
  std::vector<unsigned long long> partition;  ///< fingerprints of what each rank has of it
  std::vector<double> cuts;                   ///< how the mesh is divided, as the mesh stores it
};

/// Writes the next checkpoint of the run in `dir`; the last one stays, and those before it go. On failure both earlier
/// checkpoints stay, and std::runtime_error says path and cause.
void write_checkpoint(MPI_Comm comm, const std::string &dir, CheckpointHeader header, const Archive &state);

/// A checkpoint as it is read.
struct Checkpoint {
  CheckpointHeader header;
  std::vector<Archive> parts;  ///< states of some ranks: dealt out in their order, and as many to each rank as it goes
  std::string passed_over;     ///< why a later one could not be read; empty: this is the last one
  long long last_number = 0;   ///< the largest that was used
};

/// The last checkpoint in `dir` that is whole, on any number of ranks. Throws std::invalid_argument, with the cause
/// alone, if there is none, or all are missing something, damaged, or of another version.
Checkpoint read_checkpoint(MPI_Comm comm, const std::string &dir);

}  // namespace talus
