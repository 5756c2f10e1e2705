#pragma once
/// What a scene or a run has but hardly means, and a wrong answer would follow from: relations between things. A value
/// alone is doubted by the usual range of its key (scene/usual.h). Programs that run scenes link this room; the library
/// for host programs has none of it.
#include <mpi.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "physics/boundary/pore_conditions.h"
#include "physics/laws/law.h"
#include "scene/boundary_source.h"
#include "scene/doubt.h"
#include "scene/doubt_names.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/water_table.h"
#include "simulation.h"

namespace talus {

/// Doubts that the scene does not acknowledge.
class Doubts {
 public:
  explicit Doubts(const Scene &scene) : scene_(scene) {}
  /// The sentence has no full stop.
  void say(DoubtName name, const std::string &sentence);
  /// The same of a value that follows from others: "WHAT = 3 m/s in body.sand; usual 4 to 5 m/s".
  void say_unusual(DoubtName name, const std::string &what, double value, Unit unit, const Usual &usual);
  void add(const Doubt &doubt);
  const std::vector<std::string> &sentences() const { return sentences_; }

 private:
  const Scene &scene_;
  std::vector<std::string> sentences_;
};

/// Soil and mesh as a run begins.
struct Start {
  const Scene &scene;
  std::vector<BodyReport> bodies;
  std::vector<Law> laws;  ///< of the bodies, with the largest strength of the place
  std::vector<SoilFace> surface;
  int up;
  std::array<double, 3> low, high;  ///< box around the cells of all bodies that are there [m]
  double
      depth;  ///< greatest, of the soil below its surface [m]: the height of a slope over a level base; 0 without faces

  Start(const Scene &scene, std::vector<BodyReport> bodies, std::vector<SoilFace> surface);
  Start(const Scene &scene, AnySimulation &simulation) : Start(scene, simulation.bodies(), simulation.surface()) {}
  double extent(int d) const { return high[d] - low[d]; }
  double height() const { return extent(up); }
  /// How deep a body is at most, about: twice its mean over the ground that it has, as a bowl is, so that a slide has
  /// not the depth of the rock below it; `greatest` where it has no ground [m].
  double depth_of(std::size_t body, double greatest) const;
  double depth_of(std::size_t body) const { return depth_of(body, depth); }
};

/// All doubts about a scene and its soil. Collective.
std::vector<std::string> doubts_about(const Start &start);
/// All doubts about the state at the end of a run. Collective.
std::vector<std::string> doubts_about_end(const Scene &scene, MPI_Comm comm, const std::vector<BodyReport> &bodies,
                                          const Snapshot &state);
/// Lets a run say them in its log.
void say_doubts(RunOptions &options, const Scene &scene);

/// A sentence on a mesh that is higher than any mountain [m]; empty otherwise.
std::string unlikely_height(double height);

// Of `doubts_about`, a file each.
void doubt_soil(const Start &start, Doubts &doubts);
void doubt_cells(const Start &start, Doubts &doubts);
void doubt_stages(const Scene &scene, Doubts &doubts);
void doubt_ends(const Start &start, Doubts &doubts);
void doubt_water(const Start &start, Doubts &doubts);
void doubt_open_water(const Start &start, Doubts &doubts);
void doubt_water_boundaries(const Start &start, Doubts &doubts);

constexpr const char *axis_names = "xyz";
constexpr double visible =
    0.01;  ///< of the height of the soil: what no water table follows the ground more closely than

/// "x = 3 to 4 m"
struct Span {
  double from = 1e300, to = -1e300;
  void widen(double x) { from = std::min(from, x), to = std::max(to, x); }
  std::string text(int axis) const;
};
inline double table_at(const WaterTable &table, const std::array<double, 3> &x) { return table.at(x[0], x[1], x[2]); }
/// May water stand on the face? Not on what faces down, and not where a support is.
inline bool may_be_flooded(const SoilFace &face, int up) { return !face.held && face.normal[up] > -1e-6; }
inline bool has_seepage(const Scene &scene) {
  return std::ranges::any_of(scene.stage, [](const Stage &stage) { return stage.seeps(); });
}
inline bool has_friction(const Law &law) { return frictional_strength(law); }
inline bool on_free_surface(const BoundarySource &boundary) {
  return std::ranges::count(boundary.group, std::string(free_surface)) > 0;
}

}  // namespace talus
