#include "meshes/section_mesh.h"

#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "meshes/gmsh_elements.h"
#include "meshes/polygon.h"

namespace talus {
namespace {

namespace model = gmsh::model;
namespace occ = gmsh::model::occ;
using Entities = gmsh::vectorpair;  // (dimension, tag)

/// Lines through points; a polygon when closed.
std::vector<int> add_lines(const std::vector<Vec<2>> &points, bool closed) {
  std::vector<int> tags, lines;
  for (const Vec<2> &x : points) tags.push_back(occ::addPoint(x[0], x[1], 0));
  for (std::size_t i = 0; i + 1 < tags.size(); ++i) lines.push_back(occ::addLine(tags[i], tags[i + 1]));
  if (closed) lines.push_back(occ::addLine(tags.back(), tags.front()));
  return lines;
}

Entities boundary_of(const Entities &entities, bool combined) {
  Entities boundary;
  model::getBoundary(entities, boundary, combined, false, false);
  return boundary;
}

Entities entities(int dimension) {
  Entities all;
  model::getEntities(all, dimension);
  return all;
}

Vec<2> centre(const std::array<Vec<2>, 3> &t) {
  return {(t[0][0] + t[1][0] + t[2][0]) / 3, (t[0][1] + t[1][1] + t[2][1]) / 3};
}

class SectionModel {
 public:
  SectionModel(const Section &section, const MeshOptions &options)
      : section_(section),
        options_(options),
        thickness_(options.thickness > 0 ? options.thickness : options.size),
        tolerance_(1e-6 * section.largest_extent() + 2e-7) {
    low_ = high_ = section.outline.points[0];
    for (const Vec<2> &x : section.domain())
      for (int d = 0; d < 2; ++d) low_[d] = std::min(low_[d], x[d]), high_[d] = std::max(high_[d], x[d]);
  }

  void build() {
    fragment();
    remove_strays();
    surfaces_ = entities(2);
    if (options_.dimension == 3) extrude();
    set_sizes();
    model::mesh::generate(options_.dimension);
    name_pieces();
    name_cells();
    name_facets();
    for (const auto &[key, tags] : groups_)
      model::setPhysicalName(key.first, model::addPhysicalGroup(key.first, tags), key.second);
  }

 private:
  struct Piece {
    std::string name;
    std::vector<std::array<Vec<2>, 3>> triangles;
  };
  const Section &section_;
  const MeshOptions &options_;
  const double thickness_, tolerance_;  // [m]; Gmsh's bounding boxes are 1e-7 wider than what they hold
  Vec<2> low_, high_;                   // corners of the domain
  Entities surfaces_;                   // of the section itself, z = 0
  std::map<int, Piece> pieces_;         // by surface
  std::map<std::pair<int, std::string>, std::vector<int>> groups_;  // (dimension, name) -> entities

  void fragment() {
    const int surface = occ::addPlaneSurface({occ::addCurveLoop(add_lines(section_.domain(), true))});
    Entities tools;
    const auto add_tool = [&](const std::vector<Vec<2>> &points, bool closed) {
      for (int line : add_lines(points, closed)) tools.push_back({1, line});
    };
    for (const Polyline &polyline : section_.interfaces) add_tool(polyline.points, false);
    for (const Polyline &polyline : section_.boundaries) add_tool(polyline.points, false);
    if (section_.has_free_space) add_tool(section_.outline.points, true);
    Entities result;
    std::vector<Entities> map;
    if (!tools.empty()) occ::fragment({{2, surface}}, tools, result, map);
    occ::synchronize();
  }

  /// Pieces of interfaces that stick out of the domain bound no surface.
  void remove_strays() {
    std::set<int> used;
    for (const auto &surface : entities(2)) {
      for (const auto &curve : boundary_of({surface}, false)) used.insert(curve.second);
    }
    Entities strays;
    for (const auto &curve : entities(1))
      if (!used.count(curve.second)) strays.push_back(curve);
    if (strays.empty()) return;
    occ::remove(strays, true);
    occ::synchronize();
  }

  void extrude() {
    const std::vector<int> layers(options_.layers > 0 ? 1 : 0, options_.layers);
    std::vector<double> ends = options_.cuts;
    ends.push_back(thickness_);
    Entities from = surfaces_;
    double start = 0;
    for (double end : ends) {
      Entities made, top;
      occ::extrude(from, 0, 0, end - start, made, layers, {}, false);
      for (std::size_t i = 0; i + 1 < made.size(); ++i)
        if (made[i + 1].first == 3)
          top.push_back(made[i]);  // Gmsh lists each volume after the face opposite its source
      from = top, start = end;
    }
    occ::synchronize();
  }

  void set_sizes() const {
    for (const char *off : {"Mesh.MeshSizeFromPoints", "Mesh.MeshSizeExtendFromBoundary", "Mesh.MeshSizeMin"})
      gmsh::option::setNumber(off, 0);
    gmsh::option::setNumber("Mesh.Algorithm", 6);
    std::vector<RefinedBox> boxes = section_.boxes;
    boxes.insert(boxes.end(), options_.boxes.begin(), options_.boxes.end());
    std::vector<double> fields;
    const auto add = [&](const std::string &kind) {
      fields.push_back(model::mesh::field::add(kind));
      return static_cast<int>(fields.back());
    };
    std::ostringstream text;
    text << options_.size;
    model::mesh::field::setString(add("MathEval"), "F", text.str());
    for (const RefinedBox &box : boxes) {
      const int field = add("Box");
      const std::map<std::string, double> values{
          {"VIn", box.size},   {"VOut", options_.size}, {"XMin", box.from[0]},
          {"XMax", box.to[0]}, {"YMin", box.from[1]},   {"YMax", box.to[1]},
          {"ZMin", -1e9},      {"ZMax", 1e9},           {"Thickness", 4 * options_.size}};
      for (const auto &[key, value] : values) model::mesh::field::setNumber(field, key, value);
    }
    const int finest = model::mesh::field::add("Min");
    model::mesh::field::setNumbers(finest, "FieldsList", fields);
    model::mesh::field::setAsBackgroundMesh(finest);
  }

  /// Triangles of the section's own surfaces, and their names; a triangle's centre is surely inside its piece.
  void name_pieces() {
    for (const auto &[dimension, tag] : surfaces_) {
      Piece &piece = pieces_[tag];
      piece.triangles = corners_of<2>(tag);
      piece.name = section_.layer_at(centre(piece.triangles.at(0)));
    }
    std::map<int, const Seed *> seeded;
    for (const Seed &seed : section_.seeds) {
      const int tag = piece_at(seed.point);
      const auto [at, is_new] = seeded.try_emplace(tag, &seed);
      if (!is_new && at->second->name != seed.name)
        throw std::invalid_argument(section_.file + " line " + std::to_string(seed.line) + ": the point region_" +
                                    seed.name + " lies in the same piece as region_" + at->second->name + " in line " +
                                    std::to_string(at->second->line) + "; part them by an interface");
      pieces_.at(tag).name = seed.name;
    }
    if (const auto crossing = crossing_interfaces(section_)) require_seeds(*crossing, seeded);
  }

  /// Where interfaces cross, layers cannot be told by counting: each piece of soil needs a name of its own.
  void require_seeds(const Crossing &crossing, const std::map<int, const Seed *> &seeded) const {
    for (const auto &[tag, piece] : pieces_) {
      if (seeded.count(tag) || piece.name == "air") continue;
      const Vec<2> at = centre(piece.triangles[0]);
      std::ostringstream text;
      text << section_.file << " line " << crossing.second_line << ": '" << crossing.second->part << "' crosses '"
           << crossing.first->part << "' of line " << crossing.first_line << " near (" << crossing.place[0] << ", "
           << crossing.place[1] << "), so layers cannot be counted; end one at the other, or name every piece of soil "
           << "by a point region_NAME (there is none in the piece around (" << at[0] << ", " << at[1] << "))";
      throw std::invalid_argument(text.str());
    }
  }

  /// The piece whose triangles come nearest to holding a point.
  int piece_at(const Vec<2> &x) const {
    int best = 0;
    double most = -1e300;
    for (const auto &[tag, piece] : pieces_)
      for (const auto &t : piece.triangles) {
        const double area = cross(t[0], t[1], t[2]);
        const double least =
            std::min({cross(t[0], t[1], x) / area, cross(t[1], t[2], x) / area, cross(t[2], t[0], x) / area});
        if (least > most) most = least, best = tag;
      }
    return best;
  }

  void name_cells() {
    if (options_.dimension == 2)
      for (const auto &[tag, piece] : pieces_) groups_[{2, piece.name}].push_back(tag);
    else
      for (const auto &[dimension, tag] : entities(3)) {
        const auto tetrahedron = corners_of<3>(tag).at(0);
        Vec<2> middle{};
        double z = 0;
        for (const auto &x : tetrahedron) {
          for (int d = 0; d < 2; ++d) middle[d] += x[d] / 4;
          z += x[2] / 4;
        }
        groups_[{3, pieces_.at(piece_at(middle)).name + part_at(z)}].push_back(tag);
      }
  }

  /// Ending of the group of cells at z.
  std::string part_at(double z) const {
    if (options_.cuts.empty()) return "";
    const auto part = std::upper_bound(options_.cuts.begin(), options_.cuts.end(), z) - options_.cuts.begin() + 1;
    return std::string("_").append(std::to_string(part));
  }

  void name_facets() {
    const int dimension = options_.dimension - 1;
    std::set<int> outer;
    for (const auto &facet : boundary_of(entities(options_.dimension), true)) outer.insert(facet.second);
    std::set<std::string> found;
    for (const auto &[_, tag] : entities(dimension)) {
      const std::string name = name_of_facet(dimension, tag, outer.count(tag) > 0);
      found.insert(name);
      if (!name.empty()) groups_[{dimension, name}].push_back(tag);
    }
    for (const Polyline &polyline : section_.boundaries)
      if (!found.count(polyline.part))
        throw std::invalid_argument(
            section_.file + " line " + std::to_string(polyline.lines[0]) + ": the boundary 'b_" + polyline.part +
            "' has no facets; lay it along the outline, or inside from edge to edge, and not under "
            "another boundary");
  }

  std::string name_of_facet(int dimension, int tag, bool is_outer) const {
    double x0, y0, z0, x1, y1, z1;
    model::getBoundingBox(dimension, tag, x0, y0, z0, x1, y1, z1);
    const double tolerance = tolerance_;
    if (dimension == 2 && z1 < tolerance) return "front";
    if (dimension == 2 && z0 > thickness_ - tolerance) return "back";
    if (dimension == 2 && z1 - z0 < tolerance) return "";  // a cut
    for (const Polyline &polyline : section_.boundaries)
      if (is_on(polyline, {(x0 + x1) / 2, (y0 + y1) / 2}, tolerance)) return polyline.part;
    if (!is_outer) return "";
    if (y1 < low_[1] + tolerance) return "base";
    if (x1 < low_[0] + tolerance) return "left";
    if (x0 > high_[0] - tolerance) return "right";
    return "surface";
  }
};

}  // namespace

void mesh_section(const Section &section, const MeshOptions &options) {
  gmsh::option::setNumber("General.Verbosity", 2);
  gmsh::option::setNumber("General.NumThreads", 1);
  gmsh::option::setNumber("Geometry.ToleranceBoolean", 1e-7 * section.largest_extent());
  model::add("section");
  SectionModel(section, options).build();
}

}  // namespace talus
