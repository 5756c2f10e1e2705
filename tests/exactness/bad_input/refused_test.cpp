// Bad input: the program ends with status 2 before it writes results, and says where the fault is and what would be
// right.
#include "refused.h"

namespace talus {
namespace {

TALUS_REFUSES(Scenes, "scenes.txt");      // text, and keys that contradict each other or the mesh
TALUS_REFUSES(Keys, "keys.txt");          // single keys: range, type, unit; unknown keys of every table
TALUS_REFUSES(Sections, "sections.txt");  // files of sections
TALUS_REFUSES(Meshes, "meshes.txt");      // files of meshes

}  // namespace
}  // namespace talus
