#pragma once
/// Names of gallery scenes work wherever a scene file does.
#include <string>

namespace talus {

/// Path of a scene: the argument itself if it is a file, else docs/gallery/NAME/scene.toml. Throws SceneError, naming
/// the gallery's scenes.
std::string find_scene(const std::string &name);

}  // namespace talus
