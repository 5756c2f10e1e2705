#include "simulation/contact_groups.h"

#include <algorithm>
#include <set>

#include "physics/boundary/boundary.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/contact_source.h"
#include "scene/output_source.h"
#include "scene/reader.h"
#include "scene/rigid_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/structure_source.h"
#include "scene/words.h"
#include "simulation/dynamics.h"

namespace talus {

int ContactGroups::find(const std::string &wanted) const {
  const auto found = std::ranges::find(name, wanted);
  return found == name.end() ? -1 : static_cast<int>(found - name.begin());
}

std::vector<std::vector<std::string>> ContactGroups::regions(const Scene &scene) const {
  std::vector<std::vector<std::string>> all(name.size());
  for (std::size_t b = 0; b < scene.body.size(); ++b)
    all[of_body[b]].insert(all[of_body[b]].end(), scene.body[b].region.begin(), scene.body[b].region.end());
  return all;
}

std::vector<std::array<int, 2>> ContactGroups::pairs(const Scene &scene) const {
  std::vector<std::array<int, 2>> all;
  for (const ContactSource &contact : scene.contact)
    all.push_back({find(contact.between[0]), find(contact.between[1])});
  return all;
}

ContactGroups contact_groups(const Scene &scene) {
  ContactGroups groups;
  for (const BodySource &body : scene.body) {
    const std::string name = body.contact_group.empty() ? "default" : body.contact_group;
    if (groups.find(name) < 0) groups.name.push_back(name);
    groups.of_body.push_back(groups.find(name));
  }
  return groups;
}

namespace {

/// Results name contacts, bodies, boundaries and points alike.
void check_name(const Scene &scene, const std::string &path, const std::string &name) {
  const auto is_taken = [&](const auto &list) {
    return std::ranges::any_of(list, [&](const auto &one) { return one.name == name; });
  };
  const char *other = is_taken(scene.boundary)        ? "boundary."
                      : is_taken(scene.rigid)         ? "rigid."
                      : is_taken(scene.structure)     ? "structure."
                      : is_taken(scene.output->point) ? "output.point."
                                                      : nullptr;
  if (other)
    scene.complain(path, std::string("has the name of ") + other + name +
                             ", and both have columns in history.csv; give one of them another name");
}

/// What several groups do not know yet.
void check_scope(const Scene &scene, bool host) {
  const std::string beside = " beside several contact groups";
  if (host) scene.complain("contact", "needs a mesh that Talus reads: that of a host program has one group of bodies");
  if (scene.phases != PhaseModel::dry)
    scene.complain("phases", "must be \"dry\"" + beside + ": they rub with total stress, and no pore water acts there");
  if (!std::holds_alternative<EulerSettings>(choose_integrator(scene)))
    scene.complain("integrator.kind", "must be \"euler\"" + beside + ": contact acts once in a step");
  for (std::size_t k = 0; k < scene.stage.size(); ++k)
    if (scene.stage[k].is_static())
      scene.complain("stage." + std::to_string(k) + ".kind",
                     "must be \"dynamic\"" + beside +
                         ": finite elements do not know them; a dynamic stage with damping finds the stress at rest");
  for (const BoundarySource &source : scene.boundary) {
    const Boundary kind = read_boundary(source.kind);
    if (kind.in_motion == OnSoil::tied || kind.has_column)
      scene.complain("boundary." + source.name + ".kind",
                     "cannot be \"tied\" or \"free_field\"" + beside + ": the ground at these sides is of one group");
  }
  for (const StructureSource &source : scene.structure)
    scene.complain("structure." + source.name, "cannot act" + beside + ": it is tied to the soil of one group");
  for (const RigidSource &source : scene.rigid)
    scene.complain("rigid." + source.name, "cannot act" + beside + ": a node meets one of them, a body or a group");
}

}  // namespace

void check_contacts(const Scene &scene, bool host) {
  const ContactGroups groups = contact_groups(scene);
  std::set<std::array<int, 2>> met;
  for (const ContactSource &source : scene.contact) {
    const std::string path = "contact." + source.name;
    std::array<int, 2> pair;
    for (int k = 0; k < 2; ++k) {
      pair[k] = groups.find(source.between[k]);
      if (pair[k] < 0)
        scene.complain(path + ".between", "must name contact_groups of bodies, and no body is of \"" +
                                              source.between[k] + "\"; " + suggestion(source.between[k], groups.name));
    }
    if (!met.insert({std::min(pair[0], pair[1]), std::max(pair[0], pair[1])}).second)
      scene.complain(path + ".between", "names two groups that another [contact.NAME] names too; leave one out");
    check_name(scene, path, source.name);
  }
  if (groups.name.size() < 2) return;
  for (int a = 0; a < static_cast<int>(groups.name.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(groups.name.size()); ++b)
      if (!met.count({a, b}))
        scene.complain(
            "body." + scene.body[std::ranges::find(groups.of_body, b) - groups.of_body.begin()].name + ".contact_group",
            "makes two groups without friction between them: add a [contact.NAME] with between = [\"" + groups.name[a] +
                "\", \"" + groups.name[b] + "\"] and a friction_angle");
  check_scope(scene, host);
}

}  // namespace talus
