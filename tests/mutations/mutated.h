#pragma once
/// Which change of tests/mutations/list.toml is switched on in this process: that of the environment variable
/// TALUS_MUTATION, none without it. Included by the build of tests/mutations/run in front of every source.
#include <cstdlib>

namespace talus {

inline const int mutation = std::getenv("TALUS_MUTATION") ? std::atoi(std::getenv("TALUS_MUTATION")) : 0;

/// Is change `number` on? The list counts from 1.
inline bool mutated(int number) { return mutation == number; }

}  // namespace talus
