#pragma once
/// How the parts of a run say that it cannot go on: they throw RunFailure with the cause, on all ranks alike; the
/// recorder adds where the run stood.
#include <mpi.h>
#include <petscsys.h>

#include <sstream>
#include <stdexcept>
#include <string>

#include "base/rounded.h"
#include "base/vec.h"
#include "simulation.h"

namespace talus {

/// The bare cause, before the recorder has added time, step and stage.
class RunFailure : public RunError {
 public:
  using RunError::RunError;
};

/// The same of soil in motion, which what has become of its volume may explain.
class MotionFailure : public RunFailure {
 public:
  using RunFailure::RunFailure;
};

/// Turns a PETSc error into an exception, where no PETSc function stands between thrower and catcher.
inline void require(PetscErrorCode error) {
  if (error) throw RunFailure("PETSc reported error " + std::to_string(error) + " (its message stands above)");
}

/// The text of the first rank which has one, empty if none has. Collective.
inline std::string text_of_first(MPI_Comm comm, bool mine, std::string text) {
  int rank, ranks, size = static_cast<int>(text.size());
  MPI_Comm_rank(comm, &rank), MPI_Comm_size(comm, &ranks);
  int first = mine ? rank : ranks;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == ranks) return "";
  MPI_Bcast(&size, 1, MPI_INT, first, comm);
  text.resize(size);
  MPI_Bcast(text.data(), size, MPI_CHAR, first, comm);
  return text;
}

/// "(x, y) m" of the first rank which has a place to name, empty if none has. Collective.
template <int dim>
std::string place_of_first(MPI_Comm comm, bool mine, const Vec<dim> &where) {
  std::ostringstream text;
  for (int d = 0; d < dim; ++d) text << (d ? ", " : "(") << where[d];
  return text_of_first(comm, mine, text.str() + ") m");
}

}  // namespace talus
