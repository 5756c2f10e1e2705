#pragma once
/// Runs scenes of quasi-static stages and reads their Gauss points: what the tests of this folder share. Solutions that
/// the elements hold exactly are right to the round-off of a linear solve: 1e-12 of the largest value is asked for, a
/// thousand times a double's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {

inline const std::string meshes = TALUS_MESHES;

struct Solved {
  Snapshot points;  ///< Gauss points of this rank
  HistoryTable history;
  std::vector<Event> events;

  const Column &column(const std::string &name) const {
    return *std::find_if(points.columns.begin(), points.columns.end(), [&](const Column &c) { return c.name == name; });
  }
  double value(const std::string &name, size_t i, int k = 0) const {
    const Column &c = column(name);
    return c.values[i * c.components + k];
  }
};

inline Solved solve(const std::string &text, const std::vector<std::string> &overrides = {},
                    MPI_Comm comm = PETSC_COMM_WORLD) {
  Scene scene = parse_scene(text, meshes + "/scene.toml", overrides);
  RunOptions options;
  options.pictures = options.screen = false, options.gauss_points = true;
  const auto simulation = make_simulation(comm, scene, options);
  simulation->run();
  return {simulation->snapshot(), simulation->history(), simulation->events()};
}

/// Largest |error(i, k)| over the Gauss points of all ranks.
template <class Error>
double largest(const Solved &solved, int components, Error &&error) {
  double most = 0;
  for (size_t i = 0; i < solved.points.id.size(); ++i)
    for (int k = 0; k < components; ++k) most = std::max(most, std::abs(error(i, k)));
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  return most;
}

/// A unit square of elastic soil without weight; keys of the soil may follow.
inline const std::string box = R"(
[mesh]
section = "box.csv"
size = 0.3
[body.soil]
region = "soil"
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
)";
inline const std::string block = box + R"(
density = 2000
[[stage]]
name = "load"
kind = "quasi_static"
duration = 1
load_steps = 1
)";
inline const std::vector<std::string> in_3d{"dimension=3", "mesh.thickness=1", "mesh.layers=0", "mesh.size=0.45"};
inline std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string> &b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace talus
