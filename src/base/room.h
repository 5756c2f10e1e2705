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

/// `values` become `count` zeros, or what T{} is; zeros take no memory before they are written to, and little while
/// this makes them.
template <class T>
void make_room(std::vector<T> &values, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>, "its bytes are its value");
  const T one{};
  const auto *bytes = reinterpret_cast<const unsigned char *>(&one);
  const bool zero = std::all_of(bytes, bytes + sizeof one, [](unsigned char byte) { return byte == 0; });
  constexpr std::size_t at_a_time = (std::size_t{1} << 22) / sizeof(T) + 1;
  values.clear();
  values.reserve(count);
  while (values.size() < count) {
    const std::size_t before = values.size();
    values.resize(std::min(count, before + at_a_time));
    if (zero) hand_back_zeros(values.data() + before, (values.size() - before) * sizeof(T));
  }
}

/// `values` become `count` zeros, with room to grow: soil that spreads does not ask for memory at each remap.
inline void zeros_with_room(std::vector<double> &values, std::size_t count) {
  if (values.capacity() < count) values.reserve(2 * count);
  values.assign(count, 0);
}

}  // namespace talus
