#pragma once
/// Messages from every rank to every rank.
#include <mpi.h>

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace talus {

using Messages = std::vector<std::string>;  ///< to or from each rank

/// Sends each rank its message and returns what came from each. Messages may have any length; that of a rank to itself
/// is not copied. Collective.
Messages deliver(MPI_Comm comm, Messages sent);

template <class T>
void append(std::string &bytes, const T &value) {
  bytes.append(reinterpret_cast<const char *>(&value), sizeof value);
}

template <class T>
std::vector<T> values_of(std::string_view bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

}  // namespace talus
