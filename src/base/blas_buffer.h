#pragma once
/// Memory that OpenBLAS takes once and keeps.
#include <petscsys.h>
// clang-format off
#include <petscblaslapack.h>
// clang-format on
#include <sys/mman.h>

namespace talus {

/// OpenBLAS tries for ever to get its buffer of 128 MB where there is no memory: it shall take it at the start. Returns
/// whether there is room for it.
inline bool take_blas_buffer() {
  constexpr std::size_t buffer = 160 << 20;
  void *const room = mmap(nullptr, buffer, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) return false;
  munmap(room, buffer);
  const PetscBLASInt one = 1;
  PetscScalar matrix = 1;
  PetscBLASInt info = 0;
  LAPACKpotrf_("U", &one, &matrix, &one, &info);
  return info == 0;
}

}  // namespace talus
