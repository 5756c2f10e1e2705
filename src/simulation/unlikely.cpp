#include "simulation/unlikely.h"

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

}  // namespace

std::vector<std::string> unlikely_values(const Scene &scene, const std::vector<Law> &laws) {
  constexpr double none = 1e300;
  std::vector<std::string> sentences;
  for (std::size_t b = 0; b < laws.size(); ++b) {
    const BodySource &body = scene.body[b];
    std::vector<Doubt> doubts{
        {"density", body.density, kilogram_per_cubic_metre, 100, 10e3, "t/m3"},
        {"grain_density", body.grain_density, kilogram_per_cubic_metre, 500, 10e3, "t/m3"},
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
