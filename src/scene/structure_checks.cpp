#include "scene/structure_checks.h"

#include <algorithm>
#include <cmath>

#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/tables.h"

namespace talus {
namespace {

/// Checks of one structure.
class OneStructure {
 public:
  OneStructure(Scene &scene, const TableReader &reader, StructureSource &source)
      : scene_(scene), reader_(reader), source_(source), path_("structure." + source.name) {}

  void all() {
    name();
    std::visit([&](auto &kind) { line(kind.points), widths(kind); }, source_.kind);
    bond(), free_length(), prestress(), contact(), stages();
  }

 private:
  [[noreturn]] void complain(const std::string &key, const std::string &sentence) const {
    reader_.complain(path_ + (key.empty() ? "" : "." + key), sentence);
  }

  /// Stages name bodies and structures alike, and results structures, boundaries and points.
  void name() const {
    const auto taken = [&](const auto &list) {
      return std::ranges::any_of(list, [&](const auto &one) { return one.name == source_.name; });
    };
    const char *other = taken(scene_.body)            ? "body."
                        : taken(scene_.boundary)      ? "boundary."
                        : taken(scene_.output->point) ? "output.point."
                                                      : nullptr;
    if (other) complain("", "has the name of " + std::string(other) + source_.name + ": give it another name");
    if (source_.name.find('/') != std::string::npos) complain("", "must have a name without /");
  }

  void line(std::vector<std::vector<double>> &points) {
    if (points.size() < 2) complain("points", "must be two or more points, from the head to the end in the ground");
    const MeshSource &mesh = *scene_.mesh;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const bool in_section = scene_.dimension == 3 && !mesh.section.empty() && points[k].size() == 2;
      if (in_section) points[k].push_back((mesh.thickness > 0 ? mesh.thickness : mesh.size) / 2);
      if (points[k].size() != static_cast<std::size_t>(scene_.dimension))
        complain("points." + std::to_string(k), "must have " + std::to_string(scene_.dimension) + " coordinates");
      if (k == 0) continue;
      double square = 0;
      for (std::size_t d = 0; d < points[k].size(); ++d) square += std::pow(points[k][d] - points[k - 1][d], 2);
      if (square == 0) complain("points." + std::to_string(k), "must not be the point before it again");
      length_ += std::sqrt(square);
    }
  }

  void widths(const GeogridKeys &keys) const {
    if (scene_.dimension == 2 && keys.width > 0)
      complain("width", "has no effect in plane strain, where forces are those of a metre of width: leave it out");
    if (scene_.dimension == 3 && keys.width == 0)
      complain("", "needs width, that of the strip for which the line stands, since dimension = 3");
  }
  template <class Rod>
  void widths(const Rod &keys) const {
    if (scene_.dimension == 2 && keys.spacing == 0)
      complain("", "needs spacing, the distance of the bars across the section, in plane strain");
    if (scene_.dimension == 3 && keys.spacing > 0)
      complain("spacing", "has no effect in 3D, where each bar is drawn: leave it out");
    if (keys.bond_strength > 0 && (keys.diameter > 0 || keys.bond_adhesion > 0 || keys.bond_friction_angle > 0))
      complain("bond_strength",
               "is a second bond beside diameter, bond_adhesion and bond_friction_angle: give one of them");
    if (keys.bond_strength == 0 && keys.diameter == 0)
      complain("", "needs bond_strength, a force per length, or diameter with bond_adhesion or bond_friction_angle");
  }

  void bond() const {
    const BarKeys keys = source_.bar();
    if (keys.bond_strength == 0 && keys.bond_adhesion == 0 && keys.bond_friction_angle == 0)
      complain("", "needs a bond: give bond_adhesion or bond_friction_angle");
  }

  void free_length() const {
    const double free = source_.bar().free_length;
    if (free >= length_)
      complain("free_length", "must be less than the length of the line, " + shortest(length_) + " m");
  }

  void prestress() const {
    const BarKeys keys = source_.bar();
    if (keys.prestress == 0) return;
    if (keys.free_length == 0) complain("prestress", "needs free_length, which it stretches");
    if (keys.prestress > keys.tensile_capacity)
      complain("prestress", "must not exceed tensile_capacity, " + shortest(keys.tensile_capacity) + " N");
    if (keys.prestress > keys.plate_capacity)
      complain("prestress", "must not exceed plate_capacity, " + shortest(keys.plate_capacity) + " N");
    if (std::ranges::none_of(scene_.stage, [&](const Stage &s) { return s.adds(source_.name); }))
      complain("prestress",
               "is that of the stage that installs the anchor: let a stage add it, add = [\"" + source_.name + "\"]");
  }

  void contact() const {
    if (!scene_.contact.empty())
      reader_.complain("contact." + scene_.contact[0].name,
                       "cannot be combined with " + path_ + ": its points do not know to which group they belong");
  }

  void stages() const {
    for (std::size_t k = 0; k < scene_.stage.size(); ++k)
      if (const Stage &stage = scene_.stage[k];
          stage.seeps() && (stage.adds(source_.name) || stage.removes(source_.name)))
        reader_.complain("stage." + std::to_string(k) + (stage.adds(source_.name) ? ".add" : ".remove"),
                         "cannot name " + path_ + " in a stage of seepage, in which soil is at rest");
  }

  Scene &scene_;
  const TableReader &reader_;
  StructureSource &source_;
  const std::string path_;
  double length_ = 0;
};

}  // namespace

void check_structures(Scene &scene, const TableReader &reader) {
  for (StructureSource &source : scene.structure) OneStructure(scene, reader, source).all();
}

}  // namespace talus
