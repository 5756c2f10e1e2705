#pragma once
/// A rigid block that slides on shaken ground (Newmark 1965, Géotechnique 15, 139-160), and regressions of its way.
#include <vector>

#include "earthquake/ground_motion.h"

namespace talus {

/// Way of a block against the ground over time, at the values of the record, and at its step after its end until the
/// block is at rest [m]. It slips down the slope while the ground accelerates uphill by more than the yield
/// acceleration, which is above 0, until both have one velocity again; `uphill` > 0 lets it slip up the slope too,
/// beyond that acceleration. The motion is positive uphill. Exact for acceleration that is linear between its values.
std::vector<double> sliding_block(const GroundMotion &motion, double yield, double uphill = 0);

/// An estimate of a displacement: its median, and the standard deviation of its natural logarithm [m], [-].
struct Estimate {
  double median = 0, deviation = 0;
};

/// Jibson (2007), Eng. Geol. 91, 209-218: of the critical acceleration ratio (eq. 6), with the magnitude (eq. 7), and
/// of Arias intensity [m/s] and critical acceleration [g] (eq. 9). Nothing where the ground never passes `yield`.
Estimate jibson_ratio(double yield, double peak);
Estimate jibson_magnitude(double yield, double peak, double magnitude);
Estimate jibson_arias(double yield, double arias);

/// Bray & Macedo (2019), J. Geotech. Geoenviron. Eng. 145, 04019106, ordinary motions of shallow crustal earthquakes:
/// of the yield coefficient [-], the fundamental period of the sliding mass, up to 0.7 s, the spectral acceleration
/// at 1.3 times this period [g], and the magnitude. `none`: probability that it does not move.
struct BrayMacedo : Estimate {
  double none = 0;
};
BrayMacedo bray_macedo(double yield_coefficient, double period, double spectral_acceleration, double magnitude);

}  // namespace talus
