#include "commands/gallery.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <sstream>

#include "base/archive.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {
namespace {

/// The gallery of the source tree this program was built in, else the one installed beside the program.
std::filesystem::path gallery_folder() {
  std::error_code error;
  if (std::filesystem::is_directory(TALUS_GALLERY, error)) return TALUS_GALLERY;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "share/talus/docs/gallery";
}

}  // namespace

std::string find_scene(const std::string &name) {
  namespace fs = std::filesystem;
  if (fs::is_regular_file(name)) {
    const std::string ending = fs::path(name).extension();
    const auto is = [&](std::initializer_list<const char *> some) {
      return std::ranges::find(some, ending) != some.end();
    };
    if (is({".csv", ".dxf"}))
      throw SceneError(name + " is a section, not a scene: a scene (.toml) names it with mesh.section");
    if (is({".msh", ".asc", ".tif", ".tiff", ".h5", ".xdmf"}))
      throw SceneError(name + " is not a scene, which is a .toml file");
    return name;
  }
  const fs::path gallery = gallery_folder();
  const fs::path scene = gallery / name / "scene.toml";
  if (fs::is_regular_file(scene)) return scene.string();
  std::string known;
  if (fs::is_directory(gallery))
    for (const auto &entry : fs::directory_iterator(gallery))
      if (fs::is_regular_file(entry.path() / "scene.toml"))
        known += (known.empty() ? "" : ", ") + entry.path().filename().string();
  if (fs::exists(fs::path(name) / "run.h5"))
    throw SceneError(name + " is a folder with the results of a run: give the scene (.toml) of the run instead");
  throw SceneError(name + " is neither a file nor a gallery scene (" + known + ")");
}

std::string short_name(const std::string &scene_file) {
  const std::filesystem::path path = std::filesystem::absolute(scene_file);
  return path.stem() == "scene" ? path.parent_path().filename() : path.stem();
}

std::string default_results(const std::string &scene_file, const std::vector<std::string> &set,
                            const std::string &ending) {
  constexpr std::size_t longest = 120;  // characters; file systems end at 255 bytes
  std::string name = short_name(scene_file), overrides;
  for (const std::string &one : set) overrides += "_" + one;
  for (char &c : overrides)
    if (!std::isalnum(static_cast<unsigned char>(c)) && !std::strchr("._=+-", c)) c = '-';
  if (overrides.size() > longest) {
    std::ostringstream number;  // tells apart what was cut off
    number << std::hex << fingerprint(overrides.data(), overrides.size());
    overrides = overrides.substr(0, longest) + "_" + number.str();
  }
  return "results/" + name + ending + overrides;
}

}  // namespace talus
