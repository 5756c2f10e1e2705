#include "meshes/mesh_options.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

#include "scene/quantity.h"

namespace talus {
namespace {

/// As they are typed, where they may have units.
struct Words {
  std::string source, size, thickness, base, air, far_size, depth, way_width, depth_shape = "bowl";
  std::vector<std::string> cuts, refine, window, ellipsoid, layer, way;
};

std::vector<double> lengths(const char *option, const std::vector<std::string> &texts) {
  std::vector<double> values;
  for (const std::string &text : texts) values.push_back(quantity(option, text, metre));
  return values;
}

void take(TerrainSource &terrain, const Words &words) {
  terrain.window = lengths("--window", words.window);
  if (!words.base.empty()) terrain.base = {quantity("--base", words.base, metre)};
  terrain.depth_shape = words.depth_shape == "bowl" ? DepthShape::bowl : DepthShape::constant;
  for (std::size_t i = 0; i + 1 < words.layer.size(); i += 2)
    terrain.layer.push_back({.name = words.layer[i], .file = words.layer[i + 1]});
  const std::vector<double> way = lengths("--way", words.way);
  for (std::size_t i = 0; i + 1 < way.size(); i += 2) terrain.way.push_back({way[i], way[i + 1]});
  if (words.ellipsoid.empty()) return;
  EllipsoidSource &ellipsoid = terrain.ellipsoid;
  const std::vector<double> v = lengths("--ellipsoid", {words.ellipsoid.begin(), words.ellipsoid.begin() + 6});
  ellipsoid.given = true;
  ellipsoid.centre = {v[0], v[1], v[2]}, ellipsoid.semi_axes = {v[3], v[4], v[5]};
  ellipsoid.dip = quantity("--ellipsoid", words.ellipsoid[6], degree);
  ellipsoid.dip_direction = quantity("--ellipsoid", words.ellipsoid[7], degree);
}

MeshRequest request_of(const Words &words, MeshRequest request) {
  MeshSource &mesh = request.mesh;
  for (const auto &[option, text, value] : {std::tuple{"--size", &words.size, &mesh.size},
                                            {"--thickness", &words.thickness, &mesh.thickness},
                                            {"--air", &words.air, &mesh.terrain.air},
                                            {"--far-size", &words.far_size, &mesh.terrain.far_size},
                                            {"--depth", &words.depth, &mesh.terrain.depth},
                                            {"--way-width", &words.way_width, &mesh.terrain.way_width}})
    if (!text->empty()) *value = quantity(option, *text, metre);
  mesh.cuts = lengths("--cuts", words.cuts);
  const std::vector<double> b = lengths("--refine", words.refine);
  for (std::size_t i = 0; i + 4 < b.size(); i += 5)
    mesh.refine.push_back({.from = {std::min(b[i], b[i + 2]), std::min(b[i + 1], b[i + 3])},
                           .to = {std::max(b[i], b[i + 2]), std::max(b[i + 1], b[i + 3])},
                           .size = b[i + 4]});
  take(mesh.terrain, words);
  if (is_section(words.source))
    mesh.section = words.source;
  else
    mesh.terrain.file = words.source, request.dimension = 3;
  return request;
}

/// Refuses options of terrain for a section, and those of a section for terrain.
void check_source(const CLI::App &command, const std::string &source) {
  const bool section = is_section(source);
  const std::vector<const char *> others =
      section ? std::vector{"--window",       "--step",      "--base",     "--air",   "--far-size",
                            "--slip-surface", "--ellipsoid", "--outline",  "--depth", "--depth-shape",
                            "--layer",        "--way",       "--way-width"}
              : std::vector{"--thickness", "--layers", "--cuts", "--refine"};
  for (const char *option : others)
    if (command.count(option))
      throw std::invalid_argument(std::string(option) + (section ? " belongs to terrain, and the source is a section"
                                                                 : " belongs to sections, and the source is terrain"));
  if (!command.count("--outline") && (command.count("--depth") || command.count("--depth-shape")))
    throw std::invalid_argument("--depth and --depth-shape belong to an --outline");
}

}  // namespace

double quantity(const char *option, const std::string &text, Unit unit) {
  try {
    return in_unit(text, unit) * unit.si;
  } catch (const std::invalid_argument &error) {
    throw std::invalid_argument(std::string(option) + " " + text + ": " + error.what());
  }
}

bool is_section(const std::string &file) {
  const std::string kind = std::filesystem::path(file).extension();
  return kind == ".csv" || kind == ".dxf" || kind == ".DXF";
}

std::function<MeshRequest()> add_mesh_options(CLI::App &command) {
  auto words = std::make_shared<Words>();
  auto request = std::make_shared<MeshRequest>();
  MeshSource &mesh = request->mesh;
  command.add_option("SOURCE", words->source, "section: CSV or DXF; or terrain: ESRI ASCII or GeoTIFF")->required();
  command.add_option("--size", words->size, "cell size, such as 0.5 or \"50 cm\"")->required();
  command.add_option("--dimension", request->dimension, "of a section, 2: triangles, 3: tetrahedra (default 2)")
      ->check(CLI::IsMember({2, 3}));
  command.add_option("--thickness", words->thickness, "thickness of a 3D slice (default: one cell size)");
  command.add_option("--layers", mesh.layers,
                     "element layers over the thickness; 0: unstructured tetrahedra (default 1)");
  command.add_option("--cuts", words->cuts,
                     "z values that divide the thickness into regions with the endings _1, _2, ...");
  command.add_option("--refine", words->refine, "x0 y0 x1 y1 h: cells of size h in a box; may be repeated")
      ->type_size(5)
      ->expected(-1);
  command.add_option("--window", words->window, "terrain: west south east north (default: all of it)")->expected(4);
  command.add_option("--step", mesh.terrain.step, "terrain: every so many-th row and column is used (default 1)");
  command.add_option(
      "--base", words->base,
      "terrain: elevation of a flat base (default: the mesh is the space above the ground or slip surface)");
  command.add_option("--air", words->air, "terrain: height of the free space above the ground");
  command.add_option("--far-size", words->far_size,
                     "terrain: cell size far from the slide and the ground (default: --size)");
  command.add_option("--slip-surface", mesh.terrain.slip_surface,
                     "terrain: a grid of the elevations of a slip surface");
  command
      .add_option("--ellipsoid", words->ellipsoid,
                  "terrain: slip surface by an ellipsoid, x y z of its centre, half lengths down the dip, along the "
                  "strike and normal, dip, dip direction (azimuth towards which it dips)")
      ->expected(8);
  command.add_option("--outline", mesh.terrain.outline,
                     "terrain: slip surface by the outline of the slide, polygons of a Shapefile or GeoPackage");
  command.add_option("--depth", words->depth, "terrain: largest depth of the slip surface in the outline");
  command
      .add_option("--depth-shape", words->depth_shape,
                  "terrain: depth in the outline, bowl (default: 0 at the outline) or constant")
      ->check(CLI::IsMember({"bowl", "constant"}));
  command
      .add_option("--layer", words->layer,
                  "terrain: NAME FILE, a group of the cells below a grid of elevations; from top to bottom")
      ->type_size(2)
      ->expected(-1);
  command
      .add_option("--way", words->way,
                  "terrain: x y, a point of the line along which cells measure --size; may be repeated")
      ->type_size(2)
      ->expected(-1);
  command.add_option("--way-width", words->way_width,
                     "terrain: width of the strip of small cells along the line --way");
  return [&command, words, request] {
    check_source(command, words->source);
    return request_of(*words, *request);
  };
}

}  // namespace talus
