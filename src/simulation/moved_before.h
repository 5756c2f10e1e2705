#pragma once
/// Soil that slides before displacements are set to zero: what follows starts from a slope that has failed.
#include <string>
#include <vector>

#include "physics/laws/law.h"
#include "simulation.h"

namespace talus {

/// Upper estimate of how far elastic soil settles under its weight [m], docs/theory (5.9): each body bears the weight
/// of all, and is as thick as its box is high, or twice its mean thickness if that is less. `up` is the axis of
/// elevations.
double elastic_settlement(const std::vector<BodyReport> &bodies, const std::vector<Law> &laws, double gravity,
                          int dimension, int up);

/// A sentence if the largest displacement [m] at the end of a stage is several times the elastic one [m]; empty
/// otherwise. `plastic`: share of the soil that has yielded.
std::string moved_before_reset(const std::string &stage, double largest, double elastic, double plastic);

/// Plastic strain of soil that has yielded.
inline constexpr double yielded = 0.01;

}  // namespace talus
