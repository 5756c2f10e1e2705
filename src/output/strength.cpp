#include "output/strength.h"

#include <cmath>
#include <sstream>

#include "output/hdf5_file.h"
#include "output/replace_file.h"
#include "physics/laws/laws.h"
#include "scene/reader.h"

namespace talus {
namespace {

/// The line of a law after that plastic strain and at that suction; false where the law has none.
template <class OneLaw>
bool find_line(OneLaw law, double plastic_strain, double suction, double *slope, double *intercept) {
  if constexpr (requires { law.strength(0., Surroundings{1}).twice_c_cos_phi; }) {
    law.prepare();
    const auto m = law.strength(plastic_strain, Surroundings{1, suction});
    *slope = 6 * m.sin_phi / (3 - m.sin_phi), *intercept = 3 * m.twice_c_cos_phi / (3 - m.sin_phi);
    return true;
  } else if constexpr (requires { law.strength(0., Surroundings{1}).limit; }) {
    law.prepare();
    const auto m = law.strength(plastic_strain, Surroundings{1, suction});
    *slope = std::sqrt(3.) * m.eta, *intercept = std::sqrt(3.) * m.limit;
    return true;
  }
  return false;
}

}  // namespace

std::vector<StrengthLine> strength_lines(const std::string &scene) {
  constexpr double endless = 1e9;  // plastic strain after which the residual strength is left
  std::vector<StrengthLine> lines;
  for (const BodySource &body : parse_scene(scene, "scene").body) {
    const Law law = read_law(body.law);
    std::vector<double> suctions{0};
    if (reads_suction(law))
      for (double decade = 1e3; decade < 1e6; decade *= 10)
        for (const double step : {1, 2, 5}) suctions.push_back(step * decade);
    if (reads_suction(law)) suctions.push_back(1e6);
    const bool softens = std::visit(
        [](const auto &one) {
          if constexpr (requires { one.softens(); }) return one.softens();
          return false;
        },
        law);
    for (const bool residual : {false, true})
      for (const double suction : suctions) {
        StrengthLine line{body.name, residual, suction, 0, 0};
        const bool found = std::visit(
            [&](const auto &one) {
              return find_line(one, residual ? endless : 0, suction, &line.slope, &line.intercept);
            },
            law);
        if (found && (softens || !residual)) lines.push_back(line);
      }
  }
  return lines;
}

void write_strength(const std::string &dir) {
  const auto lines = strength_lines(Hdf5Reader(dir + "/run.h5").texts("scene").at(0));
  if (lines.empty()) return;
  std::ostringstream text;
  text.precision(12);
  text << "body,state,suction_Pa,slope,intercept_Pa\n";
  for (const StrengthLine &line : lines)
    text << line.body << "," << (line.residual ? "residual" : "peak") << "," << line.suction << "," << line.slope << ","
         << line.intercept << "\n";
  make_folder(dir + "/pictures");
  replace_file(dir + "/pictures/strength.csv", text.str());
}

}  // namespace talus
