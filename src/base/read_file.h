#pragma once
/// Whole files as texts.
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

namespace talus {

/// The bytes of a file. Throws std::system_error, "cannot read PATH: CAUSE", also where reading fails half way: a
/// stream would then end as at the end of the file, and the rest would be missing unnoticed.
inline std::string read_file(const std::string &path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::string content;
  std::array<char, 65536> block;
  ssize_t count = file < 0 ? -1 : 0;
  do {
    if (file >= 0) count = ::read(file, block.data(), block.size());
    if (count > 0) content.append(block.data(), static_cast<std::size_t>(count));
  } while (count > 0 || (count < 0 && file >= 0 && errno == EINTR));
  const int cause = errno;
  if (file >= 0) ::close(file);
  if (count < 0) throw std::system_error(cause, std::generic_category(), "cannot read " + path);
  return content;
}

}  // namespace talus
