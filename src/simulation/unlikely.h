#pragma once
/// What a scene may have but hardly means: most of it comes from a number in another unit than that of its key.
#include <mpi.h>

#include <string>
#include <vector>

#include "physics/laws/laws.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {

/// Greatest depth of the soil below its surface, along the axis `up` [m]: the height of a slope over a level base, and
/// the thickness of a slide that lies on a slope. 0 without faces.
double greatest_depth(const std::vector<SoilFace> &surface, int dimension, int up);

/// A sentence on soil, or a section, that is higher than any mountain [m]; empty otherwise. `what` is its subject.
std::string unlikely_height(double height, const std::string &what);

/// A sentence for each value of a soil that no soil has, or none of this depth, with the unit that may have been meant.
std::vector<std::string> unlikely_values(const Scene &scene, const std::vector<Law> &laws,
                                         const std::vector<BodyReport> &bodies, const std::vector<SoilFace> &surface);

/// A sentence for what fits the soil badly: its size, the direction of gravity, the place of the water table, open
/// water that is not level or fills a hollow, ends of the mesh without a condition, soil over free space, motion over
/// days. `bodies` and
/// `surface` as they are at the start.
std::vector<std::string> unlikely_surroundings(const Scene &scene, const std::vector<BodyReport> &bodies,
                                               const std::vector<SoilFace> &surface);

/// What is wrong with a body that is one element across where elements are of first order, and what to do.
std::string one_element_across(const Scene &scene, const std::string &body);

/// A sentence for each body whose cells are too large for the depth of the soil, or to let sand fail that is steeper
/// than its friction angle.
std::vector<std::string> coarse_cells(const Scene &scene, const std::vector<BodyReport> &bodies,
                                      const std::vector<SoilFace> &surface);

/// A sentence for each body of which more than a hundredth has a plastic strain above 10. `state` has the particles of
/// this rank. Collective.
std::vector<std::string> unlikely_strains(MPI_Comm comm, const std::vector<BodyReport> &bodies, const Snapshot &state);

/// The same of saturated soil of which more than a hundredth has a pore pressure below minus that of the atmosphere.
std::vector<std::string> unlikely_suctions(MPI_Comm comm, const std::vector<BodyReport> &bodies, const Snapshot &state);

/// How deep a body is at most, about: no deeper than twice its mean over the ground that it has, as a bowl is, so that
/// a slide has not the depth of the rock below it; the greatest depth of all soil where it has no ground [m].
double depth_of(int number, const BodyReport &body, const std::vector<SoilFace> &surface, int up, double greatest);

}  // namespace talus
