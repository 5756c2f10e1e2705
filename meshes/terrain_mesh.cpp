#include "meshes/terrain_mesh.h"

#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "meshes/flat_cells.h"

namespace talus {
namespace {

namespace model = gmsh::model;
namespace geo = gmsh::model::geo;

/// Simplices of one dimension by the names of their groups: numbers of nodes, one simplex after the other.
using Named = std::map<std::string, NodeList>;

class TerrainModel {
 public:
  explicit TerrainModel(const Terrain &terrain) : terrain_(terrain) {
    if (terrain.options().air > 0) {
      std::vector<double> top = terrain.ground();
      for (double &z : top) z += terrain.options().air;
      add_surface(top, "top");
    }
    add_surface(terrain.options().base ? terrain.ground() : terrain.bed(), terrain.options().base ? "terrain" : "base");
  }

  void build() {
    model::mesh::reclassifyNodes();
    model::mesh::createGeometry();
    if (terrain_.options().base) add_base();
    for (std::size_t s = 0; s + 1 < surfaces_.size(); ++s) join(s, s + 1);
    geo::synchronize();
    for (const char *off : {"Mesh.MeshSizeFromPoints", "Mesh.MeshSizeExtendFromBoundary", "Mesh.MeshSizeMin"})
      gmsh::option::setNumber(off, 0);
    gmsh::option::setNumber("Mesh.Algorithm", 6);
    model::mesh::setSizeCallback([this](int, int, double x, double y, double z) { return terrain_.size_at(x, y, z); });
    model::mesh::generate(3);
    model::mesh::removeSizeCallback();
    rebuild();
  }

 private:
  const Terrain &terrain_;
  std::vector<int> surfaces_;  // from top to bottom; the curves of surface s are its sides south, east, north, west
  std::map<int, std::string> name_;
  std::vector<int> volumes_;

  static std::array<int, 4> corners(std::size_t s) {
    const int first = 4 * static_cast<int>(s);
    return {first + 1, first + 2, first + 3, first + 4};
  }

  /// A surface of the triangles between elevations, as Gmsh's tutorial x2 does it; its points and curves have the same
  /// numbers.
  void add_surface(const std::vector<double> &z, const std::string &name) {
    const int columns = terrain_.columns(), rows = terrain_.rows(), s = static_cast<int>(surfaces_.size());
    const std::array<int, 4> corner = corners(surfaces_.size());
    const std::size_t first = static_cast<std::size_t>(s) * columns * rows + 1;
    const std::array<int, 2> at[] = {{0, 0}, {columns - 1, 0}, {columns - 1, rows - 1}, {0, rows - 1}};
    const auto node = [&](int i, int j) { return first + static_cast<std::size_t>(j) * columns + i; };
    for (int k = 0; k < 4; ++k) {
      model::addDiscreteEntity(0, corner[k]);
      model::setCoordinates(corner[k], terrain_.x(at[k][0]), terrain_.y(at[k][1]), z[at[k][1] * columns + at[k][0]]);
    }
    for (int k = 0; k < 4; ++k) model::addDiscreteEntity(1, corner[k], {corner[k], corner[(k + 1) % 4]});
    const int surface = s + 1;
    model::addDiscreteEntity(2, surface, {corner.begin(), corner.end()});
    std::vector<std::size_t> nodes(z.size());
    std::iota(nodes.begin(), nodes.end(), first);
    std::vector<double> places;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) places.insert(places.end(), {terrain_.x(i), terrain_.y(j), z[j * columns + i]});
    model::mesh::addNodes(2, surface, nodes, places);
    for (int k = 0; k < 4; ++k) {
      model::mesh::addElementsByType(corner[k], 15, {}, {node(at[k][0], at[k][1])});
      const auto &a = at[k], &b = at[(k + 1) % 4];
      const int steps = std::max(std::abs(b[0] - a[0]), std::abs(b[1] - a[1]));
      std::vector<std::size_t> segments;
      const auto along = [&](int n) {
        return node(a[0] + (b[0] - a[0]) / steps * n, a[1] + (b[1] - a[1]) / steps * n);
      };
      for (int n = 0; n < steps; ++n) segments.insert(segments.end(), {along(n), along(n + 1)});
      model::mesh::addElementsByType(corner[k], 1, {}, segments);
    }
    std::vector<std::size_t> triangles;
    for (int j = 0; j + 1 < rows; ++j)
      for (int i = 0; i + 1 < columns; ++i)
        triangles.insert(triangles.end(), {node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j),
                                           node(i + 1, j + 1), node(i, j + 1)});
    model::mesh::addElementsByType(surface, 2, {}, triangles);
    surfaces_.push_back(surface), name_[surface] = name;
  }

  /// The volume between two surfaces and the walls around it.
  void join(std::size_t above, std::size_t below) {
    const std::array<int, 4> upper = corners(above), lower = corners(below);
    static const char *const sides[] = {"south", "east", "north", "west"};
    std::array<int, 4> edge;
    for (int k = 0; k < 4; ++k) edge[k] = geo::addLine(lower[k], upper[k]);
    std::vector<int> shell{surfaces_[above], surfaces_[below]};
    for (int k = 0; k < 4; ++k) {
      shell.push_back(geo::addPlaneSurface({geo::addCurveLoop({lower[k], edge[(k + 1) % 4], -upper[k], -edge[k]})}));
      name_[shell.back()] = sides[k];
    }
    volumes_.push_back(geo::addVolume({geo::addSurfaceLoop(shell)}));
  }

  /// A flat surface whose points and curves are numbered like those of the others.
  void add_base() {
    const double x[] = {0, terrain_.width(), terrain_.width(), 0}, y[] = {0, 0, terrain_.depth(), terrain_.depth()};
    const int first = static_cast<int>(4 * surfaces_.size());
    for (int k = 0; k < 4; ++k) geo::addPoint(x[k], y[k], *terrain_.options().base, 0, first + k + 1);
    for (int k = 0; k < 4; ++k) geo::addLine(first + k + 1, first + (k + 1) % 4 + 1, first + k + 1);
    const std::array<int, 4> base = corners(surfaces_.size());
    const int surface = geo::addPlaneSurface({geo::addCurveLoop({base.begin(), base.end()})});
    surfaces_.push_back(surface), name_[surface] = "base";
  }

  /// What a cell of a volume is made of. Above a flat base the ground is a surface of the mesh, that parts air from
  /// soil; above a bed it is not.
  std::string name_of(std::size_t volume, double x, double y, double z) const {
    const double ground = terrain_.ground_at(x, y), bed = terrain_.bed_at(x, y);
    if (!terrain_.options().base) return bed < ground && z < ground ? "slide" : "air";
    if (volume + 1 < volumes_.size()) return "air";
    if (bed < ground && z > bed) return "slide";
    const std::string layer = terrain_.layer_at(x, y, z);
    return layer.empty() ? "ground" : layer;
  }

  static NodeList simplices_of(int type, int entity) {
    std::vector<std::size_t> tags, nodes;
    model::mesh::getElementsByType(type, tags, nodes, entity);
    return nodes;
  }

  /// A new model of the same mesh, whose cells are sorted by what they are made of.
  void rebuild() {
    std::vector<std::size_t> nodes;
    std::vector<double> x, parametric;
    model::mesh::getNodes(nodes, x, parametric);
    std::map<std::size_t, std::size_t> index;
    for (std::size_t i = 0; i < nodes.size(); ++i) index[nodes[i]] = i;
    std::vector<NodeList> facets_of, cells_of;  // by surface, by volume
    for (const auto &[surface, name] : name_) facets_of.push_back(simplices_of(2, surface));
    for (const int volume : volumes_) cells_of.push_back(simplices_of(4, volume));
    drop_flat_cells(
        [&](std::size_t node) {
          const double *at = &x[3 * index.at(node)];
          return Vec<3>{at[0], at[1], at[2]};
        },
        cells_of, facets_of);
    Named cells, facets;
    std::size_t s = 0;
    for (const auto &[surface, name] : name_) {
      facets[name].insert(facets[name].end(), facets_of[s].begin(), facets_of[s].end());
      ++s;
    }
    for (std::size_t v = 0; v < volumes_.size(); ++v) {
      const NodeList &of = cells_of[v];
      for (std::size_t k = 0; k < of.size(); k += 4) {
        double middle[3] = {};
        for (int a = 0; a < 4; ++a)
          for (int d = 0; d < 3; ++d) middle[d] += x[3 * index.at(of[k + a]) + d] / 4;
        std::vector<std::size_t> &group = cells[name_of(v, middle[0], middle[1], middle[2])];
        group.insert(group.end(), of.begin() + static_cast<long>(k), of.begin() + static_cast<long>(k) + 4);
      }
    }
    model::add("named");
    int tag = 0;
    for (const auto &[dimension, type, groups] : {std::tuple{3, 4, &cells}, {2, 2, &facets}})
      for (const auto &[name, simplices] : *groups) {
        model::addDiscreteEntity(dimension, ++tag);
        if (tag == 1) model::mesh::addNodes(dimension, tag, nodes, x);
        model::mesh::addElementsByType(tag, type, {}, simplices);
        model::setPhysicalName(dimension, model::addPhysicalGroup(dimension, {tag}), name);
      }
  }
};

}  // namespace

void mesh_terrain(const Terrain &terrain) {
  gmsh::option::setNumber("General.Terminal", 0);  // errors are thrown
  gmsh::option::setNumber("General.NumThreads", 1);
  model::add("terrain");
  TerrainModel(terrain).build();
}

}  // namespace talus
