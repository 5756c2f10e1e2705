#pragma once
/// Corrections of a record.
#include "earthquake/ground_motion.h"

namespace talus {

/// The part of a motion from `begin` to `end`, with the nearest values [s].
GroundMotion part_of(const GroundMotion &motion, double begin, double end);

/// Takes from the velocity the polynomial of this degree, 0 at t = 0, that fits it best, and its derivative from the
/// acceleration (Boore, Stephens & Joyner 2002, BSSA 92, 1543-1560).
void correct_baseline(GroundMotion &motion, int degree);

/// High-pass filter of Butterworth, of the second order, once forwards and once backwards: of the fourth order without
/// change of phase. The record is padded with zeros on both sides (Boore & Bommer 2005, Soil Dyn. Earthq. Eng. 25,
/// 93-115). `corner` [Hz], below half of the rate of the record.
void high_pass(GroundMotion &motion, double corner);

}  // namespace talus
