#include "scene/overrides.h"

#include <algorithm>
#include <sstream>

#include "scene/reader.h"
#include "scene/toml_nodes.h"
#include "scene/words.h"

namespace talus {
namespace {

/// A table with the one key `value`, at the place "--set".
toml::table parse_override(const std::string &text) {
  try {
    toml::table table = toml::parse("value = " + text, override_place);
    if (table.size() == 1) return table;
  } catch (const toml::parse_error &) {  // a bare word is a string
  }
  if (has_control_characters(text))
    throw SceneError("--set: \"" + text + "\" is no value of TOML, and a text without quotes is a single line");
  std::ostringstream quoted;
  quoted << "value = " << toml::value<std::string>(text);
  return toml::parse(quoted.str(), override_place);
}

/// Moves the value of `holder` to a key of a table or in place of a list's entry; null if there is no such place.
toml::node *put(toml::node &parent, const std::string &word, toml::table holder) {
  return holder.get("value")->visit([&](auto &value) -> toml::node * {
    if (toml::table *table = parent.as_table()) return &table->insert_or_assign(word, std::move(value)).first->second;
    toml::array *list = parent.as_array();
    if (!list || position(*list, word) == list->size()) return nullptr;
    return &*list->replace(list->cbegin() + position(*list, word), std::move(value));
  });
}

/// Says that a list has no such entry, and which it has; that a value has no entries at all.
std::string no_entry(const toml::node &parent, const std::string &word) {
  const std::string no = "the scene has no such entry `" + word + "`";
  const toml::array *list = parent.as_array();
  if (!list) return no + ", since what stands before it is a value";
  if (list->empty()) return no + ": the list is empty";
  std::vector<std::string> names;
  for (const toml::node &entry : *list)
    if (entry.is_table())
      if (const auto name = (*entry.as_table())["name"].value<std::string>()) names.push_back(*name);
  const std::string last = std::to_string(list->size() - 1);
  return no + "; there are " + (names.empty() ? "" : join(names) + ", or by number ") + "0" +
         (last == "0" ? "" : " to " + last);
}

}  // namespace

void apply_override(toml::table &root, const std::string &text) {
  const std::size_t equals = text.find('=');
  const std::string path = text.substr(0, equals);
  const std::vector<std::string> words = split(path);
  if (equals == std::string::npos || words.empty() || std::find(words.begin(), words.end(), "") != words.end())
    throw SceneError("--set " + text + ": write key.path=value, for instance body.sand.cohesion=5e3");
  toml::node *node = &root;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool last = i + 1 == words.size();
    toml::node *next = last ? nullptr : child(*node, words[i]);
    if (!next) next = put(*node, words[i], parse_override(last ? text.substr(equals + 1) : "{}"));
    if (!next) throw SceneError("--set " + path + ": " + no_entry(*node, words[i]));
    node = next;
  }
}

}  // namespace talus
