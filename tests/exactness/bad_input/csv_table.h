#pragma once
/// Tables that the program writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace talus {

using Row = std::map<std::string, std::string>;

inline std::vector<std::string> csv_cells(const std::string &line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line)
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  return cells;
}

/// The rows of a table, by the names of its columns.
inline std::vector<Row> csv_table(const std::string &path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> names = csv_cells(line);
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    const auto cells = csv_cells(line);
    EXPECT_EQ(cells.size(), names.size()) << line;
    for (size_t i = 0; i < std::min(cells.size(), names.size()); ++i)
      (i ? rows.back() : rows.emplace_back())[names[i]] = cells[i];
  }
  return rows;
}

}  // namespace talus
