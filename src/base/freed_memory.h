#pragma once
/// Memory that was freed and is still the program's.
#include <cstdlib>  // says which C library this is

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace talus {

/// Hands freed memory back to the system, to be called after work that took much more than is kept. The C library would
/// do so by itself, but SuperLU_DIST, which PETSc loads, tells it at the start of a program to keep all of it.
inline void hand_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace talus
