#pragma once
/// Values at the nodes of a square grid over a map, such as elevations, and what they are between the nodes.
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace talus {

struct Grid {
  std::string file;
  int columns = 0, rows = 0;
  double west = 0, south = 0;        ///< of the first value, the centre of its cell [m]
  double spacing = 0;                ///< of columns and rows [m]
  std::vector<double> values;        ///< [rows][columns], from the southwest; not a number where there is no data
  std::string projection;            ///< as well-known text; empty where the file names none
  std::string unit;                  ///< of the values, as the file names it; mostly empty
  std::vector<std::string> remarks;  ///< sentences on how the file was read

  double x(int column) const { return west + column * spacing; }
  double y(int row) const { return south + row * spacing; }
  double east() const { return west + (columns - 1) * spacing; }
  double north() const { return south + (rows - 1) * spacing; }
  /// Linear between values along both axes; not a number outside and where one of the values in between has no data. At
  /// a node or on a line of the grid its own values alone count.
  double at(double x, double y) const {
    const double i = (x - west) / spacing, j = (y - south) / spacing, near = 1e-6;
    if (!(i >= -near && i <= columns - 1 + near && j >= -near && j <= rows - 1 + near))
      return std::numeric_limits<double>::quiet_NaN();
    const auto part = [near](double beyond) { return beyond < near ? 0 : beyond > 1 - near ? 1 : beyond; };
    const int a = std::clamp(static_cast<int>(i), 0, std::max(0, columns - 2)),
              b = std::clamp(static_cast<int>(j), 0, std::max(0, rows - 2));
    const double s = part(i - a), t = part(j - b);
    const double *z = &values[static_cast<std::size_t>(b) * columns + a];
    double sum = 0;
    const auto add = [&](double weight, int place) {
      if (weight > 0) sum += weight * z[place];
    };
    add((1 - t) * (1 - s), 0), add((1 - t) * s, 1), add(t * (1 - s), columns), add(t * s, columns + 1);
    return sum;
  }
};

}  // namespace talus
