#include "commands/files_read.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "scene/reader.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

/// Endings of files that are read with a file of the same name: by GDAL, and by the reader of meshes. Statistics that
/// viewers leave in .aux.xml change no result.
constexpr const char *companions[] = {".prj", ".tfw", ".wld", ".shx", ".dbf", ".cpg", ".origin.json"};

/// By FNV-1a over words of 8 bytes, which finds edited files and not forged ones.
std::string state_of(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t digest = 14695981039346656037u;
  std::uintmax_t size = 0;
  for (std::vector<char> block(1 << 20); file;) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    size += count;
    std::memset(block.data() + count, 0, (8 - count % 8) % 8);
    for (std::size_t i = 0; i < count; i += 8) {
      std::uint64_t word;
      std::memcpy(&word, block.data() + i, 8);
      digest = (digest ^ word) * 1099511628211u;
      digest ^= digest >> 32;
    }
  }
  std::ostringstream line;
  line << size << ' ' << std::hex << digest << ' ' << path;
  return line.str();
}

std::set<std::string> files_of(const std::string &named) {
  std::set<std::string> files;
  const fs::path path(named);
  std::error_code none;
  if (fs::is_directory(path, none)) {
    for (const fs::directory_entry &entry : fs::directory_iterator(path / "checkpoint", none))
      files.insert(entry.path().string());
    return files;
  }
  files.insert(named);
  for (const char *ending : companions) files.insert(fs::path(path).replace_extension(ending).string());
  return files;
}

}  // namespace

std::vector<std::string> FilesRead::of(const Scene &scene) {
  std::vector<std::string> lines;
  for (const std::string &named : scene.root->files())
    for (const std::string &path : files_of(named)) {
      if (!fs::is_regular_file(path)) continue;
      const auto [at, added] = known_.try_emplace(path);
      if (added) at->second = state_of(path);
      lines.push_back(at->second);
    }
  return lines;
}

std::string path_of(const std::string &line) { return line.substr(line.find(' ', line.find(' ') + 1) + 1); }

}  // namespace talus
