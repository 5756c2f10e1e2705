#pragma once
/// How a layer of soft soil on shaken rock moves: what it adds to a sliding block that is computed apart from it.
#include "earthquake/ground_motion.h"

namespace talus {

/// Mean acceleration of a layer over its height, which is that of a block with the same force at its base: an elastic
/// layer of fundamental period 4 H / v_s on rigid ground, by its modes (Makdisi & Seed 1978, J. Geotech. Eng. 104,
/// 849-867). Exact for a motion that is linear between its values. It goes on after the motion until a thousandth of
/// the vibration is left. `damping`: ratio of each mode, above 0.
GroundMotion layer_response(const GroundMotion &motion, double period, double damping);

}  // namespace talus
