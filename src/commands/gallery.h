#pragma once
/// Names of gallery scenes work wherever a scene file does; where results go unless the user says so.
#include <string>
#include <vector>

namespace talus {

/// Path of a scene: the argument itself if it is a file, else docs/gallery/NAME/scene.toml. Throws SceneError, naming
/// the gallery's scenes.
std::string find_scene(const std::string &name);

/// What a scene is called in names of folders: its file without the ending, or its folder for a file scene.toml.
std::string short_name(const std::string &scene_file);

/// The default folder of a run: results/NAME, followed by the ending of the command and the overrides of --set, so that
/// other commands and other inputs have another folder.
std::string default_results(const std::string &scene_file, const std::vector<std::string> &set,
                            const std::string &ending = "");

}  // namespace talus
