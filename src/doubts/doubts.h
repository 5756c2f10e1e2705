#pragma once
/// What a scene or a run has but hardly means, and a wrong answer would follow from: relations between things, as rows
/// of tables. A value alone is doubted by the usual range of its key (scene/usual.h). Programs that run scenes link
/// this room; the library for host programs has none of it.
#include <mpi.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "physics/laws/law.h"
#include "scene/doubt.h"
#include "scene/doubt_names.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {

/// A row: what is doubtful where it holds. The sentence has no full stop.
struct Relation {
  DoubtName name;
  bool holds;
  std::string sentence;
};

/// A value that follows from others: "WHAT = 3 m/s; usual 4 to 5 m/s".
Relation unusual(DoubtName name, const std::string &what, double value, Unit unit, const Usual &usual);
/// Of all coordinates along gravity [m].
Relation unusual_height(double height);

/// Doubts that the scene does not acknowledge.
class Doubts {
 public:
  explicit Doubts(const Scene &scene) : scene_(scene) {}
  void add(const Doubt &doubt);
  void say(const std::vector<Relation> &table);
  const std::vector<std::string> &sentences() const { return sentences_; }

 private:
  const Scene &scene_;
  std::vector<std::string> sentences_;
};

/// "x = 3 to 4 m"
struct Span {
  double from = 1e300, to = -1e300;
  void widen(double x) { from = std::min(from, x), to = std::max(to, x); }
  std::string text(int axis) const;
};

/// Part of the surface of the soil.
struct Faces {
  double area = 0;                        ///< [m2], in 2D per metre of thickness [m]
  std::array<Span, 3> where;              ///< by axis
  std::vector<const SoilFace *> of = {};  ///< in the order of the surface
};

/// Soil and mesh as a run begins.
struct Start {
  const Scene &scene;
  std::vector<BodyReport> bodies;
  std::vector<Law> laws;  ///< of the bodies, with the largest strength of the place
  std::vector<SoilFace> surface;
  int up;
  std::array<double, 3> low, high;  ///< box around the cells of all bodies that are there [m]
  double depth;                     ///< of all soil below its surface at most, about; 0 without faces [m]

  Start(const Scene &scene, std::vector<BodyReport> bodies, std::vector<SoilFace> surface);
  Start(const Scene &scene, AnySimulation &simulation) : Start(scene, simulation.bodies(), simulation.surface()) {}
  double extent(int d) const { return high[d] - low[d]; }
  double height() const { return extent(up); }
  /// How deep a body is at most, or all soil, about: twice its mean over the ground that it has, as a wedge is, so that
  /// a slide has not the depth of the rock below it; `greatest` where it has no ground [m].
  double depth_of(std::optional<std::size_t> body, double greatest) const;
  double depth_of(std::size_t body) const { return depth_of(body, depth); }
  /// The faces that satisfy a condition.
  template <class Condition>
  Faces faces(const Condition &condition) const {
    Faces found;
    for (const SoilFace &face : surface) {
      if (!condition(face)) continue;
      found.area += face.area, found.of.push_back(&face);
      for (int a = 0; a < scene.dimension; ++a)
        for (int d = 0; d < scene.dimension; ++d) found.where[d].widen(face.corner[a][d]);
    }
    return found;
  }
};

struct Drainage;  // needs.h

/// All doubts about a scene and its soil. Collective.
std::vector<std::string> doubts_about(const Start &start);
/// What a run does not repeat of those of `talus check`: cells, and how the soil gets its weight and drains.
void doubt_before_run(const Start &start, const Drainage &drainage, Doubts &doubts);
/// All doubts about the state at the end of a run. Collective.
std::vector<std::string> doubts_about_end(const Scene &scene, MPI_Comm comm, const std::vector<BodyReport> &bodies,
                                          const Snapshot &state);
/// Lets a run say them in its log.
void say_doubts(RunOptions &options, const Scene &scene);

// Of `doubts_about`, a file each.
void doubt_scene(const Start &start, Doubts &doubts);
void doubt_ends(const Start &start, Doubts &doubts);
void doubt_water(const Start &start, Doubts &doubts);

constexpr const char *axis_names = "xyz";
/// Of the height of the soil: what no water table follows the ground more closely than.
constexpr double visible = 0.01;
/// May water stand on the face? Not on what faces down, and not where a support is.
inline bool may_be_flooded(const SoilFace &face, int up) { return !face.held && face.normal[up] > -1e-6; }
bool has_seepage(const Scene &scene);
bool has_flow_in_motion(const Scene &scene);  ///< of pore fluids with the soil
double end_of_loads(const Scene &scene);      ///< load time at the end of the stages [s]

}  // namespace talus
