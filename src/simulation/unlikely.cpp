#include "simulation/unlikely.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.h"
#include "simulation/failure.h"

namespace talus {
namespace {

/// A key whose value lies outside of what soils have, and what it would be in the unit that was probably meant.
struct Doubt {
  const char *key;
  double value;        ///< SI
  Unit unit;           ///< in which the key counts numbers
  double least, most;  ///< of soils, from laboratory models of dust to rock, SI
  const char *meant;   ///< unit or key
};

constexpr const char *axes = "xyz";

/// The box around the cells of all bodies that are there.
struct Extent {
  std::array<double, 3> low, high;
  double of(int d) const { return high[d] - low[d]; }
};

Extent extent_of(const std::vector<BodyReport> &bodies) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Extent box{{far, far, far}, {-far, -far, -far}};
  for (const BodyReport &b : bodies)
    for (int d = 0; d < 3 && b.particles > 0; ++d)
      box.low[d] = std::min(box.low[d], b.low[d]), box.high[d] = std::max(box.high[d], b.high[d]);
  return box;
}

/// The axis to which gravity is nearest.
int nearest_axis(const Scene &scene) {
  const auto less = [](double a, double b) { return std::abs(a) < std::abs(b); };
  return static_cast<int>(std::max_element(scene.gravity.begin(), scene.gravity.end(), less) - scene.gravity.begin());
}

/// The water table of [water], which lies level beyond its ends.
void doubt_table(const Scene &scene, const Extent &soil, std::vector<std::string> &sentences) {
  const auto &table = scene.water.table;
  if (table.empty()) return;
  const double height = soil.of(1);
  if (table.size() > 1 && (table.front()[0] >= soil.high[0] || table.back()[0] <= soil.low[0]))
    sentences.push_back("water.table runs from x = " + rounded(table.front()[0]) + " to " + rounded(table.back()[0]) +
                        " m, beside the soil, which lies from " + rounded(soil.low[0]) + " to " +
                        rounded(soil.high[0]) + " m: the water there is level with the end of the table");
  const auto lower = [](const auto &a, const auto &b) { return a[1] < b[1]; };
  const auto [least, most] = std::minmax_element(table.begin(), table.end(), lower);
  const double level = scene.water.level(0, 0, 0, 0);
  if ((*least)[1] + level > soil.high[1] + 2 * height)
    sentences.push_back("water.table stands " + rounded((*least)[1] + level - soil.high[1]) +
                        " m or more above the top of the soil, which is " + rounded(height) +
                        " m high: all of it lies deep under open water. Is this meant?");
  if (!scene.water.level.depends_on_time() && scene.phases == PhaseModel::drained && (*most)[1] + level <= soil.low[1])
    sentences.push_back("water.table lies below all soil (its highest point is at y = " + rounded((*most)[1] + level) +
                        " m, the lowest soil at " + rounded(soil.low[1]) + " m): it gives no pore pressure");
}

}  // namespace

std::vector<std::string> unlikely_surroundings(const Scene &scene, const std::vector<BodyReport> &bodies) {
  constexpr double highest = 5000, lowest = 0.01;       // [m], from mountains to experiments on a table
  constexpr double centrifuge = 3000, asteroid = 1e-3;  // [m/s2]
  std::vector<std::string> sentences;
  const double g = scene.gravity_size();
  if (g == 0) return sentences;
  if (g < asteroid || g > centrifuge)
    sentences.push_back("gravity is " + rounded(g) + " m/s2; that of the earth is 9.81 m/s2. Is it in mm/s2?");
  if (scene.water.given && (scene.water.density < 500 || scene.water.density > 3000))
    sentences.push_back("water.density is " + rounded(scene.water.density) +
                        " kg/m3, which hardly any water has; a number without a unit counts in kg/m3. Is it in t/m3?");
  const Extent soil = extent_of(bodies);
  const int down = nearest_axis(scene);
  if (down != 1 || scene.gravity[1] > 0)
    sentences.push_back(std::string("gravity points along ") + (scene.gravity[down] > 0 ? "+" : "-") + axes[down] +
                        ", and not down along -y, which is the direction in which sections and water tables count "
                        "elevations. Is this meant?");
  const double height = soil.of(down);
  if (height < 0) return sentences;  // a later stage adds all soil
  if (height > highest)
    sentences.push_back("The soil is " + rounded(height) +
                        " m high; coordinates count in metres. Is the mesh in millimetres or feet?");
  if (height < lowest)
    sentences.push_back("The soil is " + rounded(height) +
                        " m high; coordinates count in metres. Is the mesh in kilometres?");
  doubt_table(scene, soil, sentences);
  return sentences;
}

std::vector<std::string> coarse_cells(const Scene &scene, const std::vector<BodyReport> &bodies) {
  constexpr double few = 4;  // over the height: not even a slip surface fits in
  std::vector<std::string> sentences;
  if (scene.gravity_size() == 0) return sentences;
  const double height = extent_of(bodies).of(nearest_axis(scene));
  for (const BodyReport &b : bodies)
    if (b.particles > 0 && height < few * b.cell_size)
      sentences.push_back("The soil is " + rounded(height) + " m high, and the cells of " + b.name + " measure " +
                          rounded(b.cell_size) + " m: fewer than " + rounded(few) +
                          " cells over the height resolve neither stress nor slip surface. Take smaller cells "
                          "(mesh.size)");
  return sentences;
}

std::vector<std::string> unlikely_values(const Scene &scene, const std::vector<Law> &laws) {
  constexpr double none = 1e300;
  std::vector<std::string> sentences;
  for (std::size_t b = 0; b < laws.size(); ++b) {
    const BodySource &body = scene.body[b];
    std::vector<Doubt> doubts{
        {"density", body.density, kilogram_per_cubic_metre, 100, 10e3, "t/m3"},
        {"grain_density", body.grain_density, kilogram_per_cubic_metre, 500, 10e3, "t/m3"},
        {"unit_weight", body.unit_weight, newton_per_cubic_metre, 5e3, 60e3, "kg/m3 (key density)"},
        {"saturated_unit_weight", body.saturated_unit_weight, newton_per_cubic_metre, 8e3, 60e3, "kg/m3"},
        {"permeability", body.permeability, square_metre, 0, 1e-6, "m/s (key hydraulic_conductivity)"},
    };
    std::visit(
        [&](const auto &law) {
          if constexpr (requires { law.young_modulus; })
            doubts.push_back({"young_modulus", law.young_modulus, pascal, 5e3, none, "kPa or MPa"});
          if constexpr (requires { law.friction_angle; }) {
            doubts.push_back({"cohesion", law.cohesion, pascal, 20, none, "kPa"});
            doubts.push_back({"friction_angle", law.friction_angle, degree, 2 * degree.si, none, "radians"});
          }
          if constexpr (requires { law.tension_cutoff; })
            if (const double apex = law.cohesion / std::tan(law.friction_angle);
                law.tension_cutoff > 0 && law.friction_angle > 0 && law.tension_cutoff >= apex)
              sentences.push_back("body." + body.name + ".tension_cutoff is " + rounded(law.tension_cutoff) +
                                  " Pa and has no effect: soil with this cohesion and friction angle bears no more "
                                  "tension than cohesion / tan(friction_angle) = " +
                                  rounded(apex) + " Pa");
        },
        laws[b]);
    for (const Doubt &one : doubts)
      if (one.value > 0 && (one.value < one.least || one.value > one.most))
        sentences.push_back("body." + body.name + "." + one.key + " is " + rounded(one.value / one.unit.si) + " " +
                            one.unit.name + ", which hardly any soil has; a number without a unit counts in " +
                            one.unit.name + ". Is it in " + one.meant + "?");
  }
  return sentences;
}

}  // namespace talus
