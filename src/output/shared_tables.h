#pragma once
/// HDF5 files of large tables that several ranks write. With one writer PATH.h5 holds the tables; with more each writer
/// has a file PATH.part0.h5, PATH.part1.h5, ... and PATH.h5 joins them into datasets that read like one.
#include <mpi.h>

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "output/hdf5_file.h"

namespace talus {

/// A dataset of which this writer has some rows.
struct Table {
  std::string name;
  int columns;
  std::variant<std::vector<double>, std::vector<long long>> values;
  std::vector<long long> rows;  ///< how many each writer has, the same on all ranks
};

/// Writes the tables of a file, which ends in ".h5". `writer` is the number of this rank among the writers, -1 where it
/// is none; `about` adds attributes on the first rank. A table is given up once the file in memory has it. Collective.
/// On failure nothing new stays, and std::runtime_error says path and cause on all ranks.
void write_tables(MPI_Comm comm, const std::string &path, int writer, std::vector<Table> tables,
                  const std::function<void(Hdf5Builder &)> &about);

/// Removes a file and those that it joins.
void remove_tables(const std::string &path);

/// Renames a file and those that it joins. The joining one then leads nowhere.
void rename_tables(const std::string &from, const std::string &to);

/// Throws std::runtime_error with the path if one of the files that hold the rows of `dataset` is missing or damaged,
/// or has other rows than `path` says.
void check_parts(const std::string &path, const std::string &dataset);

}  // namespace talus
