/// Reading a scene as a whole, and what its keys demand of one another.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <sstream>
#include <tuple>

#include "scene/doubt_names.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/structure_checks.h"
#include "scene/tables.h"
#include "scene/words.h"

namespace talus {
namespace {

/// Checks between keys, and the few values that follow from others. Complains at the key's place in the file.
class Checks {
 public:
  Checks(Scene &scene, const TableReader &reader, bool host_mesh)
      : scene_(scene), reader_(reader), host_mesh_(host_mesh) {}

  void all() {
    if (scene_.body.empty())
      reader_.complain("body", "has no soil; add a table [body.NAME] with region, density and law");
    if (scene_.stage.empty()) reader_.complain("stage", "is missing; add a table [[stage]] with its duration");
    gravity();
    mesh();
    for (BodySource &body : scene_.body) unit_weight("body." + body.name, body), this->body(body);
    for (BoundarySource &boundary : scene_.boundary)
      if (boundary.group.empty()) boundary.group = {boundary.name};
    water();
    for (OutputPoint &point : scene_.output->point) {
      into_middle(point.position);
      components("output.point." + point.name + ".position", point.position.size(), scene_.dimension, "coordinates");
    }
    for (OutputLine &line : scene_.output->line) {
      for (std::vector<double> &point : line.points) into_middle(point);
      followed_line(line);
    }
    for (std::size_t i = 0; i < scene_.stage.size(); ++i)
      if (scene_.stage[i].name.empty()) scene_.stage[i].name = std::to_string(i);
    for (std::size_t i = 0; i < scene_.stage.size(); ++i) stage(scene_.stage[i], "stage." + std::to_string(i));
    for (const BodySource &body : scene_.body) damping_ratio("body." + body.name, body);
    check_structures(scene_, reader_);
    bodies_that_come_and_go();
    ground_motion();
    factor_of_safety();
    if (scene_.start_from->reset_displacement && scene_.start_from->folder.empty())
      reader_.complain(
          "start_from.reset_displacement",
          "has no effect without start_from.folder, the results of the run at whose state this one starts");
    std::istringstream words{std::string(doubt_names)};
    const std::vector<std::string> names{std::istream_iterator<std::string>(words), {}};
    for (const std::string &name : scene_.acknowledge)
      if (!is_doubt_name(name))
        reader_.complain("acknowledge", "names no doubt by " + name + "; " + suggestion(name, names));
  }

 private:
  /// A point of the section lies in the middle of the body that is drawn out of it.
  void into_middle(std::vector<double> &point) const {
    const MeshSource &mesh = *scene_.mesh;
    if (scene_.dimension == 3 && !mesh.section.empty() && point.size() == 2)
      point.push_back((mesh.thickness > 0 ? mesh.thickness : mesh.size) / 2);
  }

  void ground_motion() const {
    for (std::size_t i = 0; i < scene_.earthquake.size(); ++i) {
      const std::vector<double> &direction = scene_.earthquake[i].direction;
      const std::string path = "earthquake." + std::to_string(i) + ".direction";
      const bool of_section = scene_.dimension == 3 && !scene_.mesh->section.empty() && direction.size() == 2;
      if (!direction.empty() && !of_section) components(path, direction.size(), scene_.dimension, "components");
      if (!direction.empty() && std::ranges::all_of(direction, [](double one) { return one == 0; }))
        reader_.complain(path, "must not be zero");
    }
  }

  void followed_line(const OutputLine &line) const {
    const std::string path = "output.line." + line.name;
    if (line.name.find('/') != std::string::npos)
      reader_.complain(path, "must have a name without /, since its file is line_NAME.csv");
    for (const auto &point : line.points)
      components(path + ".points", point.size(), scene_.dimension, "coordinates in each point");
    double length = 0;
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      double square = 0;
      for (std::size_t d = 0; d < line.points[i].size(); ++d)
        square += std::pow(line.points[i][d] - line.points[i - 1][d], 2);
      length += std::sqrt(square);
    }
    if (length == 0) reader_.complain(path + ".points", "must be two or more different points");
    constexpr double most = 1e4;
    if (line.spacing > 0 && length > most * line.spacing)
      reader_.complain(path + ".spacing", "must be at least " + shortest(length / most) + " m: the line is " +
                                              shortest(length) + " m long, and has at most 10000 places");
    if (line.spacing > length)
      reader_.complain(path + ".spacing", "must not exceed the length of the line, " + shortest(length) + " m");
  }

  void mesh() const {
    const MeshSource &mesh = *scene_.mesh;
    if (host_mesh_) {
      if (!mesh.file.empty() || !mesh.section.empty() || !mesh.terrain.file.empty())
        reader_.complain("mesh",
                         "has a source, but the host program brings the mesh: leave out file, section and terrain");
      if (mesh.halvings > 0)
        reader_.complain(
            "mesh.halvings",
            "has no effect on the mesh of a host program, which can refine its DMPlex itself: leave it out");
      return;
    }
    const int sources = !mesh.file.empty() + !mesh.section.empty() + !mesh.terrain.file.empty();
    if (sources != 1)
      reader_.complain("mesh", sources == 0 ? "needs a source: give file, section or terrain.file"
                                            : "has two sources: give one of file, section and terrain.file");
    if (!mesh.terrain.file.empty()) return terrain();
    if (!mesh.section.empty() && !(mesh.size > 0))
      reader_.complain("mesh.size", "must be a cell size above 0 m, since the mesh is made from a section");
    if (!mesh.section.empty() && scene_.up != Up::y)
      reader_.complain("mesh.section", "counts elevations along y and is drawn out along z: leave out up = \"z\"");
    for (std::size_t i = 0; i < mesh.refine.size(); ++i)
      box("mesh.refine." + std::to_string(i), mesh.refine[i].from, mesh.refine[i].to);
    if (mesh.file.empty()) return;
    for (const auto &[key, given] : {std::pair{"mesh.refine.0", !mesh.refine.empty()},
                                     {"mesh.size", mesh.size > 0},
                                     {"mesh.thickness", mesh.thickness > 0},
                                     {"mesh.cuts", !mesh.cuts.empty()}})
      if (given)
        reader_.complain(key,
                         "has no effect on a mesh from a file: change the mesh where it is made, or give a section");
  }

  void terrain() const {
    const MeshSource &mesh = *scene_.mesh;
    const TerrainSource &t = mesh.terrain;
    if (scene_.up != Up::z)
      reader_.complain("mesh.terrain.file", "counts elevations along z: set dimension = 3 and up = \"z\"");
    if (!(mesh.size > 0))
      reader_.complain("mesh.size", "must be a cell size above 0 m, since the mesh is made from terrain");
    for (const auto &[key, given] : {std::pair{"mesh.refine.0", !mesh.refine.empty()},
                                     {"mesh.thickness", mesh.thickness > 0},
                                     {"mesh.cuts", !mesh.cuts.empty()}})
      if (given) reader_.complain(key, "has no effect on a mesh from terrain: leave it out");
    if (!t.window.empty()) components("mesh.terrain.window", t.window.size(), 4, "numbers, west, south, east, north");
    if (!t.base.empty()) components("mesh.terrain.base", t.base.size(), 1, "elevation");
    const std::string path = "mesh.terrain.";
    if (!t.outline.empty() && !(t.depth > 0))
      reader_.complain(path + "outline", "needs depth, the largest depth of the slip surface within it");
    if (t.outline.empty() && t.depth > 0) reader_.complain(path + "depth", "has no effect without an outline");
    for (const LayerSource &layer : t.layer) {
      if (layer.file.empty()) reader_.complain(path + "layer." + layer.name, "needs file, a grid of elevations");
      if (t.base.empty())
        reader_.complain(path + "layer." + layer.name, "parts the ground over a flat base: give base, or leave it out");
    }
    for (std::size_t i = 0; i < t.way.size(); ++i)
      components(path + "way." + std::to_string(i), t.way[i].size(), 2, "coordinates, [x, y]");
    if (!t.way.empty() && !(t.way_width > 0))
      reader_.complain(path + "way", "needs way_width, the width of the strip of small cells along it");
    if (t.way.empty() && t.way_width > 0) reader_.complain(path + "way_width", "has no effect without a way");
    if (t.ellipsoid.given + !t.slip_surface.empty() + !t.outline.empty() > 1)
      reader_.complain(path + (t.ellipsoid.given ? "ellipsoid" : "outline"),
                       "is a second slip surface: give one of slip_surface, ellipsoid and outline");
    if (!t.ellipsoid.given) return;
    components("mesh.terrain.ellipsoid.centre", t.ellipsoid.centre.size(), 3, "coordinates");
    components("mesh.terrain.ellipsoid.semi_axes", t.ellipsoid.semi_axes.size(), 3, "lengths");
  }

  std::string up() const { return scene_.up == Up::y ? "y" : "z"; }

  void gravity() {
    if (scene_.vertical() >= scene_.dimension) reader_.complain("up", "needs dimension = 3: in plane strain y is up");
    std::vector<double> &gravity = scene_.gravity;
    if (gravity.empty()) gravity.assign(scene_.dimension, 0);
    if (gravity.size() == 1) {
      const double g = gravity[0];
      if (g < 0) reader_.complain("gravity", "must not be negative: a single number acts downwards");
      gravity.assign(scene_.dimension, 0);
      gravity[scene_.vertical()] = -g;
    }
    if (gravity.size() != static_cast<std::size_t>(scene_.dimension))
      reader_.complain("gravity", "must be one number, which acts downwards, or have " + dimension() + " components");
    if (-gravity[scene_.vertical()] < scene_.gravity_size() / 2) {
      const bool other = scene_.dimension == 3 && -gravity[3 - scene_.vertical()] >= scene_.gravity_size() / 2;
      reader_.complain(
          "gravity", "must point down, within 60 degrees of -" + up() + ", since elevations are counted along up = \"" +
                         up() + "\": " +
                         (other && mesh_is_terrain() ? "turn gravity to [0, 0, -9.81], since terrain has z up"
                          : other ? "set up = \"" + std::string(scene_.up == Up::y ? "z" : "y") + "\""
                                  : "turn the mesh, or set gravity to a number, which acts along -" + up()));
    }
  }

  bool mesh_is_terrain() const { return !scene_.mesh->terrain.file.empty(); }

  /// Does gravity act against up, as elevations are counted, or not at all?
  bool gravity_is_down() const { return -scene_.gravity[scene_.vertical()] >= (1 - 1e-12) * scene_.gravity_size(); }

  /// Density, or porosity and grain density, that follow from unit weights.
  void unit_weight(const std::string &path, BodySource &body) const {
    const double above = body.unit_weight, below = body.saturated_unit_weight, water = scene_.water->density;
    if (above == 0 && below == 0) return;
    const char *given = above > 0 ? ".unit_weight" : ".saturated_unit_weight";
    const double g = scene_.gravity_size();
    if (g == 0)
      reader_.complain(path + given, "cannot be used without gravity; give gravity, or density in place of it");
    if (body.density > 0 || body.grain_density > 0)
      reader_.complain(path + given, "is a second weight beside density or grain_density: give one of them");
    if (fluids_move(scene_.phases)) {
      if (above > 0)
        reader_.complain(path + given, "does not say how wet the soil is, and pore fluids move (phases = \"" +
                                           phases() + "\"): give saturated_unit_weight and porosity");
      body.grain_density = (below / g - body.porosity * water) / (1 - body.porosity);
      if (body.grain_density <= 0)
        reader_.complain(path + given, "must exceed the weight of the water in the pores, porosity times " +
                                           shortest(water * g) + " N/m3");
      return;
    }
    if (below == 0) {
      body.density = above / g;
      return;
    }
    if (scene_.phases == PhaseModel::dry)
      reader_.complain(path + ".saturated_unit_weight",
                       "has no effect, since phases = \"dry\" has no water table; give unit_weight");
    if (above == below && body.porosity == 0) {  // pores fill and dry without a change of weight
      body.density = above / g;
      return;
    }
    if (above == 0 || body.porosity > 0)
      reader_.complain(path + ".saturated_unit_weight",
                       above == 0 ? "needs unit_weight beside it, that of the soil above the water table"
                                  : "defines the pores with unit_weight; leave porosity out");
    body.porosity = (below - above) / (g * water);
    if (!(body.porosity >= 0 && body.porosity < 1))
      reader_.complain(path + ".saturated_unit_weight",
                       "must exceed unit_weight by 0 to " + shortest(water * g) + " N/m3, the unit weight of water");
    body.grain_density = above / (g * (1 - body.porosity));
  }

  void body(const BodySource &body) const {
    const std::string path = "body." + body.name;
    if (body.region.empty()) {
      std::vector<std::string> complete;
      for (const BodySource &other : scene_.body)
        if (!other.region.empty()) complete.push_back(other.name);
      const std::string near = nearest(body.name, complete);
      reader_.complain(path, "needs region, the name (or list of names) of the mesh's physical groups that it fills" +
                                 (near.empty() ? "" : "; or is this body `" + near + "`, misspelt?"));
    }
    if (body.volume_cap < 1 && body.volume_cap != 0 && body.volume_cap != -1)
      reader_.complain(path + ".volume_cap",
                       "must be 1 or more, 0 for no cap, or -1 for the default: soil has at least "
                       "its own volume");
    functions(path + ".velocity", body.velocity, scene_.dimension);
    functions(path + ".displacement", body.displacement, scene_.dimension);
    functions(path + ".body_acceleration", body.body_acceleration, scene_.dimension);
    functions(path + ".stress", body.stress, scene_.dimension == 2 ? 4 : 6);
    for (std::size_t i = 0; i < body.dense.size(); ++i) dense(path + ".dense." + std::to_string(i), body.dense[i]);
    weight(path, body);
    if (body.pore_pressure_ratio > 0) ratio(path + ".pore_pressure_ratio", body);
    if (body.water_table.given()) water_table(path + ".water_table", body);
    if (body.relative_permeability.reader && !body.retention.reader)
      reader_.complain(path + ".relative_permeability",
                       "has no effect without a retention curve, from which the degree of saturation follows: add [" +
                           path + ".retention] with curve, or leave [" + path + ".relative_permeability] out");
    if (body.permeability > 0 && body.hydraulic_conductivity > 0)
      reader_.complain(path + ".permeability", "is given twice: give permeability or hydraulic_conductivity");
  }

  void dense(const std::string &path, const DenseBox &dense) const {
    box(path, dense.from, dense.to);
    if (dense.particles_per_cell == 0)
      reader_.complain(path, "needs particles_per_cell, a whole number from 1 to 1000");
  }

  void weight(const std::string &path, const BodySource &body) const {
    const bool grains = body.porosity > 0 && body.grain_density > 0;
    const bool seeps =
        scene_.phases == PhaseModel::drained &&
        std::any_of(scene_.stage.begin(), scene_.stage.end(), [](const Stage &stage) { return stage.seeps(); });
    if ((fluids_move(scene_.phases) || seeps) && !grains)
      reader_.complain(path,
                       "needs porosity and grain_density, since pore water moves (phases = \"" + phases() + "\")");
    if (fluids_move(scene_.phases) || seeps) pores(path, body);
    if (body.density > 0 && body.grain_density > 0)
      reader_.complain(path + ".density", "is given twice: give density, or porosity and grain_density");
    if (!(body.density > 0) && !grains)
      reader_.complain(path, "needs a weight: give unit_weight, density, or porosity and grain_density");
  }

  void prescribed_pressure(const std::string &key) const {
    const auto flows = [](const Stage &stage) { return stage.water_flows(); };
    if (scene_.phases != PhaseModel::drained || std::any_of(scene_.stage.begin(), scene_.stage.end(), flows))
      reader_.complain(key, "prescribes the pore pressure, which needs phases = \"drained\" and no seepage stage");
  }

  /// Points of a water table, sorted by x, or its elevation at a level place.
  void table(const std::string &key, const WaterTable &table) const {
    const std::vector<std::vector<double>> &points = table.points;
    if (table.elevation.uses(up()))
      reader_.complain(key, "cannot depend on " + up() + ", the elevation itself, since up = \"" + up() + "\"");
    if (scene_.dimension == 2 && table.elevation.uses("z"))
      reader_.complain(key, "cannot depend on z, which plane strain (dimension = 2) has not");
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::string path = key + "." + std::to_string(i);
      components(path, points[i].size(), 2, "coordinates, [x, elevation]");
      if (i > 0 && points[i][0] <= points[i - 1][0])
        reader_.complain(path, "must lie to the right of the point before it: sort the points by x");
    }
  }

  void water_table(const std::string &key, const BodySource &body) const {
    prescribed_pressure(key);
    table(key, body.water_table);
    if (body.pore_pressure_ratio > 0)
      reader_.complain(key, "is a second pore pressure beside pore_pressure_ratio: give one of them");
  }

  void ratio(const std::string &key, const BodySource &body) const {
    prescribed_pressure(key);
    if (body.density == 0)
      reader_.complain(key,
                       "needs a weight that does not depend on a water table: give unit_weight or density, without "
                       "saturated_unit_weight, porosity and grain_density");
    if (!gravity_is_down() || scene_.gravity_size() == 0)
      reader_.complain(key, "needs gravity along -" + up() + ", since it counts the soil above along " + up() +
                                "; prescribe the pressure by water.excess where the axes are inclined");
  }

  void pores(const std::string &path, const BodySource &body) const {
    if (!(body.permeability > 0) && !(body.hydraulic_conductivity > 0))
      reader_.complain(path,
                       "needs permeability [m2] or hydraulic_conductivity [m/s], since pore water moves (phases = \"" +
                           phases() + "\")");
    const bool may_dry = scene_.phases == PhaseModel::drained
                             ? std::any_of(scene_.body.begin(), scene_.body.end(),
                                           [](const BodySource &b) { return b.retention.reader; })
                             : scene_.phases != PhaseModel::saturated;
    if (may_dry && !body.retention.reader)
      reader_.complain(path, "needs a retention curve, since its saturation may change (phases = \"" + phases() +
                                 "\"): add [" + path + ".retention] with curve");
  }

  void water() const {
    const bool drained = scene_.phases == PhaseModel::drained, dry = scene_.phases == PhaseModel::dry;
    if (drained && !scene_.water->given)
      reader_.complain(
          "phases",
          "needs pore water: add a table [water] with its table of points [x, elevation], or an empty one for none");
    if (scene_.gas->given && scene_.phases != PhaseModel::three_phase)
      reader_.complain("gas", "has no effect, since phases = \"" + phases() +
                                  "\" has no gas that moves; set phases = \"three-phase\"");
    if (dry && scene_.water->given)
      reader_.complain("water", "has no effect, since phases = \"dry\" has no pore water; set phases = \"drained\"");
    table("water.table", scene_.water->table);
    const bool seeps =
        std::any_of(scene_.stage.begin(), scene_.stage.end(), [](const Stage &stage) { return stage.water_flows(); });
    if (scene_.water->suction.given() && scene_.phases == PhaseModel::saturated)
      reader_.complain("water.suction",
                       "has no effect, since phases = \"saturated\" keeps all pores full of water under pressure; set "
                       "phases = \"unsaturated\", or leave it out");
    if (scene_.water->suction.given() && drained && !seeps)
      reader_.complain("water.suction",
                       "has no effect in a drained scene without a seepage stage: give suction as water.excess below "
                       "zero, or leave it out");
    const bool has_table =
        scene_.water->table.given() ||
        std::any_of(scene_.body.begin(), scene_.body.end(), [](const BodySource &b) { return b.water_table.given(); });
    if (!has_table && !(scene_.water->level.constant() && scene_.water->level(0) == 0))
      reader_.complain("water.level", "has no effect without a water table, which it raises: give water.table");
  }

  void factor_of_safety() const {
    const FactorSource &search = *scene_.factor_of_safety;
    for (const auto &[key, points, least] :
         {std::tuple{"within", &search.within, std::size_t(3)}, {"along", &search.along, std::size_t(2)}}) {
      const std::string path = std::string("factor_of_safety.") + key;
      if (!points->empty() && points->size() < least)
        reader_.complain(path, "must have at least " + std::to_string(least) + " points [x, elevation]");
      for (std::size_t i = 0; i < points->size(); ++i)
        if ((*points)[i].size() != 2)
          reader_.complain(path + "." + std::to_string(i),
                           "must have 2 coordinates, [x, elevation]" +
                               std::string(scene_.dimension == 3 ? ": it holds across the whole width" : ""));
      for (std::size_t i = 1; i < points->size(); ++i)
        if ((*points)[i] == (*points)[i - 1])
          reader_.complain(path + "." + std::to_string(i), "must not be the point before it again");
      uncrossed(path, *points, points == &search.within);
    }
    if (search.width > 0 && search.along.empty())
      reader_.complain("factor_of_safety.width", "has no effect without the line factor_of_safety.along");
    if (search.crack_water > FactorSource::no_water && search.tension_crack.empty())
      reader_.complain("factor_of_safety.crack_water", "has no effect without the line factor_of_safety.tension_crack");
    for (std::size_t i = 0; i < search.tension_crack.size(); ++i) {
      components("factor_of_safety.tension_crack", search.tension_crack[i].size(), 2, "coordinates in each point");
      if (search.tension_crack.size() < 2 || (i > 0 && search.tension_crack[i][0] <= search.tension_crack[i - 1][0]))
        reader_.complain("factor_of_safety.tension_crack",
                         "must be two or more points [x, elevation] whose x rises from each to the next");
    }
  }

  /// A polygon (closed) or a line whose sides do not cross one another.
  void uncrossed(const std::string &path, const std::vector<std::vector<double>> &points, bool closed) const {
    const std::size_t corners = points.size(), sides = closed ? corners : corners - (corners > 0);
    const auto side_of = [&](std::size_t a, std::size_t b, std::size_t c) {
      const std::vector<double> &p = points[a % corners], &q = points[b % corners], &r = points[c % corners];
      return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    };
    for (std::size_t i = 0; i < sides; ++i)
      for (std::size_t k = i + 1; k < sides; ++k)
        if (side_of(i, i + 1, k) * side_of(i, i + 1, k + 1) < 0 && side_of(k, k + 1, i) * side_of(k, k + 1, i + 1) < 0)
          reader_.complain(path, "must not cross itself, as its sides from points " + std::to_string(i) + " and " +
                                     std::to_string(k) + " do: give the points in their order along it");
  }

  void stage(const Stage &stage, const std::string &path) const {
    if (has_control_characters(stage.name))
      reader_.complain(path + ".name", "must be a name without line breaks and other control characters");
    if (const StaticKeys *keys = stage.finite_elements()) bodies_of(*keys, path);
    if (stage.water_flows()) flow(stage, path);
    if (!stage.seismic_coefficient().empty()) earthquake(stage.seismic_coefficient(), path + ".seismic_coefficient");
    if (stage.shakes() && scene_.earthquake.empty())
      reader_.complain(path + ".earthquake", "needs a motion: add [[earthquake]]");
    if (stage.shakes() && stage.damping() > 0)
      reader_.complain(path + ".damping",
                       "must be 0 in an earthquake: local damping takes a share of all motion, whatever its frequency");
    if (stage.motion() && !stage.motion()->damping_frequencies.empty()) rayleigh(stage, path + ".damping_frequencies");
    if (stage.begins_at_rest() && !gravity_is_down())
      reader_.complain(path + ".initial_stress",
                       "needs gravity along -" + up() + ", since it counts the soil above along " + up() +
                           "; give the stress by body.NAME.stress where the axes are inclined");
    if (stage.finds_factor()) factor(stage, path);
    const auto *fails = stage.motion() ? std::get_if<AtFailure>(&stage.motion()->until) : nullptr;
    if (fails) failure(*fails, path);
  }

  void rayleigh(const Stage &stage, const std::string &path) const {
    const std::vector<double> &frequencies = stage.motion()->damping_frequencies;
    if (frequencies.size() != 2) reader_.complain(path, "must be two frequencies, the lower one first");
    for (const double f : frequencies)
      if (!(f >= 0.01 && f <= 1000)) reader_.complain(path, "must be frequencies from 0.01 to 1000 Hz");
    if (!(frequencies[0] < frequencies[1])) reader_.complain(path, "must be two frequencies, the lower one first");
    if (stage.damping() > 0)
      reader_.complain(path,
                       "is a second damping beside damping = " + shortest(stage.damping()) + ": give one of them");
    if (std::ranges::none_of(scene_.body, [](const BodySource &body) { return body.damping_ratio > 0; }))
      reader_.complain(path, "has no effect without the damping_ratio of a body; give it, or leave this out");
    if (scene_.water->drag == PoreDrag::at_start)
      reader_.complain(path,
                       "cannot be combined with water.drag = \"explicit\", which needs the same part of the step");
  }

  void damping_ratio(const std::string &path, const BodySource &body) const {
    const auto damped = [](const Stage &stage) { return stage.damping_frequencies()[1] > 0; };
    if (body.damping_ratio > 0 && std::ranges::none_of(scene_.stage, damped))
      reader_.complain(path + ".damping_ratio",
                       "has no effect without damping_frequencies of a stage of motion; give them, or leave this out");
  }

  /// It judges what finite elements have found, and its results have the name of the stage where there are several.
  void factor(const Stage &stage, const std::string &path) const {
    const auto here = std::make_reverse_iterator(scene_.stage.begin() + (&stage - scene_.stage.data()));
    const auto before = std::find_if_not(here, scene_.stage.rend(), std::mem_fn(&Stage::finds_factor));
    if (before == scene_.stage.rend())
      reader_.complain(path + ".kind",
                       "needs a stage before it, whose soil it judges: put one of kind = \"quasi_static\" first");
    if (!before->is_static())
      reader_.complain(path + ".kind",
                       "cannot judge the motion of the stage before it: put a stage of kind = "
                       "\"quasi_static\" between them");
    const auto same = [&](const Stage &other) { return other.finds_factor() && other.name == stage.name; };
    if (stage.name.find('/') != std::string::npos || std::ranges::count_if(scene_.stage, same) > 1)
      reader_.complain(path + ".name",
                       "must be a name of its own without /, since results of the stage are factor_of_safety_NAME.csv");
  }

  void flow(const Stage &stage, const std::string &path) const {
    const bool drained = scene_.phases == PhaseModel::drained;
    if (scene_.phases != PhaseModel::saturated && scene_.phases != PhaseModel::unsaturated &&
        !(drained && stage.seeps()))
      reader_.complain(
          path + ".kind",
          "needs pore water that moves: set phases = \"saturated\" or \"unsaturated\"" +
              std::string(stage.seeps() ? " (or \"drained\", whose pressure is then computed by seepage)" : "") +
              ", not \"" + phases() + "\"");
    if (drained && !(scene_.water->excess.constant() && scene_.water->excess(0) == 0))
      reader_.complain("water.excess",
                       "cannot be combined with seepage, which computes the pressure: give pressures, heads or fluxes "
                       "at [boundary.NAME]");
    if (stage.soil_moves() && scene_.quasi_static->elements != Elements::quadratic)
      reader_.complain("quasi_static.elements",
                       "must be \"quadratic\" for consolidation: displacement of first order with pressure of first "
                       "order is not stable");
    if (stage.soil_moves() && scene_.quasi_static->linear_solver == LinearSolver::iterative)
      reader_.complain(
          "quasi_static.linear_solver",
          "must not be \"iterative\" for consolidation: its matrix is indefinite and is factorised; leave it out");
  }

  void earthquake(const std::vector<double> &coefficient, const std::string &path) const {
    components(path, coefficient.size(), scene_.dimension, "components");
    if (scene_.gravity_size() == 0)
      reader_.complain(path, "is a part of gravity, and the scene has none: give gravity");
    for (const double k : coefficient)
      if (!(std::abs(k) <= 2)) reader_.complain(path, "must have components from -2 to 2, parts of gravity");
  }

  void failure(const AtFailure &until, const std::string &path) const {
    std::vector<std::string> points;
    for (const OutputPoint &point : scene_.output->point) points.push_back(point.name);
    if (points.empty())
      reader_.complain(path, "ends by failure of a point, but the scene has no points: add [output.point.NAME]");
    if (std::find(points.begin(), points.end(), until.failure_point) == points.end())
      reader_.complain(path + ".failure_point",
                       "must name a point of [output.point.NAME]; " + suggestion(until.failure_point, points));
  }

  /// A stage adds bodies and structures that are not there, and removes those that are. What some stage adds is absent
  /// before.
  void bodies_that_come_and_go() const {
    std::vector<std::string> absent;
    for (const Stage &stage : scene_.stage)
      if (const StaticKeys *keys = stage.finite_elements())
        absent.insert(absent.end(), keys->add.begin(), keys->add.end());
    for (std::size_t i = 0; i < scene_.stage.size(); ++i) {
      const std::string path = "stage." + std::to_string(i);
      const StaticKeys *keys = scene_.stage[i].finite_elements();
      if (!keys) continue;
      for (const std::string &name : keys->add) {
        if (std::find(absent.begin(), absent.end(), name) == absent.end())
          reader_.complain(path + ".add", "adds " + kind_of(name) + name + ", which is there already: leave it out");
        std::erase(absent, name);
      }
      for (const std::string &name : keys->remove) {
        if (std::find(absent.begin(), absent.end(), name) != absent.end())
          reader_.complain(path + ".remove", "removes " + kind_of(name) + name +
                                                 ", which is not there: leave it out (what a stage adds is "
                                                 "absent before that stage)");
        absent.push_back(name);
      }
    }
  }

  std::string kind_of(const std::string &name) const {
    const bool body = std::ranges::any_of(scene_.body, [&](const BodySource &one) { return one.name == name; });
    return body ? "body." : "structure.";
  }

  /// Bodies and structures that come and go with a stage.
  void bodies_of(const StaticKeys &keys, const std::string &path) const {
    std::vector<std::string> names;
    for (const BodySource &body : scene_.body) names.push_back(body.name);
    for (const StructureSource &structure : scene_.structure) names.push_back(structure.name);
    for (const auto &[key, named] : {std::pair{".add", &keys.add}, {".remove", &keys.remove}})
      for (const std::string &name : *named)
        if (std::find(names.begin(), names.end(), name) == names.end())
          reader_.complain(path + key, "must name bodies or structures; there is no [body." + name + "]; " +
                                           suggestion(name, names));
  }

  /// Opposite corners, the smaller coordinates first.
  void box(const std::string &path, const std::vector<double> &from, const std::vector<double> &to) const {
    components(path + ".from", from.size(), scene_.dimension, "coordinates");
    components(path + ".to", to.size(), scene_.dimension, "coordinates");
    for (std::size_t i = 0; i < from.size(); ++i)
      if (!(from[i] < to[i])) reader_.complain(path + ".to", "must lie beyond `from` in every coordinate");
  }

  void functions(const std::string &path, const std::vector<Function> &value, int count) const {
    if (!value.empty()) components(path, value.size(), count, "components");
  }

  void components(const std::string &path, std::size_t given, std::size_t wanted, const std::string &what) const {
    if (given != wanted)
      reader_.complain(path, "must have " + std::to_string(wanted) + " " + what + ", not " + std::to_string(given) +
                                 " (dimension = " + dimension() + ")");
  }

  std::string phases() const { return name_of(scene_.phases); }
  std::string dimension() const { return std::to_string(scene_.dimension); }

  Scene &scene_;
  const TableReader &reader_;
  bool host_mesh_;
};

Scene parse(const std::string &text, const std::string &file, const std::vector<std::string> &overrides,
            bool host_mesh) {
  TableReader reader = TableReader::from_text(text, file, overrides);
  Scene scene;
  reader.fill(scene);
  Checks(scene, reader, host_mesh).all();
  scene.file = file;
  for (std::string one : overrides) {
    std::replace(one.begin(), one.end(), '\n', ' ');  // a comment ends with its line
    scene.source += "# --set " + one + "\n";
  }
  scene.source += text;
  scene.root = std::make_shared<TableReader>(reader);
  return scene;
}

}  // namespace

Scene parse_scene(const std::string &text, const std::string &file, const std::vector<std::string> &overrides) {
  return parse(text, file, overrides, false);
}

Scene parse_host_scene(const std::string &text, const std::string &name) { return parse(text, name, {}, true); }

Scene read_scene(const std::string &file, const std::vector<std::string> &overrides) {
  return parse_scene(read_text(file), file, overrides);
}

}  // namespace talus
