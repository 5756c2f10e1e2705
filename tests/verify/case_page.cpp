#include "tests/verify/case_page.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace talus {
namespace {

constexpr const char *end_of_table = "<!-- end -->";

std::string start_of_table(bool longer) { return longer ? "<!-- verify --long -->\n" : "<!-- verify -->\n"; }

std::string text_of(const std::string &path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string digits(const char *format, double x) {
  char text[40];
  std::snprintf(text, sizeof text, format, x);
  return text;
}

/// An error or a tolerance: per cent as long as that reads well.
std::string share(double x) {
  if (!std::isfinite(x)) return "-";
  if (x == 0) return "0";
  return x >= 1e-4 ? digits("%.2g %%", 100 * x) : digits("%.1e", x);
}

double share_in(const std::string &text) {
  const double x = std::strtod(text.c_str(), nullptr);
  return text.find('%') == std::string::npos ? x : x / 100;
}

std::string in_cell(std::string text) {  // a bar would begin the next cell
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

std::string table_of(const std::vector<Checked> &quantities) {
  std::string table = "| quantity | exact | computed | error | tolerance |\n|---|---|---|---|---|\n";
  for (const Checked &q : quantities)
    table += "| " + in_cell(q.name) + " | " + digits("%.6g", q.exact) + " | " + digits("%.6g", q.computed) + " | " +
             share(q.relative_error) + " | " + share(q.tolerance) + " |\n";
  return table;
}

/// First character of the table and the one behind its last; npos where the page has none.
std::pair<size_t, size_t> place_of_table(const std::string &page, bool longer) {
  const std::string start = start_of_table(longer);
  const size_t at = page.find(start);
  if (at == std::string::npos) return {at, at};
  return {at + start.size(), page.find(end_of_table, at)};
}

std::vector<std::vector<std::string>> cells_of(const std::string &table) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| ", 0) != 0) continue;
    auto &row = rows.emplace_back();
    for (size_t at = 2, bar; (bar = line.find(" |", at)) != std::string::npos; at = bar + 3)
      row.push_back(line.substr(at, bar - at));
  }
  if (!rows.empty()) rows.erase(rows.begin());  // titles
  return rows;
}

bool agree(const std::vector<std::string> &row, const Checked &q) {
  if (row.size() != 5 || row[0] != in_cell(q.name) || row[4] != share(q.tolerance)) return false;
  const double exact = std::strtod(row[1].c_str(), nullptr), error = share_in(row[3]);
  if (std::abs(exact - q.exact) > 1e-4 * std::abs(q.exact) + 1e-300) return false;
  constexpr double round_off = 1e-9;  // below it an error is one of round-off, which differs between processors
  const double share_of_tolerance = q.tolerance < round_off ? 1 : 0.1;
  const double within = std::isfinite(q.tolerance) ? share_of_tolerance * q.tolerance : 0.25 * error + 1e-3;
  return std::abs(error - q.relative_error) <= within || !std::isfinite(q.relative_error);
}

}  // namespace

void write_case_page(const std::string &readme, bool longer, const std::vector<Checked> &quantities) {
  std::string page = text_of(readme);
  const auto [begin, end] = place_of_table(page, longer);
  if (begin == std::string::npos)
    page += "\n" + start_of_table(longer) + table_of(quantities) + end_of_table + "\n";
  else if (end == std::string::npos)
    throw std::runtime_error(readme + " has no " + end_of_table + " behind its table");
  else
    page.replace(begin, end - begin, table_of(quantities));
  std::ofstream(readme) << page;
}

std::string difference_from_page(const std::string &readme, bool longer, const std::vector<Checked> &quantities) {
  const std::string page = text_of(readme);
  const auto [begin, end] = place_of_table(page, longer);
  if (begin == std::string::npos || end == std::string::npos) return "it has no table";
  const auto rows = cells_of(page.substr(begin, end - begin));
  if (rows.size() != quantities.size())
    return "it states " + std::to_string(rows.size()) + " quantities, computed are " +
           std::to_string(quantities.size());
  for (size_t k = 0; k < rows.size(); ++k)
    if (!agree(rows[k], quantities[k])) return "its line \"" + rows[k].front() + "\" is not what is computed";
  return "";
}

}  // namespace talus
