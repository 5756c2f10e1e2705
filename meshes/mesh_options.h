#pragma once
/// A MeshRequest by options of a command line, those of `talus mesh` and of talus-mesh. Options are named as the keys
/// of [mesh] and [mesh.terrain] in a scene, with - for _: --far-size for mesh.terrain.far_size.
#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "meshes/mesh_request.h"

namespace talus {

/// A number in SI by a text that may have a unit. Throws std::invalid_argument that names the option.
double quantity(const char *option, const std::string &text, Unit unit);

/// Does a file hold a section? Otherwise it is terrain.
bool is_section(const std::string &file);

/// Adds SOURCE and the options to a command. What is returned makes the request of them, once the command line is
/// parsed; it throws std::invalid_argument where a quantity is none, or an option does not belong to the source.
std::function<MeshRequest()> add_mesh_options(CLI::App &command);

}  // namespace talus
