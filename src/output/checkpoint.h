#pragma once
/// Checkpoints of a run: DIR/checkpoint/NUMBER.RANK holds the state of a rank, DIR/checkpoint/header says which number
/// counts and which run it belongs to. Every file appears whole. The header is written last, and older states are
/// removed after it, so that a run can be resumed whenever it died, and also from a full disk. All functions are
/// collective over `comm` and fail alike on all ranks.
#include <mpi.h>

#include <string>

#include "base/archive.h"

namespace talus {

struct CheckpointHeader {
  std::string program;  ///< name and version of the program
  std::string scene;    ///< values of the scene as run
  double time = 0;      ///< simulated [s]
  long long step = 0;
  long long number = 0;  ///< of the checkpoint, never used twice
  int stage = 0, ranks = 0;
};

/// Replaces the checkpoint of the run in `dir`. On failure the earlier checkpoint stays, and std::runtime_error says
/// path and cause.
void write_checkpoint(MPI_Comm comm, const std::string &dir, CheckpointHeader header, const Archive &state);

/// The header of the checkpoint in `dir`. Throws std::invalid_argument, with the cause alone, if there is none, it is
/// damaged, or of another version.
CheckpointHeader read_checkpoint_header(MPI_Comm comm, const std::string &dir);

/// The state of this rank in the checkpoint of that header. Throws std::invalid_argument if it is missing or damaged.
Archive read_checkpoint(MPI_Comm comm, const std::string &dir, const CheckpointHeader &header);

}  // namespace talus
