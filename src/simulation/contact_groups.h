#pragma once
/// Groups of bodies that meet in contact, and what a scene may ask of them.
#include <array>
#include <string>
#include <vector>

namespace talus {

struct Scene;

struct ContactGroups {
  std::vector<std::string> name;  ///< in the order of their first bodies
  std::vector<int> of_body;

  /// Number of a name, -1 if there is none.
  int find(const std::string &wanted) const;
  /// Regions of the bodies of each group.
  std::vector<std::vector<std::string>> regions(const Scene &scene) const;
  /// The two groups of each contact of the scene.
  std::vector<std::array<int, 2>> pairs(const Scene &scene) const;
};
ContactGroups contact_groups(const Scene &scene);

/// Complains of contacts that the scene cannot have, of groups without one, and of what does not act beside several
/// groups. `host`: the mesh is that of a host program.
void check_contacts(const Scene &scene, bool host);

}  // namespace talus
