#include "output/shared_tables.h"

#include <filesystem>
#include <stdexcept>
#include <utility>

#include "output/together.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

/// "run/000012.part3.h5" beside "run/000012.h5".
std::string part_of(const std::string &path, std::size_t writer) {
  return fs::path(path).replace_extension("part" + std::to_string(writer) + ".h5");
}

void remove_parts(const std::string &path, std::size_t from) {
  while (fs::remove(part_of(path, from))) ++from;
}

/// Moves the rows of a table into the file.
void add_rows(Hdf5Builder &file, Table &table) {
  std::visit([&](auto &values) { file.dataset(table.name, std::exchange(values, {}), table.columns); }, table.values);
}

void add_joined(Hdf5Builder &file, const Table &table, const std::string &path) {
  std::vector<Hdf5Builder::Part> parts;
  for (std::size_t w = 0; w < table.rows.size(); ++w)
    parts.push_back({fs::path(part_of(path, w)).filename(), table.rows[w]});
  std::visit([&]<class T>(const std::vector<T> &) { file.dataset_of_parts<T>(table.name, table.columns, parts); },
             table.values);
}

}  // namespace

void write_tables(MPI_Comm comm, const std::string &path, int writer, std::vector<Table> tables,
                  const std::function<void(Hdf5Builder &)> &about) {
  const std::size_t writers = tables.at(0).rows.size();
  const bool joined = writers > 1, mine = joined && writer >= 0;
  const std::string part = part_of(path, writer);
  try {
    together(comm, [&] {
      if (!mine) return;
      Hdf5Builder file(part);
      for (Table &table : tables) add_rows(file, table);
      file.save();
    });
    on_first_rank(comm, [&] {
      Hdf5Builder file(path);
      for (Table &table : tables) joined ? add_joined(file, table, path) : add_rows(file, table);
      about(file);
      file.save();
      remove_parts(path, joined ? writers : 0);  // of an earlier file of this name
    });
  } catch (...) {
    std::error_code ignored;
    if (mine) fs::remove(part, ignored);  // frees space on a full disk
    throw;
  }
}

void remove_tables(const std::string &path) {
  fs::remove(path);
  remove_parts(path, 0);
}

void rename_tables(const std::string &from, const std::string &to) {
  fs::rename(from, to);
  for (std::size_t w = 0; fs::exists(part_of(from, w)); ++w) fs::rename(part_of(from, w), part_of(to, w));
}

void check_parts(const std::string &path, const std::string &dataset) {
  const Hdf5Reader whole(path);
  const std::vector<std::string> parts = whole.parts(dataset);
  if (parts.empty()) return;
  hsize_t rows = 0;
  for (const std::string &part : parts) rows += Hdf5Reader(fs::path(path).replace_filename(part)).shape(dataset).at(0);
  if (rows != whole.shape(dataset).at(0))
    throw std::runtime_error(path + " joins files that do not belong together: they have " + std::to_string(rows) +
                             " rows of " + dataset + ", not " + std::to_string(whole.shape(dataset).at(0)));
}

}  // namespace talus
