#pragma once
/// The strength that a point of a frictional soil or of Hoek-Brown's rock has now, how much of it the stress takes, and
/// what has become of it. For results, not for the particle loop: some tenths of a microsecond a point.
#include "physics/laws/law.h"

namespace talus {

/// What has become of the strength of a point.
enum class StrengthState {
  elastic = 0,    ///< within the yield surface, and no strength is lost
  peak = 1,       ///< at the yield surface, and no strength is lost
  softening = 2,  ///< a part of the strength is lost
  residual = 3,   ///< the residual strength is left
};

/// Friction angle of a point that its stress mobilises, and the state of its strength.
struct Mobilised {
  double friction_angle;  ///< [rad]; 0 without stress, NaN where the soil has no friction angle
  StrengthState state;
};

/// What a frictional law takes for the softening of a point.
struct SofteningInput {
  double plastic_strain = 0;  ///< that of the point of stress, or its average over the averaging length of the body [-]
  double size = 0;            ///< width of a band: element size, or twice the averaging length [m]
};

/// The strength of one soil over plastic strain, suction and place.
class PresentStrength {
 public:
  explicit PresentStrength(const Law &law);

  /// Has the law a strength that is shown? Otherwise it is not to be asked.
  bool known() const { return known_; }
  /// Of an effective stress and the plastic strain by which the law softens. The mobilised angle is that of the Mohr
  /// circle which touches an envelope through the apex of the present strength, sin(phi_m) = (s1 - s3) / (2 c cot(phi)
  /// - s1 - s3), s1 the largest principal stress, positive in tension (Alonso, Yerro & Pinyol 2015, eq. (20), of the
  /// plane quantities). It is phi at the yield surface of Mohr and Coulomb; on a cone of Drucker and Prager it may be
  /// larger or smaller. A point counts as at its yield surface from 99 % of its strength on, and strength as lost, or
  /// residual, where 5 %, or 95 %, of the fall from peak to residual is over.
  template <int dim>
  Mobilised operator()(const Stress<dim> &stress, double plastic_strain, const Surroundings &around) const;

 private:
  Law law_;  ///< prepared
  bool known_;
};

}  // namespace talus
