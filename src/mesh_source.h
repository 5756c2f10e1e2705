#pragma once
/// Finds or makes the mesh of a scene: a Gmsh file as it is, or a section handed to the program talus-mesh.
#include <mpi.h>

#include <string>

#include "scene/scene.h"

namespace talus {

/// Path of the .msh file of a scene, made in `directory` where the scene gives a section; collective. Throws
/// std::invalid_argument with talus-mesh's own complaint, the same on all ranks.
std::string mesh_file(MPI_Comm comm, const Scene &scene, const std::string &directory);

/// Runs talus-mesh with arguments; returns its exit status and what it printed.
struct MeshRun {
  int status;
  std::string output;
};
MeshRun run_talus_mesh(const std::vector<std::string> &arguments);

/// `path` as written in a scene: relative to the scene's own folder.
std::string beside_scene(const Scene &scene, const std::string &path);

}  // namespace talus
