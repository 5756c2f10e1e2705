#include "output/escaped_table.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <numeric>
#include <sstream>

#include "output/csv.h"
#include "output/replace_file.h"
#include "output/together.h"

namespace talus {

void write_escaped_table(MPI_Comm comm, const std::string &path, const std::vector<std::string> &bodies,
                         const EscapedTable &local) {
  const std::size_t width = local.names.size();
  const std::vector<double> all = gather(comm, local.values, static_cast<int>(width));
  on_first_rank(comm, [&] {
    if (all.empty()) {
      std::filesystem::remove(path);
      return;
    }
    std::vector<const double *> lines(all.size() / width);
    for (std::size_t i = 0; i < lines.size(); ++i) lines[i] = &all[i * width];
    std::ranges::sort(lines, {}, [](const double *line) { return std::array{line[0], line[1]}; });
    std::ostringstream text;
    text.precision(std::numeric_limits<double>::max_digits10);
    for (std::size_t k = 0; k < width; ++k) text << (k ? "," : "") << local.names[k];
    text << "\n";
    for (const double *line : lines) {
      text << line[0] << "," << static_cast<long long>(line[1]) << ","
           << csv_field(bodies[static_cast<std::size_t>(line[2])]);
      for (std::size_t k = 3; k + 1 < width; ++k) text << "," << line[k];
      text << "," << (line[width - 1] < 0 ? "" : csv_field(local.groups[static_cast<std::size_t>(line[width - 1])]))
           << "\n";
    }
    replace_file(path, text.str());
  });
}

}  // namespace talus
