#pragma once
/// What the keys of structures demand of one another and of the rest of the scene.
namespace talus {

struct Scene;
class TableReader;

/// Complains at the key's place in the file. Points of a section that is drawn out lie in its middle.
void check_structures(Scene &scene, const TableReader &reader);

}  // namespace talus
