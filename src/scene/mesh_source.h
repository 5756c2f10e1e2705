#pragma once
/// [mesh]: where the background mesh comes from.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/balance_ranks.h"
#include "scene/required.h"

namespace talus {

/// A box in which cells or particles are finer.
struct RefineBox {
  std::vector<double> from, to;  ///< opposite corners [m]
  double size = required;        ///< cell size inside [m]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("from", from, metre, "corner of the box with the smallest coordinates");
    v.point("to", to, metre, "corner of the box with the largest coordinates");
    v.number("size", size, metre, Range{1e-6, 1e5}, "cell size inside the box");
  }
};

enum class WhenOutside { stop, remove };

/// A slip surface: the lower side of an ellipsoid whose first axis points down the dip, the second along the strike.
struct EllipsoidSource {
  bool given = false;                     ///< the scene has the table
  std::vector<double> centre, semi_axes;  ///< x, y, elevation of the map; down the dip, along the strike, normal [m]
  double dip = 0, dip_direction = 0;      ///< [rad]
  template <class Visitor>
  void fields(Visitor &&v) {
    given = true;
    v.point("centre", centre, metre, "centre: x, y and elevation in the coordinates of the terrain file");
    v.point("semi_axes", semi_axes, metre,
            "half lengths of the axes: down the dip, along the strike, along the normal");
    v.number("dip", dip, degree, Range{0, 89}, "angle by which the first axis falls below the horizontal");
    v.number("dip_direction", dip_direction, degree, Range{-360, 360},
             "azimuth, clockwise from north, towards which the first axis falls: 90 deg is east");
  }
};

/// A surface below which soil is of another kind, by a grid.
struct LayerSource {
  std::string name;  ///< the table's own name, [mesh.terrain.layer.NAME], and that of the group of its cells
  std::string file;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path("file", file, "grid of the elevations of the upper surface of the layer, relative to the scene");
  }
};

/// How deep a slip surface is within an outline.
enum class DepthShape { bowl, constant };

/// A terrain file and what is cut out of it.
struct TerrainSource {
  std::string file;            ///< ESRI ASCII, GeoTIFF; empty: no terrain
  std::vector<double> window;  ///< west, south, east, north of the map [m]; empty: all
  int step = 1;                ///< every so many-th row and column
  std::vector<double> base;    ///< elevation of a flat base [m]; empty: the mesh begins at the bed
  double air = 0;              ///< height of free space above the ground [m]
  double far_size = 0;         ///< of cells far from slide and ground [m]; 0: mesh.size
  std::string slip_surface;    ///< a grid; empty: none
  EllipsoidSource ellipsoid;   ///< in place of a grid
  std::string outline;         ///< of the slide, in place of both; polygons of a Shapefile or GeoPackage
  double depth = 0;            ///< largest, within the outline [m]
  DepthShape depth_shape = DepthShape::bowl;
  std::vector<LayerSource> layer;        ///< from top to bottom
  std::vector<std::vector<double>> way;  ///< line x, y of the map, along which cells are as small as in the slide [m]
  double way_width = 0;                  ///< [m]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path("file", file, "terrain file, ESRI ASCII or GeoTIFF with coordinates and elevations in metres");
    v.point("window", window, metre,
            "west, south, east, north in the coordinates of the file, each moved to the nearest column or row of it; "
            "default: all of it");
    v.integer("step", step, Range{1, 1000},
              "decimation: every so many-th row and column of the file is used, and a slip surface and layers "
              "are known at these places alone");
    v.point("base", base, metre,
            "elevation of a flat base: soil is meshed from there to the ground; without it the mesh is the space above "
            "the bed, which is the ground lowered to the slip surface");
    v.number("air", air, metre, Range{0, 1e4}, "height of the free space above the ground, in which soil may move");
    v.number("far_size", far_size, metre, Range{0, 1e5},
             "cell size far from the slide, and from the ground below it; 0: mesh.size everywhere");
    v.path("slip_surface", slip_surface, "grid of the elevations of a slip surface, relative to the scene");
    v.table("ellipsoid", ellipsoid, "slip surface: the lower side of an ellipsoid");
    v.path("outline", outline,
           "outline of a slide, whose slip surface is `depth` below the ground within it: polygons of a Shapefile or "
           "GeoPackage in the projection of the terrain, relative to the scene");
    v.number("depth", depth, metre, Range{0, 1e4}, "largest depth of the slip surface within the outline");
    v.choice("depth_shape", depth_shape, {{"bowl", DepthShape::bowl}, {"constant", DepthShape::constant}},
             "bowl: from 0 at the outline to `depth`, with the same curvature everywhere, as by the sloping local base "
             "level; constant: `depth` everywhere, with a vertical wall along the outline");
    v.named("layer", layer,
            "layers of soil over a flat base, from top to bottom, [mesh.terrain.layer.NAME]: cells below the surface "
            "of a layer are the group NAME in place of `ground`");
    v.points("way", way, metre,
             "line of points [x, y] of the map along which the slide flows: within way_width cells measure mesh.size, "
             "as in the slide");
    v.number("way_width", way_width, metre, Range{0, 1e5}, "width of the strip along the way");
  }
};

struct MeshSource {
  std::string file;          ///< Gmsh .msh, 2.2 or 4.1, with physical groups
  std::string section;       ///< section, CSV or DXF, meshed by talus-mesh
  TerrainSource terrain;     ///< meshed by talus-mesh
  double size = 0;           ///< cell size of a section or of terrain [m]
  double thickness = 0;      ///< of a 3D body cut from a section [m]; 0: one cell size
  int layers = 1;            ///< element layers over the thickness; 0: free tetrahedra
  std::vector<double> cuts;  ///< z at which regions of a 3D body from a section are parted [m]
  std::vector<RefineBox> refine;
  int halvings = 0;                                   ///< of the edges of all cells, once ranks have their parts
  WhenOutside leaving_particles = WhenOutside::stop;  ///< particles that leave the mesh
  BalanceRanks balance_ranks = BalanceRanks::when_it_pays;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path("file", file, "Gmsh mesh file (.msh, format 2.2 or 4.1) with physical groups, relative to the scene");
    v.path("section", section,
           "section, a CSV file or a DXF drawing, that talus-mesh turns into a mesh; relative to the scene");
    v.number("size", size, metre, Range{0, 1e5},
             "cell size of a mesh made from a section or terrain; of terrain in the slide and at the ground");
    v.number("thickness", thickness, metre, Range{0, 1e5},
             "thickness of a 3D body cut from a section; 0 is one cell size");
    v.integer("layers", layers, Range{0, 1000}, "element layers over the thickness; 0 gives unstructured tetrahedra");
    v.point("cuts", cuts, metre,
            "ascending z that divide the thickness: regions are then named region_1, region_2, ... along z");
    v.list("refine", refine, "boxes with smaller cells, of a section; on terrain see mesh.terrain");
    v.integer("halvings", halvings, Range{0, 4},
              "how often the edges of all cells are halved, each time for 4 times as many triangles or 8 times as many "
              "tetrahedra; ranks do it after the mesh has been divided among them, so that none holds all cells");
    v.table("terrain", terrain, "terrain that talus-mesh turns into a mesh; needs dimension = 3 and up = \"z\"");
    v.choice("leaving_particles", leaving_particles, {{"stop", WhenOutside::stop}, {"remove", WhenOutside::remove}},
             "what becomes of particles that leave the mesh: the run ends with the place, or they are taken out of the "
             "simulation and entered in escaped.csv; may be changed with --resume");
    v.choice(
        "balance_ranks", balance_ranks,
        {{"when_it_pays", BalanceRanks::when_it_pays},
         {"never", BalanceRanks::never},
         {"always", BalanceRanks::always}},
        "when the mesh is divided among the ranks of a run in another way, because the soil has moved: once ranks "
        "have waited for others longer than that takes, never, or at every remap, which shows that the answer does "
        "not depend on it; may be changed with --resume");
  }
};

}  // namespace talus
