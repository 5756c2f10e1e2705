#pragma once
/// Puts the library of materials into a parsed scene; included only by the reader's own files.
#include <toml++/toml.h>

#include <string>

namespace talus {

/// Replaces `material` of each body and of its retention curve by the keys of that material which the table lacks. What
/// excludes a key of the library counts as that key: a density leaves out porosity and grain density, a shear or bulk
/// modulus the elastic constants. Throws SceneError for an unknown name, and for a law that the material is not for.
void apply_materials(toml::table &root, const std::string &file);

}  // namespace talus
