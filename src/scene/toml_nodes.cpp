#include "scene/toml_nodes.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <tuple>

#include "scene/materials.h"
#include "scene/quantity.h"
#include "scene/words.h"

namespace talus {
namespace {

bool before(const toml::node &a, const toml::node &b) {
  const auto rank = [](const toml::node &node) {
    const toml::source_region &where = node.source();
    const bool overridden = where.path && *where.path == override_place;
    return std::tuple(overridden, where.begin.line, where.begin.column);
  };
  return rank(a) < rank(b);
}

}  // namespace

std::string place(const std::string &file, const toml::node &node, bool root) {
  const toml::source_region &where = node.source();
  if (where.path && *where.path == override_place) return std::string(override_place);
  if (where.path && *where.path == materials_place) return file + ", " + std::string(materials_place);
  return root || where.begin.line == 0 ? file : file + " line " + std::to_string(where.begin.line);
}

double number_of(const toml::node &node) {
  return node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
}

std::string literal(const toml::node &node) {
  if (node.is_string()) return std::string("\"") + node.value_or(std::string()) + "\"";
  if (node.is_number()) return shortest(number_of(node));
  if (const toml::array *list = node.as_array()) {
    std::vector<std::string> elements;
    for (const toml::node &element : *list) elements.push_back(literal(element));
    return std::string("[") + join(elements) + "]";
  }
  std::ostringstream stream;
  node.visit([&](const auto &value) { stream << value; });
  return stream.str();
}

std::string written(const toml::node &node) {
  if (node.is_table()) return "";
  const std::string text = literal(node);
  constexpr std::size_t longest = 72;
  return " = " + (text.size() > longest ? text.substr(0, longest) + " ..." : text);
}

std::vector<std::pair<std::string, const toml::node *>> in_file_order(const toml::table &table) {
  std::vector<std::pair<std::string, const toml::node *>> keys;
  for (const auto &[key, node] : table) keys.emplace_back(key.str(), &node);
  std::stable_sort(keys.begin(), keys.end(), [](const auto &a, const auto &b) { return before(*a.second, *b.second); });
  return keys;
}

std::size_t position(const toml::array &list, const std::string &word) {
  const bool number = !word.empty() && word.size() < 9 && std::all_of(word.begin(), word.end(), ::isdigit);
  if (number) return std::min<std::size_t>(std::stoul(word), list.size());
  const auto named = [&](const toml::node &node) {
    return node.is_table() && (*node.as_table())["name"].value_or(std::string()) == word;
  };
  return std::find_if(list.begin(), list.end(), named) - list.begin();
}

}  // namespace talus
