#pragma once
/// Typical soils that a scene may name, `[body.NAME] material = "loose_sand"`, and typical retention curves,
/// `[body.NAME.retention] material = "loam"`. What the scene itself says has precedence, key by key. The values are
/// first guesses from tables of the literature, each with its range and source; they replace no tests.
#include <string_view>
#include <vector>

namespace talus {

/// One key of a material.
struct MaterialKey {
  const char *key, *value;  ///< as a scene would write them
  const char *range;        ///< of the source, with its unit; empty for names
  const char *source;
};

struct Material {
  const char *name, *meaning;
  std::vector<MaterialKey> keys;
};

/// Of bodies, and of retention curves.
const std::vector<Material> &soils();
const std::vector<Material> &retention_curves();

/// Adds the library to what `talus describe` prints.
class Describer;
void describe_materials(Describer &describer);

/// Where a value of the library stands, in complaints.
inline constexpr std::string_view materials_place = "library of materials";

}  // namespace talus
