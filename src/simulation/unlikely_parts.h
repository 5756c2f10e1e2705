#pragma once
/// The subjects of unlikely.h, a file each: water, ends of the mesh, stages. Each function adds its sentences.
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "physics/laws/laws.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {

constexpr const char *axis_names = "xyz";

/// The box around the cells of all bodies that are there.
struct Extent {
  std::array<double, 3> low, high;
  double of(int d) const { return high[d] - low[d]; }
};

constexpr double visible = 0.01;  ///< of the height of the soil: what no table follows the ground more closely than
/// The first stage of seepage, or the end of the stages.
inline std::vector<Stage>::const_iterator first_seepage(const Scene &scene) {
  return std::find_if(scene.stage.begin(), scene.stage.end(),
                      [](const Stage &stage) { return stage.kind == StageKind::seepage; });
}
/// May water stand on the face? Not on what faces down, and not where a support is.
inline bool may_be_flooded(const SoilFace &face, int up) { return !face.held && face.normal[up] > -1e-6; }

/// Water tables, open water, seepage.
void doubt_water(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                 std::vector<std::string> &sentences);
/// Of these what boundaries of the water do, on soil of this height [m], and what pores hold and conduct.
void doubt_water_boundaries(const Scene &scene, double height, const std::vector<SoilFace> &surface,
                            std::vector<std::string> &sentences);
void doubt_pores(const Scene &scene, std::vector<std::string> &sentences);
/// Soil of one body without friction, from whose strength the water takes nothing.
void doubt_water_without_friction(const Scene &scene, int body, const BodyReport &report, const Law &law,
                                  std::vector<std::string> &sentences);
/// Loads that act too late, gravity that is not all there.
void doubt_stages(const Scene &scene, std::vector<std::string> &sentences);
/// Soil that equilibrium by elements of first order will refuse, since these are one across it.
void doubt_thin_bodies(const Scene &scene, const std::vector<BodyReport> &bodies, std::vector<std::string> &sentences);
/// Ends and base of the soil that no boundary holds.
void doubt_ends(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                std::vector<std::string> &sentences);

}  // namespace talus
