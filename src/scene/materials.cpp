#include "scene/materials.h"

#include <cmath>
#include <cstdio>
#include <deque>

#include "scene/describe.h"

namespace talus {
namespace {

constexpr const char *das = "Das & Sobhan (2014), table 12.1", *das_weight = "Das & Sobhan (2014), table 3.2",
                     *das_grains = "Das & Sobhan (2014), chapter 2", *bowles = "Bowles (1996), table 2-8",
                     *bowles_nu = "Bowles (1996), table 2-7",
                     *terzaghi = "Terzaghi & Peck (1967), consistency of clay: half the unconfined strength",
                     *carsel = "Carsel & Parrish (1988), means of the textural class";

/// Soil without cohesion, drained strength.
Material granular(const char *name, const char *meaning, const char *friction, const char *friction_range,
                  const char *modulus, const char *modulus_range, const char *porosity, const char *void_ratio) {
  return {name,
          meaning,
          {{"law", "\"mohr_coulomb\"", "", ""},
           {"young_modulus", modulus, modulus_range, bowles},
           {"poisson_ratio", "0.3", "0.3 to 0.4", bowles_nu},
           {"cohesion", "0", "0", das},
           {"friction_angle", friction, friction_range, das},
           {"porosity", porosity, void_ratio, das_weight},
           {"grain_density", "2650", "2600 to 2700 kg/m3", das_grains}}};
}

/// Clay that does not drain: strength without friction, and the total density of the saturated clay.
Material undrained_clay(const char *name, const char *meaning, const char *strength, const char *strength_range,
                        const char *modulus, const char *modulus_range, const char *density,
                        const char *density_range) {
  return {name,
          meaning,
          {{"law", "\"mohr_coulomb\"", "", ""},
           {"young_modulus", modulus, modulus_range, bowles},
           {"poisson_ratio", "0.45", "0.4 to 0.5, saturated", bowles_nu},
           {"cohesion", strength, strength_range, terzaghi},
           {"friction_angle", "0", "0, undrained", terzaghi},
           {"density", density, density_range, das_weight}}};
}

/// Texts that are computed once; a deque does not move them.
const char *kept(const char *format, double value) {
  static std::deque<std::string> texts;
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return texts.emplace_back(text).c_str();
}

/// Van Genuchten's curve from theta_s, theta_r [-], alpha [1/cm], n [-] of a texture of the US Department of
/// Agriculture, with rho_w g = 9.81 kN/m3.
Material texture(const char *name, const char *meaning, double saturated, double residual, double alpha, double n) {
  return {name,
          meaning,
          {{"curve", "\"van_genuchten\"", "", carsel},
           {"reference_suction", kept("%.4g", 98.1 / alpha), kept("alpha = %g 1/cm", alpha), carsel},
           {"shape", kept("%.4g", 1 - 1 / n), kept("n = %g", n), carsel},
           {"residual_saturation", kept("%.3g", residual / saturated), kept("theta_r = %g", residual), carsel}}};
}

}  // namespace

const std::vector<Material> &soils() {
  static const std::vector<Material> all{
      granular("loose_sand", "loose sand of angular grains, drained", "32", "30 to 35 deg", "\"15 MPa\"",
               "10 to 25 MPa", "0.44", "void ratio 0.8, loose uniform sand"),
      granular("dense_sand", "dense sand of angular grains, drained", "42", "40 to 45 deg", "\"60 MPa\"",
               "50 to 81 MPa", "0.31", "void ratio 0.45, dense uniform sand"),
      granular("silt", "silt, drained", "30", "26 to 35 deg", "\"10 MPa\"", "2 to 20 MPa", "0.39",
               "void ratio 0.65, that of loose silty sand"),
      granular("gravel", "dense gravel with some sand, drained", "40", "34 to 48 deg", "\"150 MPa\"", "100 to 200 MPa",
               "0.29", "void ratio 0.4, that of dense silty sand"),
      undrained_clay("soft_clay", "soft saturated clay, undrained", "\"18 kPa\"", "12.5 to 25 kPa", "\"10 MPa\"",
                     "5 to 25 MPa", "1800", "1710 to 1890 kg/m3, of void ratio 1.4 to 0.9 and grains of 2700 kg/m3"),
      undrained_clay("medium_clay", "medium saturated clay, undrained", "\"37 kPa\"", "25 to 50 kPa", "\"25 MPa\"",
                     "15 to 50 MPa", "1900", "1710 to 2060 kg/m3, between those of soft and stiff clay"),
      undrained_clay("stiff_clay", "stiff saturated clay, undrained", "\"70 kPa\"", "50 to 100 kPa", "\"50 MPa\"",
                     "15 to 100 MPa, medium to hard", "2060", "2060 kg/m3, of void ratio 0.6 and grains of 2700 kg/m3"),
  };
  return all;
}

const std::vector<Material> &retention_curves() {
  static const std::vector<Material> all{
      texture("sand", "sand", 0.43, 0.045, 0.145, 2.68),
      texture("loamy_sand", "loamy sand", 0.41, 0.057, 0.124, 2.28),
      texture("sandy_loam", "sandy loam", 0.41, 0.065, 0.075, 1.89),
      texture("loam", "loam", 0.43, 0.078, 0.036, 1.56),
      texture("silt", "silt", 0.46, 0.034, 0.016, 1.37),
      texture("silt_loam", "silt loam", 0.45, 0.067, 0.020, 1.41),
      texture("sandy_clay_loam", "sandy clay loam", 0.39, 0.100, 0.059, 1.48),
      texture("clay_loam", "clay loam", 0.41, 0.095, 0.019, 1.31),
      texture("silty_clay_loam", "silty clay loam", 0.43, 0.089, 0.010, 1.23),
      texture("sandy_clay", "sandy clay", 0.38, 0.100, 0.027, 1.23),
      texture("silty_clay", "silty clay", 0.36, 0.070, 0.005, 1.09),
      texture("clay", "clay", 0.38, 0.068, 0.008, 1.09),
  };
  return all;
}

void describe_materials(Describer &describer) {
  for (const auto &[owner, list] :
       {std::pair{std::string("body.NAME"), &soils()}, {std::string("body.NAME.retention"), &retention_curves()}}) {
    Describer::Block names{"[" + owner + "] material",
                           owner,
                           "Library of materials: the table takes the keys of the "
                           "named material that it lacks itself.",
                           "",
                           {}};
    for (const Material &one : *list)
      names.keys.push_back({owner + ".material", std::string("\"") + one.name + "\"", "", one.meaning});
    describer.add(names);
    for (const Material &one : *list) {
      Describer::Block block{"[" + owner + "] material = \"" + one.name + "\"",
                             owner,
                             std::string("Library of materials: ") + one.meaning + ".",
                             one.name,
                             {}};
      for (const MaterialKey &key : one.keys)
        block.keys.push_back({owner + "." + key.key, key.range, key.value, key.source});
      describer.add(block);
    }
  }
}

}  // namespace talus
