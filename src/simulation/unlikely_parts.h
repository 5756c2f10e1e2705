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

/// Water tables, open water, seepage.
void doubt_water(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                 std::vector<std::string> &sentences);
/// Soil of one body without friction, from whose strength the water takes nothing.
void doubt_water_without_friction(const Scene &scene, int body, const BodyReport &report, const Law &law,
                                  std::vector<std::string> &sentences);
/// Loads that act too late, gravity that is not all there.
void doubt_stages(const Scene &scene, std::vector<std::string> &sentences);
/// Soil that equilibrium by elements of first order will refuse, since these are one across it.
void doubt_thin_bodies(const Scene &scene, const std::vector<BodyReport> &bodies, std::vector<std::string> &sentences);
/// Friction and adhesion of bases in other units.
void doubt_bases(const Scene &scene, const std::vector<SoilFace> &surface, std::vector<std::string> &sentences);
/// Ends and base of the soil that no boundary holds.
void doubt_ends(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                std::vector<std::string> &sentences);

}  // namespace talus
