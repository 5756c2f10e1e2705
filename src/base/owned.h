#pragma once
/// Ownership of PETSc objects: the only wrapping there is; everywhere else the reader sees PETSc's own calls.
#include <petscdmplex.h>
#include <petscdmswarm.h>

#include <utility>

namespace talus {

/// Owns one PETSc object; destroyed at scope exit, also on PetscCall's early return.
template <class Object, PetscErrorCode (*destroy)(Object *)>
class Owned {
 public:
  Owned() = default;
  Owned(Owned &&other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Owned &operator=(Owned &&other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Owned() {
    if (object_) (void)destroy(&object_);
  }

  operator Object() const { return object_; }  ///< VecNorm(residual, NORM_2, &norm)
  Object *create() {                           ///< VecDuplicate(y, residual.create())
    *this = Owned();
    return &object_;
  }

 private:
  Object object_ = nullptr;
};
using Dm = Owned<DM, DMDestroy>;
using Vector = Owned<::Vec, VecDestroy>;

/// A communicator of PETSc's own on that of a program, so that messages do not meet those of others.
class Communicator {
 public:
  Communicator() = default;
  explicit Communicator(MPI_Comm of) { (void)PetscCommDuplicate(of, &comm_, nullptr); }
  Communicator(Communicator &&other) noexcept : comm_(std::exchange(other.comm_, MPI_COMM_NULL)) {}
  Communicator &operator=(Communicator &&other) noexcept {
    std::swap(comm_, other.comm_);
    return *this;
  }
  ~Communicator() {
    if (comm_ != MPI_COMM_NULL) (void)PetscCommDestroy(&comm_);
  }
  operator MPI_Comm() const { return comm_; }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

}  // namespace talus
