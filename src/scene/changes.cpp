#include "scene/changes.h"

#include <algorithm>
#include <set>

#include "scene/toml_nodes.h"

namespace talus {
namespace {

void compare(const toml::node *before, const toml::node *now, const std::string &path,
             std::vector<std::string> &changed) {
  static const toml::table nothing;  // a table of the scene that is not there says what an empty one says
  const bool whole = !path.empty() && path.find('.') == std::string::npos;
  if (whole && !before && now && now->is_table()) before = &nothing;
  if (whole && !now && before && before->is_table()) now = &nothing;
  const auto below = [&](const std::string &key) { return path.empty() ? key : path + "." + key; };
  if (before && now && before->is_table() && now->is_table()) {
    std::set<std::string> keys;
    for (const toml::node *node : {before, now})
      for (const auto &[key, value] : *node->as_table()) keys.emplace(key.str());
    for (const std::string &key : keys)
      compare(before->as_table()->get(key), now->as_table()->get(key), below(key), changed);
  } else if (before && now && before->is_array_of_tables() && now->is_array_of_tables()) {
    const toml::array &a = *before->as_array(), &b = *now->as_array();
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i)
      compare(a.get(i), b.get(i), below(std::to_string(i)), changed);
  } else if (!before || !now || literal(*before) != literal(*now)) {
    changed.push_back(path);
  }
}

}  // namespace

std::vector<std::string> changed_keys(const std::string &before, const std::string &now) {
  const toml::table a = toml::parse(before), b = toml::parse(now);
  std::vector<std::string> changed;
  compare(&a, &b, "", changed);
  return changed;
}

}  // namespace talus
