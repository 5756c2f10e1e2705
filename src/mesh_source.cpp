#include "mesh_source.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include "meshes/mesh_request.h"
#include "scene/mesh_source.h"
#include "scene/place_grid.h"
#include "scene/reader.h"
#include "scene/scene.h"

extern char **environ;

namespace talus {
namespace {

const MeshRun no_folder{1, "cannot make a folder for temporary files; set TMPDIR to one that can be written"};

/// talus-mesh stands beside the program that runs.
std::string talus_mesh_path() {
  const std::filesystem::path beside = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "talus-mesh";
  return std::filesystem::exists(beside) ? beside.string() : TALUS_MESH_PROGRAM;
}

/// What talus-mesh is asked for.
MeshRequest request_of(const Scene &scene) {
  MeshRequest request{scene.dimension, *scene.mesh};
  MeshSource &mesh = request.mesh;
  const MeshSource usual;
  mesh.leaving_particles = usual.leaving_particles, mesh.balance_ranks = usual.balance_ranks;  // of the run
  if (scene.dimension == 2) mesh.thickness = usual.thickness, mesh.layers = usual.layers, mesh.cuts = usual.cuts;
  return request;
}

/// Runs talus-mesh with arguments.
MeshRun start_talus_mesh(const std::vector<std::string> &arguments) {
  const std::string program = talus_mesh_path();
  std::vector<char *> argv{const_cast<char *>(program.c_str())};
  for (const std::string &a : arguments) argv.push_back(const_cast<char *>(a.c_str()));
  argv.push_back(nullptr);
  int ends[2];
  if (pipe(ends)) return {1, "cannot make a pipe"};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addclose(&actions, ends[1]);
  pid_t child;
  const int error = posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error) {
    close(ends[0]);
    return {1, "cannot start " + program};
  }
  MeshRun run{1, ""};
  std::array<char, 4096> block;
  for (ssize_t n; (n = read(ends[0], block.data(), block.size())) > 0;) run.output.append(block.data(), n);
  close(ends[0]);
  int status;
  waitpid(child, &status, 0);
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
    interrupted = 1;  // from outside, as this program could have been: the scene has not failed
    run.output += "talus-mesh was killed, as the system does where memory does not suffice";
  }
  return run;
}

/// What talus-mesh said, without its name and the end of the line.
MeshRun plain(MeshRun run) {
  const std::string speaker = "talus-mesh: ";
  if (run.output.starts_with(speaker)) run.output.erase(0, speaker.size());
  while (run.output.ends_with('\n')) run.output.pop_back();
  return run;
}

/// Notes which key of a scene has the place of an option of a command line: mesh.terrain.far_size for far-size.
struct KeysOfOptions {
  std::map<std::string, std::string> keys{};
  std::string table_of_keys{};

  void note(const char *key) {
    std::string option = key;
    std::ranges::replace(option, '_', '-');
    keys[option] = table_of_keys + key;
  }
  void number(const char *key, double &, Unit, Range, const char *) { note(key); }
  void integer(const char *key, int &, Range, const char *) { note(key); }
  void path(const char *key, std::string &, const char *) { note(key); }
  void point(const char *key, std::vector<double> &, Unit, const char *) { note(key); }
  void points(const char *key, std::vector<std::vector<double>> &, Unit, const char *) { note(key); }
  template <class Enum>
  void choice(const char *key, Enum &, std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>>,
              const char *) {
    note(key);
  }
  template <class Struct>
  void list(const char *key, std::vector<Struct> &, const char *) {
    note(key);
  }
  template <class Struct>
  void named(const char *key, std::vector<Struct> &, const char *) {
    note(key);
  }
  template <class Struct>
  void table(const char *key, Struct &value, const char *) {
    note(key);
    const std::string outer = table_of_keys;
    table_of_keys += std::string(key) + ".";
    value.fields(*this);
    table_of_keys = outer;
  }
};

/// With the keys of a scene in place of options of talus-mesh: mesh.size for --size.
std::string in_keys(const std::string &text) {
  static const std::map<std::string, std::string> key_of = [] {
    MeshRequest request;
    KeysOfOptions noted;
    request.fields(noted);
    return noted.keys;
  }();
  static const std::regex option(
      "(^|[ (])--([a-z][a-z-]*)(?![a-z=-])");  // no part of a file's name, nor other programs' --key=value
  std::string keys;
  std::size_t end = 0;
  for (std::sregex_iterator one(text.begin(), text.end(), option), last; one != last; ++one) {
    const auto key = key_of.find(one->str(2));
    if (key == key_of.end()) continue;
    keys += text.substr(end, one->position() - end) + one->str(1) + key->second;
    end = one->position() + one->length();
  }
  return keys + text.substr(end);
}

/// A mesh that is kept for the next run that asks for the same, in the folder that the environment variable
/// TALUS_KEPT_MESHES names: the many small runs of tests would spend much of their time in the start of talus-mesh. Its
/// name is a digest of the program, of its request and of the contents of the section. What goes wrong with it costs
/// time only, and nothing is said of it.
class KeptMesh {
 public:
  explicit KeptMesh(MeshRequest request) {
    const char *folder = std::getenv("TALUS_KEPT_MESHES");
    if (!folder || !*folder) return;
    const std::filesystem::path program = talus_mesh_path(), section = std::exchange(request.mesh.section, "");
    std::error_code error;
    const auto built = std::filesystem::last_write_time(program, error).time_since_epoch().count();
    std::ifstream file(section, std::ios::binary);
    if (!file || error) return;
    std::ostringstream recipe;
    recipe << program << ' ' << built << ' ' << section.extension() << ' ' << text_of(request) << '\n' << file.rdbuf();
    std::ostringstream name;
    name << std::hex << std::hash<std::string>()(recipe.str()) << ".msh";
    path_ = std::filesystem::path(folder) / name.str();
  }

  bool copy_to(const std::string &mesh) const {
    std::error_code error;
    return !path_.empty() && std::filesystem::copy_file(path_, mesh, overwrite, error);
  }

  /// The copy gets its name when it is complete.
  void keep(const std::string &mesh) const {
    if (path_.empty()) return;
    std::error_code error;
    const std::filesystem::path part = path_.string() + "-" + std::to_string(getpid());
    std::filesystem::create_directories(path_.parent_path(), error);
    if (std::filesystem::copy_file(mesh, part, overwrite, error)) std::filesystem::rename(part, path_, error);
    if (error) std::filesystem::remove(part, error);
  }

 private:
  static constexpr auto overwrite = std::filesystem::copy_options::overwrite_existing;
  std::filesystem::path path_;  ///< empty: none is kept
};

/// All ranks learn how a run of talus-mesh on rank 0 has ended. The others sleep until then: a rank that waits within
/// MPI keeps its core busy, on which talus-mesh could run.
void tell_all(MPI_Comm comm, int &status, std::string &complaint) {
  MPI_Request request;
  MPI_Ibcast(&status, 1, MPI_INT, 0, comm, &request);
  for (int ended = 0; MPI_Test(&request, &ended, MPI_STATUS_IGNORE), !ended;)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  int length = static_cast<int>(complaint.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, comm);
  complaint.resize(length);
  MPI_Bcast(complaint.data(), length, MPI_CHAR, 0, comm);
}

/// By FNV-1a, which finds edited files and not forged ones.
std::string digest_of(const Grid &grid) {
  std::uint64_t digest = 14695981039346656037u;
  const auto take = [&](double value) { digest = (digest ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211u; };
  for (const double number : {grid.west, grid.south, grid.spacing, static_cast<double>(grid.columns)}) take(number);
  for (const double value : grid.values) take(value);
  std::ostringstream text;
  text << std::hex << digest;
  return text.str();
}

/// Value at a key of a document of an origin (Terrain::origin_document), or another one where it has none.
template <class Value>
Value value_in(const std::string &document, const std::string &key, const Value &otherwise) {
  try {
    return nlohmann::json::parse(document).at(key).get<Value>();
  } catch (const nlohmann::json::exception &) {
    return otherwise;
  }
}

/// What talus-mesh has warned of.
std::vector<std::string> warnings_in(const std::string &printed) {
  std::vector<std::string> sentences;
  std::istringstream lines(printed);
  const std::string warning = "warning: ";
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(warning)) sentences.push_back(line.substr(warning.size()));
  return sentences;
}

/// Reads a grid by way of talus-mesh, which writes its values into a plain file: GDAL stays out of this program.
MeshRun values_of(const std::string &file, const std::string &document, Grid &grid) {
  TemporaryFolder folder;
  if (!folder.make()) return no_folder;
  const std::string values = folder.path() + "/values";
  std::vector<std::string> arguments{"--values", file, "-o", values};
  const auto text = [&](const char *key) { return value_in(document, key, std::string()); };
  if (const std::string projection = text("projection"); !projection.empty())
    arguments.insert(arguments.end(), {"--projection", projection, "--projection-of", text("terrain")});
  MeshRun run = plain(start_talus_mesh(arguments));
  if (run.status) return run;
  std::ifstream in(values, std::ios::binary);
  in >> grid.columns >> grid.rows >> grid.west >> grid.south >> grid.spacing;
  in.ignore();  // the end of the line
  if (in) grid.values.resize(static_cast<std::size_t>(grid.columns) * grid.rows);
  in.read(reinterpret_cast<char *>(grid.values.data()),
          static_cast<std::streamsize>(grid.values.size() * sizeof(double)));
  if (!in) return {1, "the values that talus-mesh has written end early; make room in the folder for temporary files"};
  return run;
}

}  // namespace

MeshRun run_talus_mesh(const MeshRequest &request, const std::string &file, const std::string &format) {
  TemporaryFolder folder;
  if (!folder.make()) return no_folder;
  const std::string name = folder.path() + "/request.json";
  if (!(std::ofstream(name) << text_of(request) << std::flush))
    return {1, "cannot write " + name + "; make room in the folder for temporary files"};
  return start_talus_mesh({"--request", name, "-o", file, "--format", format});
}

MeshFile::MeshFile(MPI_Comm comm, const Scene &scene) {
  const MeshSource &source = *scene.mesh;
  int rank;
  MPI_Comm_rank(comm, &rank);
  if (!source.file.empty()) {
    path_ = source.file;
    if (rank == 0) read_origin(std::filesystem::path(path_).replace_extension(".origin.json"));
    MPI_Bcast(origin_.data(), 2, MPI_DOUBLE, 0, comm);
    int terrain = !made_.origin.empty();
    MPI_Bcast(&terrain, 1, MPI_INT, 0, comm);
    if (terrain && scene.vertical() != 2)
      scene.complain("mesh.file",
                     "is a mesh of terrain, whose elevations are z, as the .origin.json beside it says: set "
                     "dimension = 3 and up = \"z\"");
    return;
  }
  int status = 0;
  std::string complaint;
  if (rank == 0) {
    const MeshRun run = make(scene);
    status = run.status, complaint = run.output;
    if (status == 0) read_report(run.output);
  }
  tell_all(comm, status, complaint);
  MPI_Bcast(origin_.data(), 2, MPI_DOUBLE, 0, comm);
  const bool terrain = !source.terrain.file.empty();
  if (status == 2) scene.complain(terrain ? "mesh.terrain" : "mesh.section", "cannot be meshed: " + complaint);
  if (status)
    throw std::runtime_error("no mesh could be made from " + (terrain ? source.terrain.file : source.section) + ": " +
                             complaint);
}

/// Warnings in what talus-mesh printed, and the origin that it has left beside the mesh.
void MeshFile::read_report(const std::string &printed) {
  made_.remarks = warnings_in(printed);
  read_origin(folder_.path() + "/mesh.origin.json");
}

/// The document of the origin, and its two numbers; without the file x and y are those of the mesh.
void MeshFile::read_origin(const std::string &name) {
  std::ostringstream document;
  if (std::ifstream file(name); file) document << file.rdbuf();
  made_.origin = document.str();
  origin_ = value_in(made_.origin, "origin_m", origin_);
}

MeshRun MeshFile::make(const Scene &scene) {
  if (!folder_.make()) return no_folder;
  path_ = folder_.path() + "/mesh.msh";
  const MeshRequest request = request_of(scene);
  std::optional<KeptMesh> kept;
  if (!request.mesh.section.empty() && kept.emplace(request).copy_to(path_)) return {0, ""};
  MeshRun run = plain(run_talus_mesh(request, path_));
  if (kept && run.status == 0 && warnings_in(run.output).empty()) kept->keep(path_);  // it has nothing to say again
  run.output = in_keys(run.output);
  return run;
}

std::vector<std::string> read_grids(MPI_Comm comm, const Scene &scene, std::array<double, 2> origin,
                                    const std::string &document) {
  std::vector<std::string> remarks;
  if (!scene.root) return remarks;  // a scene made in memory names no files
  int rank;
  MPI_Comm_rank(comm, &rank);
  for (const auto &[name, place_grid] : scene.root->grids()) {
    const std::string key = "grids." + name;
    int status = 0;
    std::string complaint;
    Grid &grid = place_grid->grid;
    if (rank == 0) {
      const MeshRun run = values_of(place_grid->file, document, grid);
      status = run.status, complaint = run.output;
      for (const std::string &sentence : warnings_in(run.output)) remarks.push_back(key + ": " + sentence);
    }
    tell_all(comm, status, complaint);
    if (status == 2) scene.complain(key, "cannot be read: " + complaint);
    if (status) throw std::runtime_error(key + " cannot be read: " + complaint);
    MPI_Bcast(&grid.columns, 1, MPI_INT, 0, comm);
    MPI_Bcast(&grid.rows, 1, MPI_INT, 0, comm);
    for (double *number : {&grid.west, &grid.south, &grid.spacing}) MPI_Bcast(number, 1, MPI_DOUBLE, 0, comm);
    grid.values.resize(static_cast<std::size_t>(grid.columns) * grid.rows);
    for (int row = 0; row < grid.rows; ++row)  // in parts, since MPI counts by int
      MPI_Bcast(&grid.values[static_cast<std::size_t>(row) * grid.columns], grid.columns, MPI_DOUBLE, 0, comm);
    place_grid->origin = origin, place_grid->digest = digest_of(grid);
  }
  return remarks;
}

}  // namespace talus
