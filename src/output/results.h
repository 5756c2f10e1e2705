#pragma once
/// Columns of particle values of this rank, which the time loop passes to the writers. Writers are collective over
/// `comm`.
#include <petscsys.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace talus {

/// One field of all local particles, particle-major: values[particle * components + k].
struct Column {
  std::string name, unit, meaning;
  int components = 1;  ///< 1, 2, 3 (vector), 4 or 6 (symmetric tensor xx, yy, zz, xy(, yz, xz))
  std::vector<double> values;
};

/// Names of the components of a field that has so many: none of a scalar. Throws std::invalid_argument for a number of
/// components that no field has.
inline std::vector<std::string> component_names(int components) {
  switch (components) {
    case 1:
      return {};
    case 2:
      return {"x", "y"};
    case 3:
      return {"x", "y", "z"};
    case 4:
      return {"xx", "yy", "zz", "xy"};
    case 6:
      return {"xx", "yy", "zz", "xy", "yz", "xz"};
  }
  throw std::invalid_argument("a column has 1, 2, 3, 4 or 6 components, not " + std::to_string(components));
}

/// One state of the run. `id` is the particle's number, the same whatever the partition; columns have one row per local
/// particle.
struct Snapshot {
  double time = 0;  ///< [s]
  long long step = 0;
  std::string stage;
  std::vector<long long> id;
  std::vector<int> body;                                ///< index into the run's body names
  std::vector<Column> columns;                          ///< among them always "position" (components = dim)
  std::vector<std::pair<std::string, double>> numbers;  ///< counts of the run so far, such as evaluations of the forces
};

/// The background mesh, which is written once. The writer gathers it over the ranks.
struct MeshPicture {
  int dimension = 2;
  std::vector<double> position;      ///< [nodes][dim], local nodes
  std::vector<long long> cell_node;  ///< [cells][dim + 1], local node numbers
};

}  // namespace talus
