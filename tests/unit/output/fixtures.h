#pragma once
/// A folder for one test and a small run to fill it with.
#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "output/snapshots.h"

namespace talus {

inline int world_rank() {
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}
inline int world_size() {
  int size;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

/// A new empty folder that all ranks know; removed at scope exit.
class SharedFolder {
 public:
  SharedFolder() {
    char name[4096] = {};
    const std::string wanted = std::filesystem::temp_directory_path() / "talus_output_XXXXXX";
    if (world_rank() == 0) {
      if (wanted.size() >= sizeof name) std::abort();
      std::copy(wanted.begin(), wanted.end(), name);
      if (!mkdtemp(name)) std::abort();
    }
    MPI_Bcast(name, sizeof name, MPI_CHAR, 0, MPI_COMM_WORLD);
    path_ = name;
  }
  SharedFolder(const SharedFolder &) = delete;
  SharedFolder &operator=(const SharedFolder &) = delete;
  ~SharedFolder() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (world_rank() == 0) std::filesystem::remove_all(path_);
  }
  std::string operator/(const std::string &name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

inline std::string content(const std::string &path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

inline RunHeader small_header() {
  return {
      "a small slope", "Talus test", "title = \"a small slope\"\n", "title = \"a small slope\"\n", {"sand", "clay"}};
}

/// Two triangles per rank.
inline MeshPicture small_mesh() {
  const double x = world_rank();
  return {2, {x, 0, x + 1, 0, x + 1, 1, x, 1}, {0, 1, 2, 0, 2, 3}};
}

inline int owner_of(long long id) { return static_cast<int>(id * 7 % std::max(1, world_size() - 1)); }
inline double x_of(long long id) { return 0.1 * static_cast<double>(id % 20); }
inline double y_of(long long id) { return 0.1 * static_cast<double>(id / 20); }

/// `count` particles dealt out to all ranks but the last (which has some only where it is the first), that sink with
/// time.
inline Snapshot small_snapshot(double time, long long step, long long count = 200) {
  Snapshot s{time, step, "slide", {}, {}, {}, {}};
  Column position{"position", "m", "position", 2, {}}, displacement{"displacement", "m", "displacement", 2, {}};
  Column stress{"stress", "Pa", "effective stress", 4, {}}, strain{"plastic_strain", "-", "plastic strain", 1, {}};
  for (long long id = count - 1; id >= 0; --id) {
    if (owner_of(id) != world_rank()) continue;
    const double slide = 0.01 * time * y_of(id);
    s.id.push_back(id);
    s.body.push_back(id % 2);
    position.values.insert(position.values.end(), {x_of(id) + slide, y_of(id)});
    displacement.values.insert(displacement.values.end(), {slide, 0.});
    for (int k = 0; k < 4; ++k) stress.values.push_back(static_cast<double>(10 * id + k) + time);
    strain.values.push_back(slide);
  }
  s.columns = {position, displacement, stress, strain};
  return s;
}

}  // namespace talus
