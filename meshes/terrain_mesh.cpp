#include "meshes/terrain_mesh.h"

#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "meshes/flat_cells.h"
#include "meshes/simplex.h"

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
    if (terrain.options().base)
      add_surface(terrain.ground(), "terrain");
    else
      add_surface(terrain.bed(), "base", terrain.refined());
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
    // Gmsh 4.8 passes a place, 4.13 also the size that other settings ask for
    model::mesh::setSizeCallback(
        [this](int, int, double x, double y, double z, auto...) { return terrain_.size_at(x, y, z); });
    model::mesh::generate(3);
    model::mesh::removeSizeCallback();
    rebuild();
  }

 private:
  const Terrain &terrain_;
  std::size_t next_node_ = 1;
  std::vector<int> surfaces_;  // from top to bottom; the curves of surface s are its sides south, east, north, west
  std::map<int, std::string> name_;
  std::vector<int> volumes_;

  static std::array<int, 4> corners(std::size_t s) {
    const int first = 4 * static_cast<int>(s);
    return {first + 1, first + 2, first + 3, first + 4};
  }

  /// A surface of the triangles between elevations, as Gmsh's tutorial x2 does it; its points and curves have the same
  /// numbers. Of the bed a part has more places than the terrain.
  void add_surface(const std::vector<double> &z, const std::string &name, const Terrain::Refined &part = {}) {
    const int columns = terrain_.columns(), rows = terrain_.rows(), surface = static_cast<int>(surfaces_.size()) + 1;
    const std::array<int, 4> corner = corners(surfaces_.size());
    const std::array<int, 2> at[] = {{0, 0}, {columns - 1, 0}, {columns - 1, rows - 1}, {0, rows - 1}};
    for (int k = 0; k < 4; ++k) {
      model::addDiscreteEntity(0, corner[k]);
      model::setCoordinates(corner[k], terrain_.x(at[k][0]), terrain_.y(at[k][1]), z[at[k][1] * columns + at[k][0]]);
    }
    for (int k = 0; k < 4; ++k) model::addDiscreteEntity(1, corner[k], {corner[k], corner[(k + 1) % 4]});
    model::addDiscreteEntity(2, surface, {corner.begin(), corner.end()});
    const Grid &fine = terrain_.near_slide();
    const std::size_t first = next_node_, first_fine = first + z.size();
    const auto in_part = [&](int i, int j) {
      return part.parts > 1 && i >= part.column && i <= part.column + part.columns && j >= part.row &&
             j <= part.row + part.rows;
    };
    const auto fine_node = [&](int i, int j) { return first_fine + static_cast<std::size_t>(j) * fine.columns + i; };
    const auto node = [&](int i, int j) {
      return in_part(i, j) ? fine_node((i - part.column) * part.parts, (j - part.row) * part.parts)
                           : first + static_cast<std::size_t>(j) * columns + i;
    };
    std::vector<std::size_t> nodes;
    std::vector<double> places;
    const auto add = [&](std::size_t number, double x, double y, double height) {
      nodes.push_back(number), places.insert(places.end(), {x, y, height});
    };
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i)
        if (!in_part(i, j)) add(node(i, j), terrain_.x(i), terrain_.y(j), z[j * columns + i]);
    for (int j = 0; part.parts > 1 && j < fine.rows; ++j)
      for (int i = 0; i < fine.columns; ++i)
        add(fine_node(i, j), fine.x(i), fine.y(j), fine.values[j * fine.columns + i]);
    model::mesh::addNodes(2, surface, nodes, places);
    next_node_ = first_fine + (part.parts > 1 ? fine.values.size() : 0);
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
    const auto add_square = [&](const auto &number, int i, int j) {
      triangles.insert(triangles.end(), {number(i, j), number(i + 1, j), number(i, j + 1), number(i + 1, j),
                                         number(i + 1, j + 1), number(i, j + 1)});
    };
    for (int j = 0; j + 1 < rows; ++j)
      for (int i = 0; i + 1 < columns; ++i) {
        const std::array<int, 2> around[] = {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
        int shared = -1, within = 0;  // the side where the part begins
        for (int k = 0; k < 4; ++k) {
          const auto &[a, b] = std::tie(around[k], around[(k + 1) % 4]);
          within += in_part(a[0], a[1]);
          if (in_part(a[0], a[1]) && in_part(b[0], b[1])) shared = k;
        }
        if (within == 4) continue;
        if (shared < 0) {
          add_square(node, i, j);
          continue;
        }
        const auto &a = around[shared], &b = around[(shared + 1) % 4], &c = around[(shared + 2) % 4],
                   &d = around[(shared + 3) % 4];
        for (int n = 0; n < part.parts; ++n) {
          const auto along = [&](int m) {
            return fine_node((a[0] - part.column) * part.parts + (b[0] - a[0]) * m,
                             (a[1] - part.row) * part.parts + (b[1] - a[1]) * m);
          };
          triangles.insert(triangles.end(), {along(n), along(n + 1), node(d[0], d[1])});
        }
        triangles.insert(triangles.end(), {node(b[0], b[1]), node(c[0], c[1]), node(d[0], d[1])});
      }
    for (int j = 0; part.parts > 1 && j + 1 < fine.rows; ++j)
      for (int i = 0; i + 1 < fine.columns; ++i) add_square(fine_node, i, j);
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

  /// How deep a place of a volume lies within the slide, below the ground over a bed, above the slip surface over a
  /// flat base [m]; negative outside. Above a flat base the ground is a surface of the mesh, that parts air from soil;
  /// above a bed it is not.
  double depth_in_slide(std::size_t volume, double x, double y, double z) const {
    const double ground = terrain_.ground_at(x, y), bed = terrain_.bed_at(x, y);
    const bool soil = !terrain_.options().base || volume + 1 == volumes_.size();
    return !(bed < ground) || !soil  ? -std::numeric_limits<double>::infinity()
           : terrain_.options().base ? z - bed
                                     : ground - z;
  }

  /// What a cell of a volume is made of that is no part of the slide.
  std::string name_of(std::size_t volume, double x, double y, double z) const {
    if (!terrain_.options().base || volume + 1 < volumes_.size()) return "air";
    const std::string layer = terrain_.layer_at(x, y, z);
    return layer.empty() ? "ground" : layer;
  }

  /// The depth of the middle of cells from which on they are the slide, such that they have its volume. By a depth of 0
  /// it would be 4 % too small where a slide ends thin: the middles of the cells at its rim lie above the ground.
  template <class Cells>
  double least_depth(const Cells &cells) const {
    std::vector<std::array<double, 2>> depth_and_size;
    for (const auto &cell : cells) depth_and_size.push_back({cell.depth, cell.size});
    std::sort(depth_and_size.begin(), depth_and_size.end(), std::greater<>());
    const double most = terrain_.options().size / 8;
    double left = terrain_.slide_volume();
    for (const auto &[depth, size] : depth_and_size) {
      if (std::abs(depth) <= most && left < size / 2) return depth;
      if (depth < -most) break;
      left -= size;
    }
    return left > 0 ? -most : most;
  }

  struct Cell {
    std::size_t volume;
    const std::size_t *nodes;
    double middle[3], size, depth;
  };
  using Face = std::array<std::size_t, 3>;
  static Face face_of(const std::size_t *nodes, int without) {
    Face face{};
    for (int a = 0, k = 0; a < 4; ++a)
      if (a != without) face[k++] = nodes[a];
    std::sort(face.begin(), face.end());
    return face;
  }

  /// Drops cells over places without data, and those that hang together with the rest by no face; facets go with them,
  /// and the faces that come to light are a group of their own.
  void leave_out_voids(std::vector<Cell> &cells, Named &facets) const {
    std::erase_if(cells, [&](const Cell &cell) { return terrain_.is_void(cell.middle[0], cell.middle[1]); });
    struct Side {
      Face face;
      std::size_t cell;
      bool operator<(const Side &other) const { return std::tie(face, cell) < std::tie(other.face, other.cell); }
    };
    std::vector<Side> sides;
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (int k = 0; k < 4; ++k) sides.push_back({face_of(cells[c].nodes, k), c});
    std::sort(sides.begin(), sides.end());
    std::vector<std::size_t> part(cells.size());  // the cell that stands for all of a part
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&](std::size_t c) {
      while (part[c] != c) c = part[c] = part[part[c]];
      return c;
    };
    for (std::size_t k = 0; k + 1 < sides.size(); ++k)
      if (sides[k].face == sides[k + 1].face) part[root(sides[k].cell)] = root(sides[k + 1].cell);
    std::map<std::size_t, std::size_t> size;
    for (std::size_t c = 0; c < cells.size(); ++c) ++size[root(c)];
    std::size_t largest = 0, most = 0;
    for (const auto &[c, count] : size)
      if (count > most) largest = c, most = count;
    std::erase_if(sides, [&](const Side &side) { return root(side.cell) != largest; });
    std::vector<Cell> kept;
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (root(c) == largest) kept.push_back(cells[c]);
    cells = std::move(kept);
    std::vector<Face> named, open;
    for (auto &[name, nodes] : facets) {
      NodeList left;
      for (std::size_t k = 0; k < nodes.size(); k += 3) {
        Face face{nodes[k], nodes[k + 1], nodes[k + 2]};
        std::sort(face.begin(), face.end());
        const auto at = std::lower_bound(sides.begin(), sides.end(), Side{face, 0});
        if (at == sides.end() || at->face != face) continue;
        left.insert(left.end(), &nodes[k], &nodes[k] + 3), named.push_back(face);
      }
      nodes = std::move(left);
    }
    std::erase_if(facets, [](const auto &group) { return group.second.empty(); });
    std::sort(named.begin(), named.end());
    NodeList &nodes = facets["void"];
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const Face &face = sides[k].face;
      if (k + 1 < sides.size() && sides[k + 1].face == face)
        ++k;  // between two cells
      else if (!std::binary_search(named.begin(), named.end(), face))
        nodes.insert(nodes.end(), face.begin(), face.end());
    }
    if (nodes.empty()) facets.erase("void");
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
    std::vector<Cell> all;
    for (std::size_t v = 0; v < volumes_.size(); ++v)
      for (std::size_t k = 0; k < cells_of[v].size(); k += 4) {
        Cell cell{v, &cells_of[v][k], {}, 0, 0};
        std::array<Vec<3>, 4> corner;
        for (int a = 0; a < 4; ++a)
          for (int d = 0; d < 3; ++d)
            corner[a][d] = x[3 * index.at(cell.nodes[a]) + d], cell.middle[d] += corner[a][d] / 4;
        cell.size = std::abs(Simplex<3>(corner).volume);
        cell.depth = depth_in_slide(v, cell.middle[0], cell.middle[1], cell.middle[2]);
        all.push_back(cell);
      }
    if (terrain_.has_voids()) {
      leave_out_voids(all, facets);
      std::set<std::size_t> used;
      for (const Cell &cell : all) used.insert(cell.nodes, cell.nodes + 4);
      nodes.assign(used.begin(), used.end());
      std::vector<double> places;
      for (const std::size_t node : nodes)
        places.insert(places.end(), &x[3 * index.at(node)], &x[3 * index.at(node)] + 3);
      x = std::move(places);
    }
    const double least = least_depth(all);
    for (const Cell &cell : all) {
      std::vector<std::size_t> &group =
          cells[cell.depth > least ? "slide" : name_of(cell.volume, cell.middle[0], cell.middle[1], cell.middle[2])];
      group.insert(group.end(), cell.nodes, cell.nodes + 4);
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
