#include "simulation/model.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "output/together.h"
#include "physics/boundary/rigid_shape.h"
#include "scene/body_source.h"
#include "scene/output_source.h"
#include "scene/reader.h"
#include "scene/rigid_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/structure_source.h"
#include "scene/water_source.h"
#include "simulation/changing_loads.h"
#include "simulation/dynamics.h"
#include "simulation/scene_keys.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

constexpr int free_space = -1;

/// A cell in plane strain, a facet, or a piece of a line.
template <int dim>
struct Piece {
  std::array<Vec<dim>, 3> corner{};  ///< [m]; a facet in plane strain and a piece of a line have two
  Vec<dim> normal{};                 ///< of a facet, out of the soil where there is some
  int body = free_space;
  int source = 0;  ///< of a facet: number of its boundary
};

template <int dim>
std::array<Vec<dim>, 3> sorted(std::array<Vec<dim>, 3> corner) {
  std::sort(corner.begin(), corner.end());
  return corner;
}

/// The pieces in an order that does not depend on the number of ranks; of facets that two cells share the one with soil
/// behind it.
template <int dim>
std::vector<Piece<dim>> in_order(const std::vector<Piece<dim>> &pieces) {
  struct Place {
    int source;
    std::array<Vec<dim>, 3> corner;
    auto operator<=>(const Place &) const = default;
  };
  std::vector<std::pair<Place, const Piece<dim> *>> places;
  places.reserve(pieces.size());
  for (const Piece<dim> &piece : pieces) places.push_back({{piece.source, sorted<dim>(piece.corner)}, &piece});
  std::stable_sort(places.begin(), places.end(), [](const auto &a, const auto &b) {
    const auto face = [](const auto &one) { return std::tie(one.second->body, one.second->normal); };
    return a.first != b.first ? a.first < b.first : face(a) > face(b);
  });
  std::vector<Piece<dim>> all;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (i == 0 || places[i].first != places[i - 1].first) all.push_back(*places[i].second);
  return all;
}

/// The pieces of all ranks, on the first one.
template <int dim>
std::vector<Piece<dim>> gathered(MPI_Comm comm, const std::vector<Piece<dim>> &mine) {
  return in_order(gather(comm, mine));
}

template <class Values, class ToJson>
Json list(const Values &values, const ToJson &to_json) {
  Json all = Json::array();
  for (const auto &value : values) all.push_back(to_json(value));
  return all;
}

std::string text_of(const Json &json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// The same as text: cells and faces are many, and as JSON values each takes four times as much.
template <class Values, class ToJson>
std::string text_of(const Values &values, const ToJson &to_json) {
  std::string all = "[";
  for (const auto &value : values) {
    if (all.size() > 1) all += ',';
    all += text_of(to_json(value));
  }
  return all + ']';
}

/// The text of an object with one more entry, which is text itself.
std::string with_entry(std::string object, const char *key, const std::string &value) {
  object.back() = ',';
  return object + '"' + key + "\":" + value + '}';
}

template <int dim>
std::vector<Vec<dim>> corners(const Piece<dim> &piece, int count) {
  return {piece.corner.begin(), piece.corner.begin() + count};
}

/// Writes the fields of a struct, with the defaults that the scene has not changed, in SI.
struct Fields {
  Json object;

  void number(const char *key, double value, Unit, Range, const char *) { object[key] = value; }
  void integer(const char *key, int value, Range, const char *) { object[key] = value; }
  void flag(const char *key, bool value, const char *) { object[key] = value; }
  void text(const char *key, const std::string &value, const char *) { object[key] = value; }
  void texts(const char *key, const std::vector<std::string> &value, const char *) { object[key] = value; }
  void point(const char *key, const std::vector<double> &value, Unit, const char *) { object[key] = value; }
  void point(const char *key, const std::vector<double> &value, Unit, const Usual &, const char *) {
    object[key] = value;
  }
  template <class Enum>
  void choice(const char *key, Enum value,
              std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>> choices, const char *) {
    for (const auto &[name, meant] : choices)
      if (meant == value) object[key] = name;
  }
  template <class Variant>
  void one_of(const char *key, Variant &value, const char *) {
    std::visit(
        [&](auto &kind) {
          object[key] = kind.name;
          kind.fields(*this);
        },
        value);
  }
};

/// Units by path of the table, kind ("": all kinds) and key.
Json units() {
  const Describer known = scene_keys();
  Json tables;
  for (const Describer::Block &block : known.blocks()) {
    Json keys = Json::object();
    for (const Describer::Key &key : block.keys)
      if (!key.unit.empty() || key.over_time)
        keys[key.path.substr(key.path.rfind('.') + 1)] = {{"unit", key.unit}, {"over_time", key.over_time}};
    tables[block.path][block.kind].update(keys);  // the drainage of a soil is a block of its own
  }
  return tables;
}

/// Makes the document; each part of it is collective.
template <int dim>
class Model {
 public:
  explicit Model(const World<dim> &world)
      : world_(world),
        scene_(world.scene),
        body_of_(bodies_of_cells(world.mesh, world.scene)),
        there_(world.present_at_start()) {}

  std::string document() {
    surface_ = world_.surface();
    const auto point = [](const OutputPoint &one) { return Json{{"name", one.name}, {"position", one.position}}; };
    const auto line = [](const OutputLine &one) { return Json{{"name", one.name}, {"points", one.points}}; };
    Json all{
        {"title", scene_.title}, {"dimension", dim}, {"phases", name_of(scene_.phases)}, {"gravity", scene_.gravity}};
    all["file"] = std::filesystem::path(scene_.file).filename().string();
    all["up"] = scene_.up == Up::y ? "y" : "z";
    all["scene"] = scene_.root ? scene_.root->values() : scene_.source;
    all["keys"] = units();
    all["bodies"] = bodies();
    all["water"]["tables"] = water_tables();
    all["water"]["line"] = line_of_no_pressure();
    all["water"]["surface"] = water_surface();
    all["rigid"] = rigid_bodies();
    if (!scene_.structure.empty()) all["structures"] = structures();
    all["stages"] = list(scene_.stage, [&](Stage stage) { return stage_of(stage); });
    all["points"] = list(scene_.output->point, point);
    all["lines"] = list(scene_.output->line, line);
    const std::string cells = this->cells(), boundaries = this->boundaries();
    if (rank_in(world_.comm) > 0) return "";
    return with_entry(with_entry(text_of(all), "cells", cells), "boundaries", boundaries);
  }

 private:
  using Source = typename World<dim>::Source;

  bool has_soil(int cell) const { return body_of_[cell] >= 0 && there_[body_of_[cell]]; }

  Json bodies() const {
    Json all = Json::array();
    for (std::size_t b = 0; b < scene_.body.size(); ++b)
      all.push_back({{"name", scene_.body[b].name}, {"there", bool(there_[b])}});
    return all;
  }

  Json rigid_bodies() const {
    return list(scene_.rigid, [](const RigidSource &source) {
      const auto centre =
          source.centre.empty() ? RigidShape<2>(source.polygon).centre() : Vec<2>{source.centre[0], source.centre[1]};
      return Json{{"name", source.name}, {"polygon", source.polygon}, {"centre", centre}};
    });
  }

  Json structures() const {
    return list(scene_.structure, [](const StructureSource &source) {
      return Json{{"name", source.name}, {"kind", source.kind_name()}, {"points", source.bar().points}};
    });
  }

  std::string cells() const {
    std::vector<Piece<dim>> mine;
    if constexpr (dim == 2) {
      const int cells = world_.mesh.cells_in_sheet();
      for (int c = 0; c < cells; ++c) {
        Piece<dim> cell;
        for (int a = 0; a < 3; ++a) cell.corner[a] = world_.mesh.position[world_.mesh.cells[c].node[a]];
        for (int copy = c; copy < world_.mesh.cell_count(); copy += cells)
          cell.body = std::max(cell.body, body_of_[copy]);
        mine.push_back(cell);
      }
    } else if (rank_in(world_.comm) == 0) {  // has the surface of all ranks
      for (const SoilFace &face : surface_) mine.push_back(piece_of(face));
    }
    return text_of(gathered(world_.comm, mine), [](const Piece<dim> &cell) {
      return Json{{"corners", corners(cell, 3)}, {"normal", cell.normal}, {"body", cell.body}};
    });
  }

  static Piece<dim> piece_of(const SoilFace &face) {
    Piece<dim> piece;
    for (int a = 0; a < dim; ++a) std::copy_n(face.corner[a].begin(), dim, piece.corner[a].begin());
    std::copy_n(face.normal.begin(), dim, piece.normal.begin());
    piece.body = face.body;
    return piece;
  }

  std::string boundaries() const {
    std::vector<const Source *> sources;
    for (const std::vector<Source> *some : {&world_.conditions.sources(), &world_.seepage_sources})
      for (const Source &source : *some) sources.push_back(&source);
    std::vector<Piece<dim>> mine;
    for (std::size_t s = 0; s < sources.size(); ++s)
      for (const std::string &group : sources[s]->groups) {
        if (!world_.mesh.has_group(group)) continue;  // such as free_surface
        for (const Facet<dim> &facet : world_.mesh.facets(group)) {
          if (facet.cell >= world_.mesh.cells_in_sheet() && !has_soil(facet.cell)) continue;
          Piece<dim> piece;
          for (int a = 0; a < dim; ++a) piece.corner[a] = world_.mesh.position[facet.node[a]];
          piece.normal = facet.normal, piece.source = static_cast<int>(s);
          if (has_soil(facet.cell)) piece.body = body_of_[facet.cell];
          mine.push_back(piece);
        }
      }
    std::vector<Piece<dim>> all = gathered(world_.comm, mine);
    const auto is_free = [](const Source *source) {
      return std::ranges::count(source->groups, std::string(free_surface)) > 0;
    };
    std::set<std::array<Vec<dim>, 3>> taken;  // by boundaries that have a say about the water
    if (std::ranges::any_of(sources, is_free))
      for (const Piece<dim> &piece : all)
        if (sources[piece.source]->kind.water != OnWater::surface) taken.insert(sorted<dim>(piece.corner));
    for (std::size_t s = 0; s < sources.size(); ++s) {
      if (rank_in(world_.comm) || !is_free(sources[s])) continue;
      for (const SoilFace &face : surface_) {
        Piece<dim> piece = piece_of(face);
        piece.source = static_cast<int>(s);
        if (!taken.contains(sorted<dim>(piece.corner))) all.push_back(piece);
      }
    }
    all = in_order(all);
    std::vector<std::vector<Piece<dim>>> faces(sources.size());
    for (const Piece<dim> &piece : all) faces[piece.source].push_back(piece);
    std::string found = "[";
    for (std::size_t s = 0; s < sources.size(); ++s) found += (s ? "," : "") + boundary(*sources[s], faces[s]);
    return found + ']';
  }

  /// Least and largest value of what a boundary prescribes.
  class Values {
   public:
    void add(const std::string &name, const char *unit, double value) {
      if (!std::isfinite(value)) return;
      const auto [at, is_new] = found_.emplace(name, Span{unit, value, value});
      at->second.low = std::min(at->second.low, value), at->second.high = std::max(at->second.high, value);
    }
    Json json() const {
      return list(found_, [](const auto &one) {
        const auto &[name, span] = one;
        return Json{{"name", name}, {"unit", span.unit}, {"low", span.low}, {"high", span.high}};
      });
    }

   private:
    struct Span {
      const char *unit;
      double low, high;
    };
    std::map<std::string, Span> found_;
  };

  std::string boundary(const Source &source, const std::vector<Piece<dim>> &faces) const {
    const Boundary &kind = source.kind;
    const OnSoil action = kind.in_motion != OnSoil::none ? kind.in_motion : kind.quasi_static;
    constexpr const char *water[] = {"surface", "wall", "pressure", "seepage", "flux", "outflow"};
    constexpr const char *gas[] = {"surface", "wall", "atmosphere", "pressure"};
    Values values;
    double level = std::numeric_limits<double>::quiet_NaN();
    const std::string drawn = text_of(faces, [&](const Piece<dim> &face) {
      Vec<dim> centre{}, vector{};
      for (int a = 0; a < dim; ++a)
        for (int d = 0; d < dim; ++d) centre[d] += face.corner[a][d] / dim;
      if (face.body >= 0) {  // functions need not be defined where there is no soil
        Values of_centre;
        vector = exerted(kind, action, face, centre, of_centre);
        level = std::fmax(level, look_at_pores(kind, centre, of_centre));
        for (int a = 0; a < dim; ++a) {  // between which the values of the centre lie
          exerted(kind, action, face, face.corner[a], values);
          look_at_pores(kind, face.corner[a], values);
        }
      }
      return Json{
          {"corners", corners(face, dim)}, {"normal", face.normal}, {"soil", face.body >= 0}, {"vector", vector}};
    });
    const Json found{{"name", source.name},
                     {"groups", source.groups},
                     {"soil", action_on_soil(action, kind.template on_soil<dim>())},
                     {"water", water[static_cast<int>(kind.water)]},
                     {"gas", gas[static_cast<int>(kind.gas)]},
                     {"changes", !kind.changes.empty()},
                     {"values", values.json()},
                     {"level", level}};
    return with_entry(text_of(found), "faces", drawn);
  }

  /// Load [Pa] or velocity [m/s] at a place of a face at the start; `values` takes what the boundary prescribes there.
  static Vec<dim> exerted(const Boundary &kind, OnSoil action, const Piece<dim> &face, const Vec<dim> &place,
                          Values &values) {
    const auto &on_soil = kind.template on_soil<dim>();
    const double x = place[0], y = place[1], z = dim == 3 ? place[dim - 1] : 0;
    Vec<dim> vector{};
    if (action == OnSoil::load) vector = on_soil.load(face.normal, place, 0);
    if (action == OnSoil::support && on_soil.speed)
      for (const Vec<dim> &direction : on_soil.directions(face.normal)) {
        const double speed = on_soil.speed(direction, place, 0);
        for (int d = 0; d < dim; ++d) vector[d] += speed * direction[d];
      }
    double inwards = 0, square = 0;
    for (int d = 0; d < dim; ++d) inwards -= vector[d] * face.normal[d], square += vector[d] * vector[d];
    if (action == OnSoil::load)
      kind.follows ? values.add("pressure", "Pa", inwards) : values.add("traction", "Pa", std::sqrt(square));
    if (action == OnSoil::support && on_soil.speed) values.add("velocity", "m/s", std::sqrt(square));
    if (kind.friction_coefficient)
      values.add("friction angle", "deg", std::atan(kind.friction_coefficient(x, y, z, 0, 0)) / degree.si);
    if (kind.adhesion) values.add("adhesion", "Pa", kind.adhesion(x, y, z, 0, 0));
    return vector;
  }

  /// The same for the pores; the level of open water [m], not a number where there is none.
  double look_at_pores(const Boundary &kind, const Vec<dim> &place, Values &values) const {
    const double x = place[0], y = place[1], z = dim == 3 ? place[dim - 1] : 0;
    double level = std::numeric_limits<double>::quiet_NaN();
    if (kind.outside) {
      const double weight = scene_.water->density * scene_.gravity_size(), elevation = place[scene_.vertical()],
                   p = kind.outside(x, y, z, 0, {weight, elevation});
      if (kind.open_water && weight > 0 && p > 0) level = elevation + p / weight;
      values.add(p < 0 ? "suction" : "pore pressure", "Pa", std::abs(p));
    }
    if (kind.supply && !kind.open_water) values.add("supply", "m/s", kind.supply(x, y, z, 0, 1));
    if (kind.inflow) values.add("inflow", "m/s", kind.inflow(x, y, z, 0));
    if (kind.gas_outside) values.add("gas pressure", "Pa", kind.gas_outside(x, y, z, 0));
    return level;
  }

  static const char *action_on_soil(OnSoil action, const SoilFunctions<dim> &functions) {
    Vec<dim> any{};  // normal of a face: how many directions are held does not depend on it
    any[0] = 1;
    switch (action) {
      case OnSoil::none:
      case OnSoil::refused:
        return "none";
      case OnSoil::support:
        return functions.speed ? "velocity" : functions.directions(any).size() == dim ? "fixed" : "roller";
      case OnSoil::contact:
        return "base";
      case OnSoil::load:
        return "load";
      case OnSoil::tied:
        return "tied";
      case OnSoil::dashpot:
        return "dashpot";
    }
    return "none";
  }

  /// The common water table, and those of bodies that have one of their own, as far as they are polylines.
  Json water_tables() const {
    struct Table {
      std::string body;
      const std::vector<std::vector<double>> *points;
    };
    std::vector<Table> tables;
    if (!scene_.water->table.points.empty()) tables.push_back({"", &scene_.water->table.points});
    for (const BodySource &body : scene_.body)
      if (!body.water_table.points.empty()) tables.push_back({body.name, &body.water_table.points});
    const double rise = tables.empty() ? 0 : scene_.water->level(0);
    return list(tables, [&](const Table &table) {
      std::vector<std::vector<double>> points = *table.points;
      for (std::vector<double> &point : points) point[1] += rise;
      return Json{{"body", table.body}, {"points", points}};
    });
  }

  /// Water tables that are functions of the level place, such as grids, over the faces of the ground of their soil: a
  /// triangle in the middle of each, since a grid need not reach beyond the soil.
  Json water_surface() const {
    std::vector<Piece<dim>> pieces;
    const int up = scene_.vertical();
    constexpr double steep = 0.2, share = 0.7;  // of the normal of ground, and of the size of the face
    for (const SoilFace &face : surface_) {
      if (dim == 2 || face.normal[up] < steep) continue;
      const WaterTable &own = scene_.body[face.body].water_table, &table = own.given() ? own : scene_.water->table;
      if (!table.elevation.given()) continue;
      Piece<dim> piece = piece_of(face);
      Vec<dim> middle{};
      for (const Vec<dim> &corner : piece.corner)
        for (int d = 0; d < dim; ++d) middle[d] += corner[d] / 3;
      for (Vec<dim> &corner : piece.corner) {
        for (int d = 0; d < dim; ++d) corner[d] = middle[d] + share * (corner[d] - middle[d]);
        corner[up] = table.at(corner[0], corner[1], corner[dim - 1]) + scene_.water->level(0);
      }
      pieces.push_back(piece);
    }
    return list(in_order(pieces), [](const Piece<dim> &piece) { return corners(piece, 3); });
  }

  /// Where the prescribed pore pressure ends in the soil, if it is not only that of a polyline; in plane strain.
  Json line_of_no_pressure() const {
    std::vector<Piece<dim>> mine;
    const Function &excess = scene_.water->excess;
    const bool by_ratio =
        std::ranges::any_of(scene_.body, [](const BodySource &body) { return body.pore_pressure_ratio > 0; });
    const bool by_function =
        scene_.water->table.elevation.given() ||
        std::ranges::any_of(scene_.body, [](const BodySource &body) { return body.water_table.elevation.given(); });
    const bool told = by_function || by_ratio || !excess.constant() || excess(0) != 0;
    for (int c = 0; dim == 2 && world_.phases.prescribed && told && c < world_.mesh.cell_count(); ++c) {
      if (!has_soil(c)) continue;
      const int soil = world_.pressure.soil_of(c);
      const auto wet = [&](const Vec<dim> &x) { return world_.pressure(x, 0, soil) > 0; };
      const auto &node = world_.mesh.cells[c].node;
      Piece<dim> piece;
      int ends = 0;
      for (int a = 0; a < 3; ++a) {
        Vec<dim> inside = world_.mesh.position[node[a]], outside = world_.mesh.position[node[(a + 1) % 3]];
        if (wet(inside) == wet(outside)) continue;
        if (!wet(inside)) std::swap(inside, outside);
        constexpr int halvings = 30;  // to a billionth of the edge
        for (int i = 0; i < halvings; ++i) {
          Vec<dim> middle;
          for (int d = 0; d < dim; ++d) middle[d] = (inside[d] + outside[d]) / 2;
          (wet(middle) ? inside : outside) = middle;
        }
        piece.corner[ends++] = inside;
      }
      if (ends == 2) mine.push_back(piece);
    }
    return list(gathered(world_.comm, mine), [](const Piece<dim> &piece) { return corners(piece, 2); });
  }

  Json stage_of(Stage &stage) const {
    Fields fields;
    stage.fields(fields);
    const std::array<double, 3> acceleration = scene_.acceleration_in(stage);
    std::vector<std::string> changes;
    if (!stage.hold_loads)
      for (const ChangingLoad &load : changing_loads(world_.scene)) changes.push_back(load.key);
    fields.object["acceleration"] = std::vector<double>(acceleration.begin(), acceleration.begin() + dim);
    fields.object["integrator"] = std::visit([](const auto &one) { return one.name; }, choose_integrator(scene_));
    fields.object["changes"] = changes;
    return fields.object;
  }

  const World<dim> &world_;
  const Scene &scene_;
  const std::vector<int> body_of_;  ///< [cell]
  const std::vector<char> there_;   ///< [body] from the start
  std::vector<SoilFace> surface_;
};

}  // namespace

template <int dim>
std::string model_of(const World<dim> &world) {
  return Model<dim>(world).document();
}

template std::string model_of(const World<2> &world);
template std::string model_of(const World<3> &world);

}  // namespace talus
