#include "scene/apply_materials.h"

#include <algorithm>

#include "scene/materials.h"
#include "scene/reader.h"
#include "scene/toml_nodes.h"
#include "scene/words.h"

namespace talus {
namespace {

bool has_one_of(const toml::table &table, std::initializer_list<const char *> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char *key) { return table.contains(key); });
}

/// Does a key of the table exclude this one of the library?
bool excluded(const toml::table &table, const std::string &key) {
  if (key == "porosity" || key == "grain_density")
    return has_one_of(table, {"density", "unit_weight", "saturated_unit_weight"});
  if (key == "density") return has_one_of(table, {"unit_weight", "saturated_unit_weight", "porosity", "grain_density"});
  if (key == "young_modulus" || key == "poisson_ratio") return has_one_of(table, {"shear_modulus", "bulk_modulus"});
  return false;
}

void apply(toml::table &table, const std::vector<Material> &library, const std::string &path, const std::string &file) {
  const toml::node *named = table.get("material");
  if (!named) return;
  const std::string where = place(file, *named, false) + ": " + path + ".material" + written(*named);
  std::vector<std::string> names;
  for (const Material &one : library) names.push_back(one.name);
  const std::string name = named->value_exact<std::string>().value_or("");
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw SceneError(where + " (name of the library of materials) must be one of " + join(names) +
                     (nearest(name, names).empty() ? "" : "; did you mean `" + nearest(name, names) + "`?"));
  const toml::table given = table;
  for (const MaterialKey &key : library[static_cast<std::size_t>(found - names.begin())].keys) {
    toml::table holder = toml::parse(std::string("value = ") + key.value, materials_place);
    const toml::node *own = given.get(key.key);
    const bool kind = key.key == std::string("law") || key.key == std::string("curve");
    if (kind && own && literal(*own) != key.value)
      throw SceneError(where + " is a material for " + key.key + " = " + key.value + ", and the table has " +
                       literal(*own) + ": leave one of them out");
    if (own || excluded(given, key.key)) continue;
    holder.get("value")->visit([&](auto &value) { table.insert(key.key, std::move(value)); });
  }
  table.erase("material");
}

}  // namespace

void apply_materials(toml::table &root, const std::string &file) {
  toml::table *bodies = root["body"].as_table();
  if (!bodies) return;
  for (auto &&[name, node] : *bodies) {
    toml::table *body = node.as_table();
    if (!body) continue;
    const std::string path = "body." + std::string(name.str());
    apply(*body, soils(), path, file);
    if (toml::table *retention = (*body)["retention"].as_table())
      apply(*retention, retention_curves(), path + ".retention", file);
  }
}

}  // namespace talus
