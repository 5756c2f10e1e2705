#pragma once
/// Arrays with a place for every cell or node of the mesh, of which those that hold soil use the first: the time loop
/// finds room without allocating, and places that nobody has written to take no memory.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace talus {

/// Hands the memory of zeros back to the system, which gives it again, as zeros, page by page, where it is written to.
inline void hand_back_zeros([[maybe_unused]] void *begin, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__  // elsewhere the pages may stay, or come back with other values
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page, end = (address + bytes) / page * page;
  if (first < end) (void)madvise(reinterpret_cast<void *>(first), end - first, MADV_DONTNEED);
#endif
}

/// `values` become `count` zeros, or what T{} is; zeros take no memory before they are written to.
template <class T>
void make_room(std::vector<T> &values, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>, "its bytes are its value");
  values.assign(count, T{});
  const T one{};
  const auto *bytes = reinterpret_cast<const unsigned char *>(&one);
  if (std::all_of(bytes, bytes + sizeof one, [](unsigned char byte) { return byte == 0; }))
    hand_back_zeros(values.data(), count * sizeof(T));
}

}  // namespace talus
