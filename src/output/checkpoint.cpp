#include "output/checkpoint.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "base/read_file.h"
#include "output/replace_file.h"
#include "output/together.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

constexpr const char *first_line = "Talus checkpoint 9\n";

std::string header_file(const std::string &dir) { return dir + "/checkpoint/header"; }
std::string header_before(const std::string &dir) { return header_file(dir) + ".before"; }

std::string state_name(long long number, int rank) {
  char name[64];
  std::snprintf(name, sizeof name, "%06lld.%d", number, rank);
  return name;
}

/// Writes `content` behind a line that says what the file is and a fingerprint that shows damage.
void save(const std::string &path, const std::string &content) {
  const auto sum = fingerprint(content.data(), content.size());
  replace_file(path, {first_line, {reinterpret_cast<const char *>(&sum), sizeof sum}, content});
}

std::string load(const std::string &path) {
  std::string file = read_file(path);
  unsigned long long sum;
  const std::size_t head = std::strlen(first_line) + sizeof sum;
  if (file.size() < head || file.compare(0, head - sizeof sum, first_line))
    throw std::runtime_error(path + " is no checkpoint of this version of Talus");
  std::memcpy(&sum, file.data() + head - sizeof sum, sizeof sum);
  file.erase(0, head);
  if (fingerprint(file.data(), file.size()) != sum)
    throw std::runtime_error(path + " is damaged: its content does not match its fingerprint");
  return file;
}

void serialize(Archive &archive, CheckpointHeader &header) {
  archive.serialize("header", header.program, header.scene, header.time, header.step, header.number, header.stage,
                    header.ranks, header.mesh, header.partition, header.cuts);
}

/// Number and rank of a state by the name of its file; false where it is another file.
bool is_state(const fs::path &file, long long *number, int *rank) {
  int end = 0;
  const std::string name = file.filename();
  return std::sscanf(name.c_str(), "%lld.%d%n", number, rank, &end) == 2 && end == static_cast<int>(name.size());
}

/// Removes the states but those of two checkpoints; those of ranks that are no more are shared among those that are.
void remove_others(const std::string &dir, int my_rank, int ranks, long long last, long long before) {
  std::vector<fs::path> old;
  for (const auto &file : fs::directory_iterator(dir + "/checkpoint")) {
    long long number;
    int rank;
    if (is_state(file.path(), &number, &rank) && rank % ranks == my_rank && number != last && number != before)
      old.push_back(file.path());
  }
  for (const auto &file : old) fs::remove(file);
}

CheckpointHeader header_in(const std::string &file) {
  CheckpointHeader header;
  Archive archive(load(file));
  serialize(archive, header);
  return header;
}

/// Number of the checkpoint of a header; -1 where there is none, or it cannot be read.
long long number_in(const std::string &file) {
  try {
    return fs::exists(file) ? header_in(file).number : -1;
  } catch (const std::runtime_error &) {
    return -1;
  }
}

/// `together` for bad input: failures are std::invalid_argument.
template <class Work>
void together_or_refuse(MPI_Comm comm, Work &&work) {
  try {
    together(comm, work);
  } catch (const std::runtime_error &error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace

void write_checkpoint(MPI_Comm comm, const std::string &dir, CheckpointHeader header, const Archive &state) {
  const int rank = rank_in(comm);
  check_mpi(MPI_Comm_size(comm, &header.ranks), "counting ranks");
  on_first_rank(comm, [&] { make_folder(dir + "/checkpoint"); });
  const std::string path = dir + "/checkpoint/" + state_name(header.number, rank);
  long long before = -1;
  try {
    together(comm, [&] { save(path, state.bytes()); });
    on_first_rank(comm, [&] {
      before = number_in(header_file(dir));
      if (before >= 0)
        replace_file(header_before(dir), read_file(header_file(dir)));
      else  // there is none, or it is damaged, and what is before it stays
        before = number_in(header_before(dir));
      Archive archive;
      serialize(archive, header);
      save(header_file(dir), archive.bytes());
    });
  } catch (...) {
    std::error_code ignored;
    fs::remove(path, ignored);  // frees space on a full disk
    throw;
  }
  check_mpi(MPI_Bcast(&before, 1, MPI_LONG_LONG, 0, comm), "sending the number of a checkpoint");
  together(comm, [&] { remove_others(dir, rank, header.ranks, header.number, before); });
}

Checkpoint read_checkpoint(MPI_Comm comm, const std::string &dir) {
  Checkpoint found;
  const int rank = rank_in(comm);
  int ranks;
  check_mpi(MPI_Comm_size(comm, &ranks), "counting ranks");
  int exist[2] = {fs::exists(header_file(dir)), fs::exists(header_before(dir))};
  check_mpi(MPI_Bcast(exist, 2, MPI_INT, 0, comm), "looking for checkpoints");
  if (!exist[0] && !exist[1]) throw std::invalid_argument(dir + " contains no checkpoint");
  for (const bool last : {true, false}) {
    if (!exist[last ? 0 : 1]) continue;
    try {
      together_or_refuse(comm, [&] {
        found.header = header_in(last ? header_file(dir) : header_before(dir));
        found.parts.clear();
        // of `written` ranks the part of this one; the first rank has some
        const long long written = found.header.ranks, begin = (rank * written + ranks - 1) / ranks,
                        end = ((rank + 1) * written + ranks - 1) / ranks;
        for (long long r = begin; r < end; ++r)
          found.parts.emplace_back(load(dir + "/checkpoint/" + state_name(found.header.number, static_cast<int>(r))));
      });
      break;
    } catch (const std::invalid_argument &error) {
      if (!found.passed_over.empty()) throw std::invalid_argument(found.passed_over);
      found.passed_over = error.what();
      if (!last || !exist[1]) throw;
    }
  }
  found.last_number = std::max(found.header.number, number_in(header_file(dir)));
  if (rank == 0 && !found.passed_over.empty())  // otherwise what a run that died has begun is written again
    for (const auto &file : fs::directory_iterator(dir + "/checkpoint")) {
      long long number;
      int of_rank;
      if (is_state(file.path(), &number, &of_rank)) found.last_number = std::max(found.last_number, number);
    }
  check_mpi(MPI_Bcast(&found.last_number, 1, MPI_LONG_LONG, 0, comm), "sending the number of a checkpoint");
  return found;
}

}  // namespace talus
