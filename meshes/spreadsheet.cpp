#include "meshes/spreadsheet.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "base/read_file.h"

namespace talus {
namespace {

/// Does the character stand in a line outside quotes, before a `#`?
bool stands_in(const std::string &line, char wanted) {
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (!quoted && c == '#') break;
    if (!quoted && c == wanted) return true;
  }
  return false;
}

/// Semicolons or tabs part cells where they stand in as many lines as commas, which may then be decimal ones. A stray
/// one in a line of a table with commas is the fault of that line alone.
char separator_of(const std::vector<std::string> &lines) {
  const auto lines_with = [&](char wanted) {
    return std::ranges::count_if(lines, [=](const std::string &line) { return stands_in(line, wanted); });
  };
  for (const char wanted : {';', '\t'})
    if (lines_with(wanted) > 0 && lines_with(wanted) >= lines_with(',')) return wanted;
  return ',';
}

std::vector<std::string> cells_of(const std::string &line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[++i];  // a doubled quote stands for one
    else if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      cells.emplace_back();
    else if (c == '#' && !quoted)
      break;
    else
      cells.back() += c;
  }
  for (std::string &cell : cells) cell = trim(cell);
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
  return cells;
}

std::vector<std::string> lines_of(const std::string &text) {
  std::vector<std::string> lines(1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
    if (text[i] == '\n' || text[i] == '\r')
      lines.emplace_back();
    else
      lines.back() += text[i];
  }
  return lines;
}

}  // namespace

bool Spreadsheet::number(const std::string &cell, double &value) const {
  std::string text = cell;
  if (decimal_comma && std::count(text.begin(), text.end(), ',') == 1 && text.find('.') == std::string::npos)
    std::replace(text.begin(), text.end(), ',', '.');
  const char *begin = text.data() + text.starts_with('+'), *end = text.data() + text.size();
  const auto [at, error] = std::from_chars(begin, end, value);
  return error == std::errc() && at == end && std::isfinite(value);
}

std::string trim(const std::string &text) {
  const auto first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string> text_lines(const std::string &file, const std::string &form) {
  std::string text;
  try {
    text = read_file(file);
  } catch (const std::system_error &error) {
    throw std::invalid_argument(file + ": cannot be read (" + error.code().message() +
                                "); check the path and its permissions");
  }
  if (text.empty()) throw std::invalid_argument(file + ": is empty; save it again as " + form);
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  if (text.find('\0') != std::string::npos || text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw std::invalid_argument(file + ": is no text in UTF-8; save it as " + form);
  return lines_of(text);
}

Spreadsheet read_spreadsheet(const std::string &file) {
  const std::vector<std::string> lines = text_lines(file, "CSV UTF-8");
  const char separator = separator_of(lines);
  Spreadsheet sheet;
  sheet.decimal_comma = separator != ',';
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (auto cells = cells_of(lines[i], separator); !cells.empty())
      sheet.rows.push_back({std::move(cells), static_cast<int>(i) + 1});
  return sheet;
}

}  // namespace talus
