#include "commands/foreign_code.h"

#include "physics/laws/laws.h"
#include "scene/body_source.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {

std::vector<std::string> bodies_with_umat(const Scene &scene) {
  const std::vector<std::string> laws = kinds_of<Laws>();
  std::vector<std::string> bodies;
  for (const BodySource &body : scene.body) {
    if (!body.law.reader) continue;
    TableReader table = *body.law.reader;  // a copy, so that the table can be read again
    if (laws[table.kind("law", laws)] == Umat::name) bodies.push_back(body.name);
  }
  return bodies;
}

void refuse_umat(const Scene &scene) {
  for (const std::string &body : bodies_with_umat(scene))
    scene.complain("body." + body + ".law",
                   "must not be a UMAT with --no-umat: it loads a library, which can do whatever a program can");
}

}  // namespace talus
