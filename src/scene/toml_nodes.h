#pragma once
/// What the reader asks of a parsed TOML file beyond toml++: where a value stands, how it is written, where a path
/// leads. Included only by the reader's own files.
#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace talus {

/// Stands for the file in the source of values that were given on the command line.
inline constexpr std::string_view override_place = "--set";

/// "slope.toml line 14"; the file alone for the root table; "--set" for an override.
std::string place(const std::string &file, const toml::node &node, bool root);

/// The number of a node that is one (toml++'s own conversion refuses integers that a double rounds).
double number_of(const toml::node &node);

/// A value as a scene would write it.
std::string literal(const toml::node &node);

/// " = value" as a scene would write it, not too long, empty for tables.
std::string written(const toml::node &node);

/// Keys of a table in the order of the file (toml++ sorts them by name).
std::vector<std::pair<std::string, const toml::node *>> in_file_order(const toml::table &table);

/// Position of a list's entry that is given by its position or by its `name`; the size of the list if there is none.
std::size_t position(const toml::array &list, const std::string &word);

/// The entry of a table or list, null if there is none.
template <class Node>
Node *child(Node &parent, const std::string &word) {
  if (auto *table = parent.as_table()) return table->get(word);
  if (auto *list = parent.as_array()) return list->get(position(*list, word));
  return nullptr;
}

}  // namespace talus
