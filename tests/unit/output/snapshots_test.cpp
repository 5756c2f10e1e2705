// Claims of output/snapshots.h, read back with the HDF5 C API.
#include "output/snapshots.h"

#include <hdf5.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <sstream>
#include <stdexcept>

#include "fixtures.h"

namespace {
bool snapshots_close = true;  ///< false: the system reports an error when a snapshot is closed, as network drives may
}  // namespace

/// Takes the place of the system's function in this program and in its libraries.
extern "C" int close(int file) {
  char path[4096];
  const ssize_t length = readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), path, sizeof path);
  const bool fails = !snapshots_close && length > 0 && std::string(path, length).find("/run/0000") != std::string::npos;
  const int status = static_cast<int>(syscall(SYS_close, file));
  if (!fails) return status;
  errno = EIO;
  return -1;
}

namespace talus {
namespace {

/// A dataset as doubles, through the door run.h5 and its links.
std::vector<double> read(const std::string &dir, const std::string &name) {
  const hid_t file = H5Fopen((dir + "/run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, name.c_str(), H5P_DEFAULT), space = H5Dget_space(set);
  std::vector<double> values(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  EXPECT_EQ(H5Sget_simple_extent_ndims(space), 2) << name;
  EXPECT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << name;
  H5Sclose(space), H5Dclose(set), H5Fclose(file);
  return values;
}

double read_time(const std::string &dir, const std::string &snapshot) {
  double time = -1;
  const hid_t file = H5Fopen((dir + "/run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t a = H5Aopen_by_name(file, ("snapshots/" + snapshot).c_str(), "time", H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(H5Aread(a, H5T_NATIVE_DOUBLE, &time), 0);
  H5Aclose(a), H5Fclose(file);
  return time;
}

/// Number of snapshots that the door shows.
hsize_t snapshots_in(const std::string &dir) {
  H5G_info_t info{};
  const hid_t file = H5Fopen((dir + "/run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(H5Gget_info_by_name(file, "snapshots", &info, H5P_DEFAULT), 0);
  H5Fclose(file);
  return info.nlinks;
}

void expect_snapshot(const std::string &dir, const std::string &number, double time, std::size_t count = 200) {
  const auto id = read(dir, "snapshots/" + number + "/id");
  const auto body = read(dir, "snapshots/" + number + "/body");
  const auto position = read(dir, "snapshots/" + number + "/position");
  const auto stress = read(dir, "snapshots/" + number + "/stress");
  EXPECT_EQ(read_time(dir, number), time);
  ASSERT_EQ(id.size(), count);
  ASSERT_EQ(body.size(), count);
  ASSERT_EQ(position.size(), 2 * count);
  ASSERT_EQ(stress.size(), 4 * count);
  for (std::size_t p = 0; p < count; ++p) {
    const auto number_of = static_cast<long long>(p);
    EXPECT_EQ(id[p], p);
    EXPECT_EQ(body[p], p % 2);
    EXPECT_EQ(position[2 * p + 1], y_of(number_of));
    EXPECT_EQ(stress[4 * p + 3], static_cast<double>(10 * p + 3) + time);
  }
}

/// Counts of opening and closing tags of a name; equal in well-formed XML.
std::size_t count_of(const std::string &text, const std::string &word) {
  std::size_t count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

/// Number of each snapshot and the time [s] at which ParaView shows it, in the order of the file.
using Times = std::vector<std::pair<std::string, double>>;
Times times_in(const std::string &xdmf) {
  const std::string collection = "<Grid Name=\"", value = "<Time Value=\"";
  Times times;
  for (auto at = xdmf.find(value); at != std::string::npos; at = xdmf.find(value, at + 1)) {
    const auto grid = xdmf.rfind(collection, at) + collection.size();
    times.emplace_back(xdmf.substr(grid, xdmf.find('"', grid) - grid),
                       std::strtod(xdmf.c_str() + at + value.size(), nullptr));
  }
  return times;
}

/// Files of this process cannot grow beyond a size while this lives: what a full disk does to a writer.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit tight{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &tight);
  }
  FullDisk(const FullDisk &) = delete;
  FullDisk &operator=(const FullDisk &) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }

 private:
  rlimit before_{};
  void (*signal_)(int);
};

/// The complaint of `work`, empty if there was none.
template <class Work>
std::string complaint(Work &&work) {
  try {
    work();
  } catch (const std::runtime_error &error) {
    return error.what();
  }
  return {};
}

/// Whether all ranks hold the same text.
bool agreed(std::string text) {
  std::string first = text;
  unsigned long long size = first.size();
  MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG_LONG, 0, MPI_COMM_WORLD);
  first.resize(size);
  MPI_Bcast(first.data(), static_cast<int>(size), MPI_CHAR, 0, MPI_COMM_WORLD);
  int same = first == text, all;
  MPI_Allreduce(&same, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  return all;
}

TEST(Snapshots, are_read_back_as_written_whatever_the_ranks) {
  const SharedFolder folder;
  RunFile run(MPI_COMM_WORLD, folder / "run", small_header(), small_mesh());
  EXPECT_EQ(run.last_step(), -1);
  run.write(small_snapshot(0, 0));
  run.write(small_snapshot(0.1, 25));
  EXPECT_EQ(run.last_step(), 25);
  if (world_rank()) return;
  EXPECT_EQ(snapshots_in(folder / "run"), 2u);
  expect_snapshot(folder / "run", "000000", 0);
  expect_snapshot(folder / "run", "000001", 0.1);
}

TEST(Snapshots, may_hold_no_particles) {
  const SharedFolder folder;
  RunFile run(MPI_COMM_WORLD, folder / "run", small_header(), small_mesh());
  run.write(small_snapshot(0, 0, 0));
  if (world_rank() == 0) expect_snapshot(folder / "run", "000000", 0, 0);
}

TEST(Snapshots, show_the_mesh_of_all_ranks) {
  const SharedFolder folder;
  RunFile run(MPI_COMM_WORLD, folder / "run", small_header(), small_mesh());
  if (world_rank()) return;
  const auto position = read(folder / "run", "mesh/node_position"), cell = read(folder / "run", "mesh/cell_node");
  const auto ranks = static_cast<std::size_t>(world_size());
  ASSERT_EQ(position.size(), 8 * ranks);
  ASSERT_EQ(cell.size(), 6 * ranks);
  for (std::size_t r = 0; r < ranks; ++r) {
    const auto corner = static_cast<std::size_t>(cell[6 * r]);
    EXPECT_EQ(position[2 * corner], static_cast<double>(r)) << "first corner of the first cell of rank " << r;
  }
}

/// Every reference of an XDMF file, "file:/dataset", leads to a dataset with the stated numbers of columns and at least
/// the stated number of rows (exactly that number, but for the numbers of points).
void expect_references(const std::string &dir, const std::string &xdmf) {
  const std::string start = "<DataItem Dimensions=\"";
  std::size_t references = 0;
  for (auto at = xdmf.find(start); at != std::string::npos; at = xdmf.find(start, at + 1), ++references) {
    hsize_t stated[2], there[2];
    std::istringstream(xdmf.substr(at + start.size(), 40)) >> stated[0] >> stated[1];
    const auto text = xdmf.find('>', at) + 1;
    const std::string reference = xdmf.substr(text, xdmf.find('<', text) - text);
    const auto colon = reference.find(":/");
    const hid_t file = H5Fopen((dir + "/" + reference.substr(0, colon)).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    ASSERT_GE(file, 0) << reference;
    const hid_t set = H5Dopen2(file, reference.substr(colon + 1).c_str(), H5P_DEFAULT), space = H5Dget_space(set);
    ASSERT_EQ(H5Sget_simple_extent_dims(space, there, nullptr), 2) << reference;
    EXPECT_EQ(there[1], stated[1]) << reference;
    if (reference == "run/points.h5:/point")
      EXPECT_GE(there[0], stated[0]);
    else
      EXPECT_EQ(there[0], stated[0]) << reference;
    H5Sclose(space), H5Dclose(set), H5Fclose(file);
  }
  EXPECT_GT(references, 0u);
}

TEST(Snapshots, are_described_to_paraview_in_well_formed_xml) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunHeader header = small_header();
  header.bodies = {"sand & \"silt\"", "clay <2>"};
  RunFile run(MPI_COMM_WORLD, dir, header, small_mesh());
  run.write(small_snapshot(0, 0));
  run.write(small_snapshot(0.1, 10, 300));
  run.write(small_snapshot(0.2, 20, 100));
  if (world_rank()) return;
  const std::string xdmf = content(dir + "/run.xdmf"), mesh = content(dir + "/mesh.xdmf");
  for (const std::string &text : {xdmf, mesh}) {
    for (const std::string tag : {"Grid", "Attribute", "DataItem", "Topology", "Geometry", "Domain", "Xdmf"})
      EXPECT_EQ(count_of(text, "<" + tag + " ") + count_of(text, "<" + tag + ">"), count_of(text, "</" + tag + ">"))
          << tag;
    expect_references(dir, text);
  }
  EXPECT_EQ(times_in(xdmf), (Times{{"000000", 0}, {"000001", 0.1}, {"000002", 0.2}}));  // in all digits
  EXPECT_EQ(count_of(xdmf, "run/000001.h5:/position"), 1u);
  EXPECT_EQ(count_of(xdmf, "Name=\"displacement (m)\""), 3u);
  EXPECT_EQ(count_of(xdmf, "Name=\"stress (Pa, xx yy zz xy)\""), 3u);
  EXPECT_EQ(count_of(xdmf, "Name=\"body (0 sand &amp; &quot;silt&quot;, 1 clay &lt;2>)\""), 3u);
  EXPECT_EQ(xdmf.find("<Attribute"), xdmf.find("<Attribute Name=\"plastic_strain\"")) << "what ParaView colours by";
  EXPECT_EQ(count_of(xdmf, "mesh.h5"), 0u);
  EXPECT_EQ(count_of(mesh, "mesh.h5"), 2u);
  for (const std::string opened : {"run.xdmf", "mesh.xdmf"})
    EXPECT_EQ(count_of(content(dir + "/run.py"), "\"" + opened + "\""), 1u) << opened;
  const hid_t file = H5Fopen((dir + "/run/points.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, "point", H5P_DEFAULT);
  std::vector<long long> point(300);
  EXPECT_GE(H5Dread(set, H5T_NATIVE_LLONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, point.data()), 0);
  for (std::size_t p = 0; p < point.size(); ++p) EXPECT_EQ(point[p], static_cast<long long>(p));
  H5Dclose(set), H5Fclose(file);
}

TEST(Snapshots, of_a_resumed_run_follow_those_before_its_start) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  {
    RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
    for (int n = 0; n < 4; ++n) run.write(small_snapshot(0.1 * n, n));
  }
  RunFile resumed = RunFile::append(MPI_COMM_WORLD, dir, small_header(), small_mesh(), 2);
  EXPECT_EQ(resumed.last_step(), 1);
  resumed.write(small_snapshot(0.15, 2));
  if (world_rank()) return;
  EXPECT_EQ(snapshots_in(dir), 3u);
  expect_snapshot(dir, "000001", 0.1);
  expect_snapshot(dir, "000002", 0.15);
  EXPECT_FALSE(std::filesystem::exists(dir + "/run/000003.h5"));
  EXPECT_EQ(times_in(content(dir + "/run.xdmf")), (Times{{"000000", 0}, {"000001", 0.1}, {"000002", 0.15}}));
  EXPECT_EQ(count_of(content(dir + "/run.xdmf"), "Name=\"stress (Pa, xx yy zz xy)\""), 3u);  // also of those before
  expect_references(dir, content(dir + "/run.xdmf"));
}

TEST(Snapshots, of_an_older_run_give_way) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  {
    RunFile older(MPI_COMM_WORLD, dir, small_header(), small_mesh());
    for (int n = 0; n < 3; ++n) older.write(small_snapshot(n, n));
  }
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  run.write(small_snapshot(5, 5));
  if (world_rank()) return;
  EXPECT_EQ(snapshots_in(dir), 1u);
  expect_snapshot(dir, "000000", 5);
  EXPECT_FALSE(std::filesystem::exists(dir + "/run/000002.h5"));
}

TEST(Snapshots, complain_on_all_ranks_about_a_folder_that_cannot_be) {
  const SharedFolder folder;
  if (world_rank() == 0) std::ofstream(folder / "taken") << "a file";
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string said = complaint([&] { RunFile(MPI_COMM_WORLD, folder / "taken", small_header(), small_mesh()); });
  EXPECT_NE(said.find("taken"), std::string::npos) << said;
  EXPECT_NE(said.find("Not a directory"), std::string::npos) << said;
  EXPECT_TRUE(agreed(said));
}

TEST(Snapshots, that_are_damaged_are_left_out_when_a_run_is_resumed) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  {
    RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
    for (int n = 0; n < 3; ++n) run.write(small_snapshot(0.1 * n, n));
  }
  if (world_rank() == 0) {
    std::ofstream(dir + "/run.h5") << "no index";
    std::ofstream(dir + "/run/mesh.h5") << "no mesh";
    std::filesystem::resize_file(dir + "/run/000001.h5", 1000);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  RunFile resumed = RunFile::append(MPI_COMM_WORLD, dir, small_header(), small_mesh(), 3);
  EXPECT_EQ(resumed.last_step(), 2);
  resumed.write(small_snapshot(0.3, 3));
  if (world_rank()) return;
  ASSERT_EQ(resumed.damaged().size(), 1u);
  EXPECT_NE(resumed.damaged()[0].find("run/000001.h5"), std::string::npos) << resumed.damaged()[0];
  EXPECT_EQ(snapshots_in(dir), 3u);
  expect_snapshot(dir, "000000", 0);
  expect_snapshot(dir, "000003", 0.3);
  EXPECT_EQ(times_in(content(dir + "/run.xdmf")), (Times{{"000000", 0}, {"000002", 0.2}, {"000003", 0.3}}));
}

/// The last snapshot of the state that is resumed keeps its number and its file.
TEST(Snapshots, that_are_damaged_and_last_are_not_overwritten) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  {
    RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
    for (int n = 0; n < 3; ++n) run.write(small_snapshot(0.1 * n, n));
  }
  if (world_rank() == 0) std::ofstream(dir + "/run/000002.h5") << "damaged";
  MPI_Barrier(MPI_COMM_WORLD);
  RunFile resumed = RunFile::append(MPI_COMM_WORLD, dir, small_header(), small_mesh(), 3);
  EXPECT_EQ(resumed.count(), 3);
  resumed.write(small_snapshot(0.3, 3));
  EXPECT_EQ(resumed.count(), 4);
  if (world_rank()) return;
  ASSERT_EQ(resumed.damaged().size(), 1u);
  EXPECT_NE(resumed.damaged()[0].find("is left out of run.h5 and run.xdmf: cannot open"), std::string::npos);
  EXPECT_EQ(content(dir + "/run/000002.h5"), "damaged");
  EXPECT_EQ(times_in(content(dir + "/run.xdmf")), (Times{{"000000", 0}, {"000001", 0.1}, {"000003", 0.3}}));
}

/// Snapshots behind the state that is resumed are written again: under their numbers, and over no file that might be
/// read some day.
TEST(Snapshots, that_are_damaged_and_written_again_are_kept_under_another_name) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  {
    RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
    for (int n = 0; n < 3; ++n) run.write(small_snapshot(0.1 * n, n));
  }
  for (const std::string name : {"run/000002.unreadable.h5", "run/000002.unreadable.2.h5"}) {
    if (world_rank() == 0) std::ofstream(dir + "/run/000002.h5") << "damaged " << name;
    MPI_Barrier(MPI_COMM_WORLD);
    RunFile resumed = RunFile::append(MPI_COMM_WORLD, dir, small_header(), small_mesh(), 2);
    resumed.write(small_snapshot(0.2, 2));
    if (world_rank()) continue;
    ASSERT_EQ(resumed.damaged().size(), 1u);
    EXPECT_NE(resumed.damaged()[0].find("is kept as " + name), std::string::npos) << resumed.damaged()[0];
    EXPECT_EQ(content(dir + "/" + name), "damaged " + name);
    EXPECT_EQ(times_in(content(dir + "/run.xdmf")), (Times{{"000000", 0}, {"000001", 0.1}, {"000002", 0.2}}));
  }
}

/// HDF5 keeps the identifier of a file that the system did not close, and crashes the program when it comes upon it at
/// the end. Nothing is lost where such a file was only read.
TEST(Snapshots, that_the_system_does_not_close_leave_nothing_behind) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  {
    RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
    for (int n = 0; n < 3; ++n) run.write(small_snapshot(0.1 * n, n));
  }
  snapshots_close = false;
  const RunFile resumed = RunFile::append(MPI_COMM_WORLD, dir, small_header(), small_mesh(), 3);
  snapshots_close = true;
  EXPECT_TRUE(resumed.damaged().empty());
  EXPECT_EQ(resumed.last_step(), 2);
  EXPECT_EQ(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_FILE), 0);
}

TEST(Snapshots, complain_about_columns_that_do_not_fit) {
  const SharedFolder folder;
  RunFile run(MPI_COMM_WORLD, folder / "run", small_header(), small_mesh());
  Snapshot broken = small_snapshot(0, 0);
  if (world_rank() == world_size() - 1) broken.columns[0].values.push_back(1);
  const std::string said = complaint([&] { run.write(broken); });
  EXPECT_NE(said.find("position"), std::string::npos) << said;
  EXPECT_TRUE(agreed(said));
}

TEST(Snapshots, survive_a_full_disk) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  run.write(small_snapshot(0, 0));
  run.write(small_snapshot(1, 1));
  for (const rlim_t room : {0, 1000, 10000}) {  // enough for no file, for a start of one, for the doors but no snapshot
    const FullDisk full(room);
    const std::string said = complaint([&] { run.write(small_snapshot(2, 2, 2000)); });
    EXPECT_NE(said.find("run/000002.h5"), std::string::npos) << said;
    EXPECT_NE(said.find("File too large"), std::string::npos) << said;
    EXPECT_TRUE(agreed(said));
  }
  EXPECT_EQ(run.last_step(), 1);
  if (world_rank() == 0) {
    EXPECT_EQ(snapshots_in(dir), 2u);
    expect_snapshot(dir, "000000", 0);
    expect_snapshot(dir, "000001", 1);
    EXPECT_FALSE(std::filesystem::exists(dir + "/run/000002.h5.part"));
  }
  MPI_Barrier(MPI_COMM_WORLD);
  run.write(small_snapshot(2, 2, 2000));  // there is room again
  if (world_rank() == 0) expect_snapshot(dir, "000002", 2, 2000);
}

/// Many rows are written by several ranks; 60 stand for the millions of RunFile::rows_of_a_writer.
constexpr long long few_rows = 60;

int parts_of(const std::string &dir, const std::string &name) {
  int count = 0;
  for (const auto &file : std::filesystem::directory_iterator(dir + "/run"))
    count += file.path().filename().string().find(name + ".part") == 0;
  return count;
}

TEST(Snapshots, of_many_particles_are_written_by_several_ranks_and_read_like_one_file) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh(), few_rows);
  run.write(small_snapshot(0, 0));
  run.write(small_snapshot(0.1, 25, 70));
  run.write(small_snapshot(0.2, 50, 50));
  if (world_rank()) return;
  expect_snapshot(dir, "000000", 0);
  expect_snapshot(dir, "000001", 0.1, 70);
  expect_snapshot(dir, "000002", 0.2, 50);
  const int ranks = world_size(), alone = 0;  // one writer has no parts
  EXPECT_EQ(parts_of(dir, "000000"), ranks == 1 ? alone : std::min(ranks, 4));
  EXPECT_EQ(parts_of(dir, "000001"), ranks == 1 ? alone : 2);
  EXPECT_EQ(parts_of(dir, "000002"), alone);
  expect_references(dir, content(dir + "/run.xdmf"));
}

TEST(Snapshots, show_a_large_mesh_that_several_ranks_write) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh(), 5);
  if (world_rank()) return;
  const auto ranks = static_cast<std::size_t>(world_size());
  EXPECT_EQ(parts_of(dir, "mesh"), ranks == 1 ? 0 : ranks == 2 ? 2 : 4);
  const auto position = read(dir, "mesh/node_position"), cell = read(dir, "mesh/cell_node");
  ASSERT_EQ(position.size(), 8 * ranks);
  ASSERT_EQ(cell.size(), 6 * ranks);
  for (std::size_t r = 0; r < ranks; ++r)
    EXPECT_EQ(position[2 * static_cast<std::size_t>(cell[6 * r])], static_cast<double>(r)) << "of rank " << r;
  expect_references(dir, content(dir + "/mesh.xdmf"));
}

TEST(Snapshots, whose_parts_are_missing_or_strange_are_left_out) {
  if (world_size() == 1) return;  // one rank writes no parts
  const SharedFolder folder;
  const std::string dir = folder / "run";
  {
    RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh(), few_rows);
    for (int n = 0; n < 4; ++n) run.write(small_snapshot(0.1 * n, n, n == 3 ? 120 : 200));
  }
  if (world_rank() == 0) {
    std::filesystem::remove(dir + "/run/000000.part1.h5");
    std::filesystem::resize_file(dir + "/run/000001.part0.h5", 100);
    std::filesystem::copy_file(dir + "/run/000003.part1.h5", dir + "/run/000002.part0.h5",
                               std::filesystem::copy_options::overwrite_existing);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  RunFile resumed = RunFile::append(MPI_COMM_WORLD, dir, small_header(), small_mesh(), 4, few_rows);
  if (world_rank()) return;
  const std::string cause[] = {"000000.part1.h5", "000001.part0.h5",
                               "000002.h5 joins files that do not belong together"};
  ASSERT_EQ(resumed.damaged().size(), 3u);
  for (int n = 0; n < 3; ++n) EXPECT_NE(resumed.damaged()[n].find(cause[n]), std::string::npos) << resumed.damaged()[n];
  EXPECT_EQ(times_in(content(dir + "/run.xdmf")), (Times{{"000003", 0.1 * 3}}));
}

TEST(Snapshots, in_parts_give_way_with_them) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  {
    RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh(), few_rows);
    for (int n = 0; n < 3; ++n) run.write(small_snapshot(0.1 * n, n));
  }
  MPI_Barrier(MPI_COMM_WORLD);
  {
    RunFile resumed = RunFile::append(MPI_COMM_WORLD, dir, small_header(), small_mesh(), 2, few_rows);
    if (world_rank() == 0) {
      EXPECT_EQ(parts_of(dir, "000002"), 0);
    }
    resumed.write(small_snapshot(0.15, 2, 70));
  }
  if (world_rank() == 0) expect_snapshot(dir, "000001", 0.1), expect_snapshot(dir, "000002", 0.15, 70);
  MPI_Barrier(MPI_COMM_WORLD);
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  run.write(small_snapshot(5, 5));
  if (world_rank()) return;
  expect_snapshot(dir, "000000", 5);
  EXPECT_EQ(parts_of(dir, ""), 0);
}

TEST(Snapshots, in_parts_survive_a_full_disk) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh(), few_rows);
  run.write(small_snapshot(0, 0));
  {
    const FullDisk full(10000);
    const std::string said = complaint([&] { run.write(small_snapshot(2, 2, 2000)); });
    EXPECT_NE(said.find("File too large"), std::string::npos) << said;
    EXPECT_TRUE(agreed(said));
  }
  if (world_rank() == 0) {
    expect_snapshot(dir, "000000", 0);
    EXPECT_EQ(parts_of(dir, "000001"), 0);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  run.write(small_snapshot(2, 2, 2000));  // there is room again
  if (world_rank() == 0) expect_snapshot(dir, "000001", 2, 2000);
}

}  // namespace
}  // namespace talus
