#include "output/replace_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace talus {
namespace {

[[noreturn]] void complain(const std::string &path, int cause) {
  throw std::runtime_error("cannot write " + path + ": " + std::strerror(cause));
}

void write_all(int file, std::initializer_list<std::string_view> pieces, const std::string &path) {
  for (std::string_view piece : pieces)
    while (!piece.empty()) {
      const ssize_t written = ::write(file, piece.data(), piece.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) complain(path, errno);
      piece.remove_prefix(static_cast<std::size_t>(written));
    }
  if (::fsync(file)) complain(path, errno);  // some file systems report a full disk only here
}

}  // namespace

void replace_file(const std::string &path, std::string_view content) { replace_file(path, {content}); }

void replace_file(const std::string &path, std::initializer_list<std::string_view> pieces) {
  const std::string beside = path + ".part";
  const int file = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) complain(path, errno);
  try {
    write_all(file, pieces, path);
  } catch (...) {
    ::close(file);
    ::unlink(beside.c_str());
    throw;
  }
  if (::close(file) || std::rename(beside.c_str(), path.c_str())) {
    const int cause = errno;
    ::unlink(beside.c_str());
    complain(path, cause);
  }
}

void make_folder(const std::string &path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!error && !std::filesystem::is_directory(path)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw std::runtime_error("cannot create folder " + path + ": " + error.message());
}

}  // namespace talus
