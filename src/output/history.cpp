#include "output/history.h"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "base/read_file.h"
#include "output/csv.h"
#include "output/replace_file.h"
#include "output/together.h"

namespace talus {
namespace {

constexpr int digits = 12;           // of every number
constexpr double round_off = 1e-11;  // relative, of a time written in so many digits

std::string header(const std::vector<std::string> &names) {
  std::string line = "time_s,step,stage";
  for (const auto &name : names) line += ',', line += csv_field(name);
  return line;
}

/// The header and the complete lines up to `time`; `gap` tells that the last of them is older.
std::string lines_until(const std::string &path, const std::vector<std::string> &names, double time, bool *gap) {
  std::istringstream file(read_file(path));
  std::string line, lines;
  if (!std::getline(file, line) || line != header(names))
    throw std::runtime_error(path + " has other columns than this run: start the run in another folder");
  double last = -1;
  do {
    if (file.eof()) break;  // no line end: the run died while it wrote this line
    lines += line + "\n", last = std::strtod(line.c_str(), nullptr);
  } while (std::getline(file, line) && std::strtod(line.c_str(), nullptr) <= time + round_off * std::abs(time));
  *gap = time >= 0 && last < time - round_off * std::abs(time);
  return lines;
}

}  // namespace

History::History(MPI_Comm comm, const std::string &path, const std::vector<std::string> &names) : History(comm, path) {
  columns_ = names.size();
  on_first_rank(comm_, [&] { open_with(header(names) + "\n"); });
}

History History::append(MPI_Comm comm, const std::string &path, const std::vector<std::string> &names, double time) {
  History history(comm, path);
  history.columns_ = names.size();
  on_first_rank(comm, [&] {
    const bool exists = std::filesystem::exists(path);
    history.gap_ = !exists;
    history.open_with(exists ? lines_until(path, names, time, &history.gap_) : header(names) + "\n");
  });
  return history;
}

void History::open_with(const std::string &content) {
  replace_file(path_, content);
  file_.open(path_, std::ios::app);
  if (!file_) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
}

void History::rows(double time, long long step, const std::string &stage,
                   const std::vector<std::vector<double>> &lines) {
  on_first_rank(comm_, [&] {
    std::ostringstream text;
    text.precision(digits);
    for (const std::vector<double> &values : lines) {
      if (values.size() != columns_)
        throw std::runtime_error(path_ + ": " + std::to_string(values.size()) + " values for " +
                                 std::to_string(columns_) + " columns");
      text << time << "," << step << "," << csv_field(stage);
      for (const double value : values) text << "," << value;
      text << "\n";
    }
    file_ << text.str() << std::flush;
    if (!file_) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
  });
}

}  // namespace talus
