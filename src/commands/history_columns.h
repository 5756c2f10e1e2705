#pragma once
/// The columns that history.csv of a scene will have, before anything runs: from its points, bodies and boundaries and
/// the lists that the run itself uses. A column that one boundary or phase model lacks may be among them.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "physics/phase_models.h"
#include "scene/boundary_source.h"
#include "scene/output_source.h"
#include "scene/scene.h"
#include "simulation/output_fields.h"

namespace talus {

template <int dim>
std::vector<std::string> possible_columns(const Scene &scene) {
  std::vector<std::string> names{history_column("time", "s"), "step", "stage"};
  const PhaseTraits phases = phase_traits(scene.phases);
  const auto of_points = output_fields<ParticleState<dim>>(phases, {});  // without what follows from the laws
  for (const auto &point : scene.output->point) {
    auto columns = of_points.tracked();
    columns.insert(columns.end(),
                   {{"acceleration", "m/s2"}, {"mobilised_friction", "deg"}, {"state", "-"}, {"plastic_strain", "-"}});
    for (const auto &[quantity, unit] : columns) names.push_back(column_of("point", point.name, quantity, unit).name);
  }
  RunRow<dim> row;
  row.fluids.resize(phases.fluids()), row.handed.resize(phases.fluids());
  if (!scene.earthquake.empty()) row.ground.emplace();
  for (const bool loads : {false, true})
    for (const BoundarySource &one : scene.boundary) {
      BoundaryRow<dim> boundary;
      boundary.name = one.name, boundary.loads = loads;
      boundary.inflow = boundary.is_base = boundary.remembers = boundary.heats = true;
      row.boundaries.push_back(boundary);
    }
  row.visit([&](const HistoryColumn &column, double) {
    if (std::ranges::find(names, column.name) == names.end()) names.push_back(column.name);
  });
  return names;
}

inline std::vector<std::string> possible_columns(const Scene &scene) {
  return scene.dimension == 2 ? possible_columns<2>(scene) : possible_columns<3>(scene);
}

}  // namespace talus
