#include "simulation/unlikely.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.h"
#include "physics/pores/fluids.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "simulation/failure.h"
#include "simulation/unlikely_parts.h"

namespace talus {
namespace {

constexpr double least_cohesion = 20;  ///< [Pa]; less is doubted whatever the height
constexpr double no_effect = 1e-3;     ///< c over the weight per area of the soil: less does not decide what stands

Extent extent_of(const std::vector<BodyReport> &bodies) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Extent box{{far, far, far}, {-far, -far, -far}};
  for (const BodyReport &b : bodies)
    for (int d = 0; d < 3 && b.particles > 0; ++d)
      box.low[d] = std::min(box.low[d], b.low[d]), box.high[d] = std::max(box.high[d], b.high[d]);
  return box;
}

/// The faces of one side of the soil, found by their place on the level.
class LevelFaces {
 public:
  LevelFaces(const std::vector<SoilFace> &faces, int dimension, int up, double sign) : up_(up) {
    for (int d = 0; d < dimension; ++d)
      if (d != up) level_.push_back(d);
    for (const SoilFace &face : faces)
      if (sign * face.normal[up] > 1e-6) faces_.push_back(face);
    for (const SoilFace &face : faces_)
      for (int d : level_)
        for (int a = 0; a < dimension; ++a)
          low_[d] = std::min(low_[d], face.corner[a][d]), high_[d] = std::max(high_[d], face.corner[a][d]);
    std::array<int, 3> from{}, to{};
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      for (int d : level_) {
        from[d] = strips, to[d] = 0;
        for (int a = 0; a < dimension; ++a)
          from[d] = std::min(from[d], strip(d, faces_[k].corner[a][d])),
          to[d] = std::max(to[d], strip(d, faces_[k].corner[a][d]));
      }
      const int second = level_.back();
      for (int i = from[level_[0]]; i <= to[level_[0]]; ++i)
        for (int j = from[second]; j <= to[second]; ++j) in_[i * strips + j].push_back(static_cast<int>(k));
    }
  }
  const std::vector<SoilFace> &faces() const { return faces_; }

  /// Elevation of the lowest face at a place; not a number where there is none.
  double lowest(const std::array<double, 3> &x) const {
    double found = std::numeric_limits<double>::quiet_NaN();
    for (int k : in_[strip(level_[0], x[level_[0]]) * strips + strip(level_.back(), x[level_.back()])])
      if (const double z = elevation(faces_[k], x); !std::isnan(z) && !(z >= found)) found = z;
    return found;
  }

 private:
  static constexpr int strips = 128;
  int strip(int d, double x) const {
    return std::clamp(static_cast<int>((x - low_[d]) / (high_[d] - low_[d]) * strips), 0, strips - 1);
  }
  /// Of a face at a place on the level; not a number beside it.
  double elevation(const SoilFace &face, const std::array<double, 3> &x) const {
    constexpr double near = 1e-9;
    const auto &c = face.corner;
    const int i = level_[0], j = level_.back();
    if (level_.size() == 1) {
      const double s = (x[i] - c[0][i]) / (c[1][i] - c[0][i]);
      return s >= -near && s <= 1 + near ? c[0][up_] + s * (c[1][up_] - c[0][up_]) : NAN;
    }
    const double a = c[1][i] - c[0][i], b = c[2][i] - c[0][i], p = c[1][j] - c[0][j], q = c[2][j] - c[0][j];
    const double u = ((x[i] - c[0][i]) * q - (x[j] - c[0][j]) * b) / (a * q - b * p),
                 v = ((x[j] - c[0][j]) * a - (x[i] - c[0][i]) * p) / (a * q - b * p);
    if (!(u >= -near && v >= -near && u + v <= 1 + near)) return NAN;
    return c[0][up_] + u * (c[1][up_] - c[0][up_]) + v * (c[2][up_] - c[0][up_]);
  }

  int up_;
  std::vector<int> level_;  ///< axes
  std::vector<SoilFace> faces_;
  std::array<double, 3> low_{1e300, 1e300, 1e300}, high_{-1e300, -1e300, -1e300};
  std::vector<std::vector<int>> in_ = std::vector<std::vector<int>>(strips * strips);  ///< strips of both axes: faces
};

}  // namespace

double greatest_depth(const std::vector<SoilFace> &surface, int dimension, int up) {
  const LevelFaces above(surface, dimension, up, 1), below(surface, dimension, up, -1);
  double greatest = 0;
  for (const SoilFace &face : above.faces()) {
    std::array<double, 3> middle{};
    for (int a = 0; a < dimension; ++a)
      for (int d = 0; d < 3; ++d) middle[d] += face.corner[a][d] / dimension;
    if (const double bottom = below.lowest(middle); middle[up] - bottom > greatest) greatest = middle[up] - bottom;
  }
  return greatest;
}

double depth_of(int number, const BodyReport &body, const std::vector<SoilFace> &surface, int up, double greatest) {
  double ground = 0;
  for (const SoilFace &face : surface)
    if (face.body == number) ground += face.area * std::max(0., face.normal[up]);
  return ground > 0 ? std::min(greatest, 2 * body.volume / ground) : greatest;
}

std::string unlikely_height(double height, const std::string &what) {
  constexpr double highest = 5000;  // [m], a mountain
  if (height <= highest) return "";
  return what + " is " + rounded(height) + " m high; coordinates count in metres. Is the mesh in millimetres or feet?";
}

namespace {

/// How much of a body has a value beyond a limit.
struct Beyond {
  double share = 0;  ///< of its volume
  double most = 0;   ///< of all values
};

/// Of each body, for the values of a column times `sign`; nothing where the state lacks the column. Collective.
std::vector<Beyond> find_beyond(MPI_Comm comm, std::size_t bodies, const Snapshot &state, const char *name, double sign,
                                double limit) {
  const auto column = [&](const char *of) -> const std::vector<double> * {
    for (const Column &one : state.columns)
      if (one.name == of) return &one.values;
    return nullptr;
  };
  const auto *value = column(name), *volume = column("volume");
  if (!value || !volume) return {};  // of all ranks
  std::vector<Beyond> found(bodies);
  for (std::size_t b = 0; b < bodies; ++b) {
    double sums[2]{}, all[2], mine = 0;
    for (std::size_t i = 0; i < state.body.size(); ++i) {
      if (state.body[i] != static_cast<int>(b)) continue;
      sums[0] += (*volume)[i];
      if (!(sign * (*value)[i] > limit)) continue;
      sums[1] += (*volume)[i], mine = std::max(mine, sign * (*value)[i]);
    }
    MPI_Allreduce(sums, all, 2, MPI_DOUBLE, MPI_SUM, comm);
    MPI_Allreduce(&mine, &found[b].most, 1, MPI_DOUBLE, MPI_MAX, comm);
    found[b].share = all[0] > 0 ? all[1] / all[0] : 0;
  }
  return found;
}

constexpr double visible_share = 0.01;  // of a body; less are single particles

}  // namespace

std::vector<std::string> unlikely_strains(MPI_Comm comm, const std::vector<BodyReport> &bodies, const Snapshot &state) {
  constexpr double large = 10;
  std::vector<std::string> sentences;
  const std::vector<Beyond> found = find_beyond(comm, bodies.size(), state, "plastic_strain", 1, large);
  for (std::size_t b = 0; b < found.size(); ++b)
    if (found[b].share > visible_share)
      sentences.push_back(
          rounded(100 * found[b].share) + " % of body." + bodies[b].name + " has a plastic strain above " +
          rounded(100 * large) + " %, up to " + rounded(100 * found[b].most) +
          " %: this is the way that soil slid over the width of its band, which is that of a cell or two "
          "and no strain of a soil, so that smaller cells give more. Look at displacements instead; where "
          "the soil slides on a surface, kind = \"friction\" is that surface");
  return sentences;
}

std::vector<std::string> unlikely_suctions(MPI_Comm comm, const std::vector<BodyReport> &bodies,
                                           const Snapshot &state) {
  constexpr double nearly_all = 0.95;  // smoothing takes a little of it
  std::vector<std::string> sentences;
  const std::vector<Beyond> found =
      find_beyond(comm, bodies.size(), state, "pore_pressure", -1, -nearly_all * cavitation_pressure);
  for (std::size_t b = 0; b < found.size(); ++b)
    if (found[b].share > visible_share)
      sentences.push_back("The water in " + rounded(100 * found[b].share) + " % of body." + bodies[b].name +
                          " cavitates at the end, at " + rounded(cavitation_pressure / 1e3) +
                          " kPa: its pores have opened faster than water flows to them. This suction holds the soil "
                          "together; where air comes in instead, which phases = \"saturated\" does not have, there is "
                          "less of it");
  return sentences;
}

std::vector<std::string> unlikely_surroundings(const Scene &scene, const std::vector<BodyReport> &bodies,
                                               const std::vector<SoilFace> &surface) {
  constexpr double lowest = 0.01;  // [m], an experiment on a table
  std::vector<std::string> sentences;
  doubt_stages(scene, sentences);
  if (scene.gravity_size() == 0) return sentences;
  const Extent soil = extent_of(bodies);
  const int up = scene.vertical();
  const double height = soil.of(up);
  if (height < 0) return sentences;  // a later stage adds all soil
  if (const std::string sentence = unlikely_height(height, "The soil"); !sentence.empty())
    sentences.push_back(sentence);
  if (height < lowest)
    sentences.push_back("The soil is " + rounded(height) +
                        " m high; coordinates count in metres. Is the mesh in kilometres?");
  doubt_water(scene, soil, surface, sentences);
  doubt_ends(scene, soil, surface, sentences);
  doubt_thin_bodies(scene, bodies, sentences);
  return sentences;
}

namespace {

/// Sand that is steeper than its friction angle must fail, but in few cells over its depth it may move a little and
/// keep its slope.
void doubt_steep_faces(const Scene &scene, int number, const BodyReport &body, const std::vector<SoilFace> &surface,
                       double depth, std::vector<std::string> &sentences) {
  constexpr double enough = 10;             // cells over the depth
  constexpr double beyond = 5 * degree.si;  // the friction angle
  constexpr double share = 0.02;            // of the free surface, which contains level ground
  const double weight = body.mass / body.volume * scene.gravity_size() * depth;
  const double phi = body.strength.friction_angle[1];
  if (phi == 0 || body.strength.cohesion[1] > no_effect * weight || depth >= enough * body.cell_size) return;
  double all = 0, steep = 0;
  for (const SoilFace &face : surface) {
    const double up = face.normal[scene.vertical()];
    if (face.body != number || face.conditioned || up < -1e-6) continue;
    all += face.area;
    if (std::acos(std::clamp(up, 0., 1.)) > phi + beyond) steep += face.area;
  }
  if (steep <= share * all) return;
  sentences.push_back(rounded(100 * steep / all) + " % of the free surface of body." + body.name + " is more than " +
                      rounded(beyond / degree.si) + " degrees steeper than its friction angle of " +
                      rounded(phi / degree.si) +
                      " degrees, and it has hardly any cohesion: it has to fail. With fewer than " + rounded(enough) +
                      " cells over its depth (" + rounded(depth) + " m, cells of " + rounded(body.cell_size) +
                      " m) it may stand all the same. Take smaller cells (mesh.size, mesh.halvings) and compare two "
                      "sizes (talus converge)");
}

}  // namespace

std::vector<std::string> coarse_cells(const Scene &scene, const std::vector<BodyReport> &bodies,
                                      const std::vector<SoilFace> &surface) {
  constexpr double few = 4;  // over the depth: not even a slip surface fits in
  std::vector<std::string> sentences;
  if (scene.gravity_size() == 0) return sentences;
  const double depth = greatest_depth(surface, scene.dimension, scene.vertical());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyReport &body = bodies[b];
    if (body.particles == 0 || depth <= 0) continue;
    if (depth < few * body.cell_size)
      sentences.push_back("The soil is " + rounded(depth) + " m deep at most, and the cells of " + body.name +
                          " measure " + rounded(body.cell_size) + " m: fewer than " + rounded(few) +
                          " cells over the depth resolve neither stress nor slip surface. Take smaller cells "
                          "(mesh.size, mesh.halvings)");
    else if (scene.phases == PhaseModel::dry)
      doubt_steep_faces(scene, static_cast<int>(b), body, surface,
                        depth_of(static_cast<int>(b), body, surface, scene.vertical(), depth), sentences);
  }
  return sentences;
}

namespace {

/// Strength and stiffness that make no sense for soil as deep as this, though some other soil may have them.
void doubt_for_depth(const BodySource &source, const BodyReport &body, const Law &law, double weight,
                     std::vector<std::string> &sentences) {
  constexpr double stands_always = 100;    // c over the weight per area of the soil: all stands above
  constexpr double sand = 30 * degree.si;  // which is often given a trace of cohesion
  constexpr double rock = 1e6;             // [Pa]
  constexpr double fast = 2500;            // [m/s], waves in sound rock; dry soil has 150 to 1000
  const double c = body.strength.cohesion[1], phi = body.strength.friction_angle[1];
  const bool frictional = std::visit(
      [](const auto &one) {
        return requires { one.friction_angle; };
      },
      law);
  if (!frictional) return;
  if (c >= least_cohesion && c < no_effect * weight && phi < sand)
    sentences.push_back("body." + source.name + ".cohesion is " + rounded(c) + " Pa, " + rounded(c / weight) +
                        " of the weight of the soil, " + rounded(weight / 1e3) +
                        " kPa over its depth: it decides nothing, and clays with a friction angle of " +
                        rounded(phi / degree.si) + " deg have 1 to 50 kPa. Is it in kPa?");
  if (c > stands_always * weight && source.reduce_strength)
    sentences.push_back("body." + source.name + ".cohesion is " + rounded(c) + " Pa, " + rounded(c / weight) +
                        " times the weight of the soil, " + rounded(weight / 1e3) +
                        " kPa over its depth: such soil stands in any shape. Is it a unit too large? For rock or a "
                        "structure, reduce_strength = false says that a factor of safety does not concern it");
  const double young = 9 * bulk_modulus(law) * shear_modulus(law) / (3 * bulk_modulus(law) + shear_modulus(law));
  constexpr double stiffer = 5;  // soils and rocks have 50 to 1000
  if (c > 0 && young < stiffer * c && source.reduce_strength)
    sentences.push_back("The stiffness of body." + source.name + ", young_modulus = " + rounded(young / 1e6) +
                        " MPa, is " + rounded(young / c) + " times its cohesion of " + rounded(c / 1e3) +
                        " kPa: soils and rocks have 50 to 1000 times. Is one of the two in another unit?");
  const double speed = std::sqrt(constrained_modulus(law) * body.volume / body.mass);
  if (speed > fast && c < rock)
    sentences.push_back("The stiffness of body." + source.name + " gives waves a speed of " + rounded(speed) +
                        " m/s, as in sound rock, and its cohesion of " + rounded(c / 1e3) +
                        " kPa is that of soil, in which they have 150 to 1000 m/s. Is young_modulus a unit too "
                        "large? Soils have 1 MPa to 1 GPa");
}

/// The share of a load that water takes at once where it cannot flow, Skempton (1954), B = 1 / (1 + n K / K_l).
void doubt_soft_water(const Scene &scene, const BodySource &body, const Law &law, std::vector<std::string> &sentences) {
  constexpr double nearly_all = 0.8;
  if (!fluids_move(scene.phases) || !(body.porosity > 0)) return;
  const double stiffness = scene.water.bulk_modulus / body.porosity,
               share = stiffness / (stiffness + bulk_modulus(law));
  if (share >= nearly_all) return;
  sentences.push_back("water.bulk_modulus = " + rounded(scene.water.bulk_modulus / 1e6) +
                      " MPa is so soft beside body." + body.name + " (K = " + rounded(bulk_modulus(law) / 1e6) +
                      " MPa) that undrained load raises the pore pressure by " + rounded(100 * share) +
                      " % of it only. Water has " + rounded(Water().bulk_modulus / 1e6) +
                      " MPa; a softer one allows longer steps, and hardly changes the "
                      "answer while it takes more than 90 %");
}

}  // namespace

std::vector<std::string> unlikely_values(const Scene &scene, const std::vector<Law> &laws,
                                         const std::vector<BodyReport> &bodies, const std::vector<SoilFace> &surface) {
  std::vector<std::string> sentences;
  if (scene.root)
    for (const auto &[path, doubt] : scene.root->unusual())
      if (!scene.acknowledges(doubt.name)) sentences.push_back(doubt.text());
  const double depth = greatest_depth(surface, scene.dimension, scene.vertical());
  for (std::size_t b = 0; b < laws.size(); ++b) {
    const BodySource &body = scene.body[b];
    std::visit(
        [&](const auto &law) {
          if constexpr (requires { law.dilation_angle; })
            if (law.dilation_angle > 0 && scene.transfer.locking == Locking::nodal)
              sentences.push_back("body." + body.name +
                                  ".dilation_angle and transfer.locking = \"nodal\": strain is "
                                  "smoothed and stress is not, so that soil which dilates creates energy, in any step. "
                                  "Take transfer.locking = \"patches\", which is the default");
          if constexpr (requires { law.tension_cutoff; })
            if (const double apex = law.cohesion / std::tan(law.friction_angle);
                law.tension_cutoff > 0 && law.friction_angle > 0 && law.tension_cutoff >= apex)
              sentences.push_back("body." + body.name + ".tension_cutoff is " + rounded(law.tension_cutoff) +
                                  " Pa and has no effect: soil with this cohesion and friction angle bears no more "
                                  "tension than cohesion / tan(friction_angle) = " +
                                  rounded(apex) + " Pa");
        },
        laws[b]);
    if (body.volume_cap > 0 && fluids_move(scene.phases))
      sentences.push_back("body." + body.name + ".volume_cap = " + rounded(body.volume_cap) + " and phases = \"" +
                          name_of(scene.phases) +
                          "\": pores whose volume is held while gaps open are compressed when they close, each time a "
                          "little more, and their pressure throws soil out. Leave volume_cap out");
    if (bodies[b].particles > 0)
      doubt_water_without_friction(scene, static_cast<int>(b), bodies[b], laws[b], sentences);
    if (bodies[b].particles > 0 && scene.gravity_size() > 0 && depth > 0)
      doubt_for_depth(body, bodies[b], laws[b],
                      bodies[b].mass / bodies[b].volume * scene.gravity_size() *
                          depth_of(static_cast<int>(b), bodies[b], surface, scene.vertical(), depth),
                      sentences);
    doubt_soft_water(scene, body, laws[b], sentences);
  }
  return sentences;
}

}  // namespace talus
