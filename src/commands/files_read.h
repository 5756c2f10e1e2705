#pragma once
/// State of the files that a scene reads, by which a later call sees whether a run has to be repeated.
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace talus {

/// Reads each file once, however many scenes name it.
class FilesRead {
 public:
  /// A line "SIZE DIGEST PATH" for each file that the scene names: mesh, section, terrain, grids, libraries and all
  /// others of TableReader::files, with the files that belong to them (projection, table of a Shapefile, origin of a
  /// mesh). Of a folder of results those of its checkpoint. A file that is not there has no line.
  std::vector<std::string> of(const Scene &scene);

 private:
  std::map<std::string, std::string> known_;  ///< path: line
};

/// The path of a line.
std::string path_of(const std::string &line);

}  // namespace talus
