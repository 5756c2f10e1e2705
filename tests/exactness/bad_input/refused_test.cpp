// Bad input: the program ends with status 2 before it writes results, and says where the fault is and what would be
// right.
#include "refused.h"

namespace talus {
namespace {

TALUS_REFUSES(Scenes, "scenes.txt", "run", "check");      // text, and keys that contradict each other or the mesh
TALUS_REFUSES(Keys, "keys.txt", "run");                   // single keys, which one reader reads for all commands
TALUS_REFUSES(Sections, "sections.txt", "run", "check");  // files of sections
TALUS_REFUSES(Meshes, "meshes.txt", "run", "check");      // files of meshes

}  // namespace
}  // namespace talus
