#include "mesh_source.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

extern char **environ;

namespace talus {
namespace {

std::string number(double x) {
  std::ostringstream s;
  s.precision(17);
  s << x;
  return s.str();
}

/// talus-mesh stands beside the program that runs.
std::string talus_mesh_path() {
  const std::filesystem::path beside = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "talus-mesh";
  return std::filesystem::exists(beside) ? beside.string() : TALUS_MESH_PROGRAM;
}

/// What talus-mesh is asked for.
std::vector<std::string> of_section(const Scene &scene, const std::string &file) {
  const MeshSource &source = scene.mesh;
  std::vector<std::string> arguments{
      beside_scene(scene, source.section), "-o", file, "--size", number(source.size), "--dimension",
      std::to_string(scene.dimension)};
  if (scene.dimension == 3) {
    arguments.insert(arguments.end(), {"--layers", std::to_string(source.layers)});
    if (source.thickness > 0) arguments.insert(arguments.end(), {"--thickness", number(source.thickness)});
    for (double cut : source.cuts) arguments.insert(arguments.end(), {"--cuts", number(cut)});
  }
  for (const RefineBox &box : source.refine)
    arguments.insert(arguments.end(), {"--refine", number(box.from[0]), number(box.from[1]), number(box.to[0]),
                                       number(box.to[1]), number(box.size)});
  return arguments;
}

std::vector<std::string> of_terrain(const Scene &scene, const std::string &file) {
  const TerrainSource &t = scene.mesh.terrain;
  std::vector<std::string> arguments{
      beside_scene(scene, t.file), "-o", file, "--size", number(scene.mesh.size), "--step", std::to_string(t.step)};
  const auto add = [&](const char *option, const std::vector<double> &values) {
    arguments.push_back(option);
    for (const double value : values) arguments.push_back(number(value));
  };
  if (!t.window.empty()) add("--window", t.window);
  if (!t.base.empty()) add("--base", t.base);
  if (t.air > 0) add("--air", {t.air});
  if (t.far_size > 0) add("--far-size", {t.far_size});
  if (!t.slip_surface.empty())
    arguments.insert(arguments.end(), {"--slip-surface", beside_scene(scene, t.slip_surface)});
  if (const EllipsoidSource &e = t.ellipsoid; e.given)
    add("--ellipsoid", {e.centre[0], e.centre[1], e.centre[2], e.semi_axes[0], e.semi_axes[1], e.semi_axes[2],
                        e.dip / degree.si, e.dip_direction / degree.si});
  return arguments;
}

}  // namespace

MeshRun run_talus_mesh(const std::vector<std::string> &arguments) {
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
  return run;
}

std::string beside_scene(const Scene &scene, const std::string &path) {
  const std::filesystem::path p(path);
  return p.is_absolute() ? path : (std::filesystem::path(scene.file).parent_path() / p).lexically_normal().string();
}

MeshFile::MeshFile(MPI_Comm comm, const Scene &scene) {
  const MeshSource &source = scene.mesh;
  if (!source.file.empty()) {
    path_ = beside_scene(scene, source.file);
    return;
  }
  int rank, status = 0;
  MPI_Comm_rank(comm, &rank);
  std::string complaint;
  if (rank == 0) {
    const MeshRun run = make(scene);
    status = run.status, complaint = run.output;
    if (status == 0) read_report(run.output);
  }
  MPI_Bcast(&status, 1, MPI_INT, 0, comm);
  int length = static_cast<int>(complaint.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, comm);
  complaint.resize(length);
  MPI_Bcast(complaint.data(), length, MPI_CHAR, 0, comm);
  const bool terrain = !source.terrain.file.empty();
  if (status == 2) scene.complain(terrain ? "mesh.terrain" : "mesh.section", "cannot be meshed: " + complaint);
  if (status)
    throw std::runtime_error("no mesh could be made from " + (terrain ? source.terrain.file : source.section) + ": " +
                             complaint);
}

/// Warnings in what talus-mesh printed, and the origin that it has left beside the mesh.
void MeshFile::read_report(const std::string &printed) {
  std::istringstream lines(printed);
  const std::string warning = "warning: ";
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(warning)) made_.remarks.push_back(line.substr(warning.size()));
  std::ostringstream origin;
  if (std::ifstream file(folder_.path() + "/mesh.origin.json"); file) origin << file.rdbuf();
  made_.origin = origin.str();
}

MeshRun MeshFile::make(const Scene &scene) {
  const MeshSource &source = scene.mesh;
  if (!folder_.make()) return {1, "cannot make a folder for temporary files; set TMPDIR to one that can be written"};
  path_ = folder_.path() + "/mesh.msh";
  MeshRun run = run_talus_mesh(source.section.empty() ? of_terrain(scene, path_) : of_section(scene, path_));
  const std::string speaker = "talus-mesh: ";
  if (run.output.starts_with(speaker)) run.output.erase(0, speaker.size());
  while (run.output.ends_with('\n')) run.output.pop_back();
  return run;
}

}  // namespace talus
