#pragma once
/// A place for files that nobody keeps.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace talus {

/// A folder for temporary files, removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() = default;
  TemporaryFolder(const TemporaryFolder &) = delete;
  TemporaryFolder &operator=(const TemporaryFolder &) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  /// Makes the folder; false if that fails.
  bool make() {
    std::error_code error;
    std::string path = (std::filesystem::temp_directory_path(error) / "talus-XXXXXX").string();
    if (error || !mkdtemp(path.data())) return false;
    path_ = path;
    return true;
  }
  const std::string &path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace talus
