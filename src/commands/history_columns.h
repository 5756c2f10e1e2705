#pragma once
/// The columns that history.csv of a scene will have, before anything runs: from its points, bodies and boundaries and
/// the lists that the run itself uses. A column that one boundary or phase model lacks may be among them.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "physics/phase_models.h"
#include "scene/scene.h"
#include "simulation/output_fields.h"

namespace talus {

template <int dim>
std::vector<std::string> possible_columns(const Scene &scene) {
  std::vector<std::string> names{history_column("time", "s"), "step", "stage"};
  const PhaseTraits phases = phase_traits(scene.phases);
  const auto of_points = output_fields<ParticleState<dim>>(phases, {});  // without what follows from the laws
  for (const auto &point : scene.output.point) {
    const std::string prefix = point.name + "_";
    for (const std::string &name : of_points.tracked_names(prefix)) names.push_back(name);
    for (const auto &[quantity, unit] : {std::pair{"acceleration", "m/s2"}, std::pair{"mobilised_friction", "deg"},
                                         std::pair{"state", "-"}, std::pair{"plastic_strain", "-"}})
      names.push_back(history_column(prefix + quantity, unit));
  }
  RunRow<dim> row;
  row.fluids.resize(phases.fluids()), row.handed.resize(phases.fluids());
  for (const bool loads : {false, true})
    for (const BoundarySource &one : scene.boundary) {
      BoundaryRow<dim> boundary;
      boundary.name = one.name, boundary.loads = loads;
      boundary.inflow = boundary.is_base = boundary.remembers = boundary.heats = true;
      row.boundaries.push_back(boundary);
    }
  row.visit([&](const std::string &quantity, const char *unit, double) {
    const std::string name = history_column(quantity, unit);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  });
  return names;
}

inline std::vector<std::string> possible_columns(const Scene &scene) {
  return scene.dimension == 2 ? possible_columns<2>(scene) : possible_columns<3>(scene);
}

}  // namespace talus
