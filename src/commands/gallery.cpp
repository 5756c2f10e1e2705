#include "commands/gallery.h"

#include <filesystem>

#include "scene/reader.h"

namespace talus {

std::string find_scene(const std::string &name) {
  namespace fs = std::filesystem;
  if (fs::is_regular_file(name)) return name;
  const fs::path gallery(TALUS_GALLERY);
  const fs::path scene = gallery / name / "scene.toml";
  if (fs::is_regular_file(scene)) return scene.string();
  std::string known;
  if (fs::is_directory(gallery))
    for (const auto &entry : fs::directory_iterator(gallery))
      if (fs::is_regular_file(entry.path() / "scene.toml")) known += (known.empty() ? "" : ", ") + entry.path().filename().string();
  throw SceneError(name + " is neither a file nor a gallery scene (" + known + ")");
}

}  // namespace talus
