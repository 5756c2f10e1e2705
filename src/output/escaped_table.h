#pragma once
/// escaped.csv: the particles that left the mesh, one per line.
#include <mpi.h>

#include <string>
#include <vector>

namespace talus {

/// Particles of this rank: `names.size()` values each, of which the first three are time [s], id and body, and the last
/// is the group of faces by which it left the mesh; -1: faces without a name.
struct EscapedTable {
  std::vector<std::string> names;   ///< of the columns, with their units
  std::vector<std::string> groups;  ///< their names
  std::vector<double> values;       ///< [particle][column]
};

/// Writes the particles of all ranks ordered by time and id, with all digits; bodies and groups by their names. Removes
/// the file where there are none. The file is either as before or wholly new; std::runtime_error says path and cause,
/// the same on all ranks. Collective.
void write_escaped_table(MPI_Comm comm, const std::string &path, const std::vector<std::string> &bodies,
                         const EscapedTable &local);

}  // namespace talus
