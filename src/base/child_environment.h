#pragma once
#include <unistd.h>

#include <string_view>
#include <vector>

namespace talus {

/// The environment for programs that this one starts, null at its end, without what mpirun put there: with it, a child
/// would take itself for a rank of this run and wait for the others.
inline std::vector<char *> environment_without_mpi() {
  std::vector<char *> kept;
  for (char **variable = environ; *variable; ++variable) {
    const std::string_view text(*variable);
    if (!text.starts_with("OMPI_") && !text.starts_with("PMIX_") && !text.starts_with("PMI_") &&
        !text.starts_with("ORTE_") && !text.starts_with("PRTE_"))
      kept.push_back(*variable);
  }
  kept.push_back(nullptr);
  return kept;
}

}  // namespace talus
