#include "output/strength.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "output/hdf5_file.h"
#include "output/replace_file.h"
#include "physics/laws/laws.h"
#include "physics/laws/strength_by_place.h"
#include "scene/body_source.h"
#include "scene/reader.h"
#include "scene/scene.h"

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

/// Lines of one soil.
void add_lines(const std::string &body, const Law &law, std::vector<StrengthLine> &lines) {
  constexpr double endless = 1e9;  // plastic strain after which the residual strength is left
  std::vector<double> suctions{0};
  if (reads_suction(law))
    for (double decade = 1e3; decade < 1e6; decade *= 10)
      for (const double step : {1, 2, 5}) suctions.push_back(step * decade);
  if (reads_suction(law)) suctions.push_back(1e6);
  for (const bool residual : {false, true})
    for (const double suction : suctions) {
      StrengthLine line{body, residual, suction, 0, 0};
      const bool found = law.visit([&](const auto &one) {
        return find_line(one, residual ? endless : 0, suction, &line.slope, &line.intercept);
      });
      if (found && (softens(law) || !residual)) lines.push_back(line);
    }
}

/// Least and largest c and phi of each body in the first snapshot, where it has these fields.
std::vector<StrengthRange> ranges_in(const Hdf5Reader &run) {
  const std::vector<std::string> snapshots = run.names("snapshots");
  if (snapshots.empty()) return {};
  const std::string first = "snapshots/" + snapshots.front();
  const std::vector<std::string> fields = run.names(first);
  if (std::ranges::find(fields, "cohesion") == fields.end()) return {};
  const std::vector<double> body = run.numbers(first + "/body"), c = run.numbers(first + "/cohesion"),
                            phi = run.numbers(first + "/friction_angle");
  constexpr double none = std::numeric_limits<double>::infinity();
  std::vector<StrengthRange> ranges(run.texts("bodies").size(), {{none, -none}, {none, -none}});
  for (std::size_t i = 0; i < body.size(); ++i) {
    StrengthRange &range = ranges[static_cast<std::size_t>(body[i])];
    range.cohesion = {std::min(range.cohesion[0], c[i]), std::max(range.cohesion[1], c[i])};
    const double angle = phi[i] * degree.si;
    range.friction_angle = {std::min(range.friction_angle[0], angle), std::max(range.friction_angle[1], angle)};
  }
  return ranges;
}

}  // namespace

std::vector<StrengthLine> strength_lines(const std::string &scene, const std::vector<StrengthRange> &ranges) {
  std::vector<StrengthLine> lines;
  const std::vector<BodySource> bodies = parse_scene(scene, "scene").body;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Law law = read_law(bodies[b].law);
    if (!reads_shares(law)) {
      add_lines(bodies[b].name, law, lines);
      continue;
    }
    for (const int end : {0, 1}) {
      if (b >= ranges.size() || !(ranges[b].cohesion[0] <= ranges[b].cohesion[1])) continue;
      Law of_place = law;
      const double c = ranges[b].cohesion[end], phi = ranges[b].friction_angle[end];
      take_largest(of_place, {{c, c}, {phi, phi}});
      add_lines(bodies[b].name, of_place, lines);
    }
  }
  return lines;
}

void write_strength(const std::string &dir) {
  const Hdf5Reader run(dir + "/run.h5");
  const auto lines = strength_lines(run.texts("values").at(0), ranges_in(run));
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
