#include "output/checkpoint.h"

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

constexpr const char *first_line = "Talus checkpoint 4\n";

std::string header_file(const std::string &dir) { return dir + "/checkpoint/header"; }

std::string state_name(long long number, int rank) {
  char name[64];
  std::snprintf(name, sizeof name, "%06lld.%d", number, rank);
  return name;
}

/// Writes `content` behind a line that says what the file is and a fingerprint that shows damage.
void save(const std::string &path, const std::string &content) {
  const auto sum = fingerprint(content.data(), content.size());
  std::string file = first_line;
  file.append(reinterpret_cast<const char *>(&sum), sizeof sum);
  replace_file(path, file + content);
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
                    header.ranks);
}

/// Removes all states of this rank except that of `number`.
void remove_others(const std::string &dir, int rank, long long number) {
  std::vector<fs::path> old;
  const std::string mine = fs::path(state_name(number, rank)).extension();
  for (const auto &file : fs::directory_iterator(dir + "/checkpoint"))
    if (file.path().extension() == mine && file.path().filename() != state_name(number, rank))
      old.push_back(file.path());
  for (const auto &file : old) fs::remove(file);
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
  try {
    together(comm, [&] { save(path, state.bytes()); });
    on_first_rank(comm, [&] {
      Archive archive;
      serialize(archive, header);
      save(header_file(dir), archive.bytes());
    });
  } catch (...) {
    std::error_code ignored;
    fs::remove(path, ignored);  // frees space on a full disk
    throw;
  }
  together(comm, [&] { remove_others(dir, rank, header.number); });
}

CheckpointHeader read_checkpoint_header(MPI_Comm comm, const std::string &dir) {
  CheckpointHeader header;
  together_or_refuse(comm, [&] {
    if (!fs::exists(header_file(dir))) throw std::runtime_error(dir + " contains no checkpoint");
    Archive archive(load(header_file(dir)));
    serialize(archive, header);
  });
  return header;
}

Archive read_checkpoint(MPI_Comm comm, const std::string &dir, const CheckpointHeader &header) {
  Archive archive;
  together_or_refuse(comm,
                     [&] { archive = Archive(load(dir + "/checkpoint/" + state_name(header.number, rank_in(comm)))); });
  return archive;
}

}  // namespace talus
