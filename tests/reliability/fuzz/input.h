#pragma once
/// What the fuzz targets share. A reader may take an input or refuse it with a text (std::invalid_argument); a crash,
/// any other exception, a sanitizer's complaint or an empty text is a finding.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace talus {

/// Calls a reader; nothing but a refusal with words is caught.
template <class Reading>
void take_or_refuse(const Reading &reading) {
  try {
    reading();
  } catch (const std::invalid_argument &refusal) {
    if (!*refusal.what()) std::abort();
  }
}

/// A file in memory, for readers that take the name of a file.
inline std::string file_of(const std::uint8_t *data, std::size_t size) {
  static const int file = memfd_create("fuzz", 0);
  if (ftruncate(file, 0) || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
  return "/proc/self/fd/" + std::to_string(file);
}

}  // namespace talus
