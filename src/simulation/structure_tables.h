#pragma once
/// structure_NAME.csv: forces and slip along each structure at the times of history.csv, a row for each of its
/// elements.
#include <memory>
#include <string>
#include <vector>

#include "output/history.h"
#include "physics/structures/structures.h"
#include "simulation/clock.h"

namespace talus {

template <int dim>
class StructureTables {
 public:
  /// Null where the scene has no structures; they must outlive the tables.
  StructureTables(MPI_Comm comm, const Structures<dim> *structures) : comm_(comm), structures_(structures) {}

  /// Starts the files in a folder, or goes on with those that a run up to `time` [s] has left there. Collective.
  void open(const std::string &directory);
  void append(const std::string &directory, double time);
  /// A row for each element of the structures that are there, if the files are open. Collective.
  void write(const Clock &clock);

 private:
  template <class Make>
  void make(const std::string &directory, Make &&make);

  MPI_Comm comm_;
  const Structures<dim> *structures_;
  std::vector<std::unique_ptr<History>> files_;
};

}  // namespace talus
