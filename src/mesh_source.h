#pragma once
/// Finds or makes the mesh of a scene: a Gmsh file as it is, or a section or terrain handed to the program talus-mesh.
#include <mpi.h>

#include <array>
#include <string>
#include <vector>

#include "base/temporary_folder.h"
#include "simulation.h"

namespace talus {

struct MeshRequest;

/// Exit status of talus-mesh, and what it printed.
struct MeshRun {
  int status;
  std::string output;
};
/// Has talus-mesh make a mesh and write it into a file of this format.
MeshRun run_talus_mesh(const MeshRequest &request, const std::string &file, const std::string &format = "4.1");

/// The .msh file of a scene, for rank 0 to read: its own, or one made from its section or terrain that goes with this
/// object.
class MeshFile {
 public:
  /// Collective. Throws std::invalid_argument with talus-mesh's own complaint, the same on all ranks.
  MeshFile(MPI_Comm comm, const Scene &scene);
  const std::string &path() const { return path_; }
  const MadeMesh &made() const { return made_; }
  /// Of the mesh in the coordinates of its terrain, on all ranks; zero where there is none [m].
  std::array<double, 2> origin() const { return origin_; }

 private:
  MeshRun make(const Scene &scene);
  void read_report(const std::string &printed);
  void read_origin(const std::string &file);

  TemporaryFolder folder_;
  std::string path_;
  MadeMesh made_;
  std::array<double, 2> origin_{};
};

/// Reads the grids of [grids], which count from this origin of the mesh, on rank 0 and hands their values to all.
/// `document` says where the mesh lies, as MadeMesh::origin does; grids of another projection are refused. Returns what
/// is to be said of them, on rank 0. Collective. Throws std::invalid_argument with talus-mesh's own complaint, the same
/// on all ranks.
std::vector<std::string> read_grids(MPI_Comm comm, const Scene &scene, std::array<double, 2> origin,
                                    const std::string &document);

}  // namespace talus
