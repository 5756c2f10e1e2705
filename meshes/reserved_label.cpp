// Apart from plex.cpp, so that the reader of Gmsh files needs no PETSc where it is tested alone.
#include <set>

#include "meshes/plex.h"

namespace talus {

bool is_reserved_label(const std::string &name) {
  static const std::set<std::string> reserved{"depth",     "celltype",  "dim",         "ghost",    "marker",
                                              "Cell Sets", "Face Sets", "Vertex Sets", "Edge Sets"};
  return reserved.count(name) > 0;
}

}  // namespace talus
