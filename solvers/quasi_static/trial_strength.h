#pragma once
/// Strength of the Gauss points in the trials of a factor of safety, docs/theory/finite_elements.md (5.1), (5.2).
#include <functional>

#include "solvers/quasi_static/base_contact.h"
#include "solvers/quasi_static/factor_of_safety.h"
#include "solvers/quasi_static/moving_soil.h"
#include "solvers/quasi_static/soil_elements.h"
#include "solvers/quasi_static/structures_in_soil.h"

namespace talus {

/// c [Pa], phi and psi [rad] of soil at a point.
struct FrictionalPoint {
  double c, phi, psi;
};

/// Strength of the soil in a trial: (5.1), for `davis` (5.2), each with the dilation of its flow.
FrictionalPoint strength_of_trial(const FrictionalPoint &own, double factor, TrialFlow flow);

/// Has the law a friction angle above its dilation angle?
bool non_associated(const Law &law);
/// Has soil of this law an energy, and with it a tangent that is symmetric and positive?
bool has_energy(const Law &law);
/// Does it know a tension cut-off, without which no crack opens?
bool may_crack(const Law &law);

/// While it exists the soil has the strength of trials: each point that which its place and its plastic strain left it,
/// divided by the factor of the trial or by a number of its own, and so have the bases. Trials do not soften soil. What
/// suction adds to the cohesion, and tensile strength, are divided alike in all of a body. Of Hoek-Brown's rock the
/// shear strength of each normal stress is divided, and `davis` takes phi at the stress with which trials begin.
template <int dim>
class TrialStrength {
 public:
  /// Takes the present strength as the soil's own. `laws` are those of the bodies; all four must outlive it.
  TrialStrength(SoilElements<dim> &soil, BaseContact<dim> &bases, StructuresInSoil<dim> &structures,
                const std::vector<Law> &laws);
  /// Gives soil and bases their own strength back.
  void restore();

  /// Strength of this body is its own in all trials.
  void keep(size_t body);
  /// Strength is divided by the factor of the trial only where `divided(place, element size)`; elsewhere it is the
  /// soil's own. Returns the share of the soil where it is divided. Collective.
  double confine(const std::function<bool(const Vec<dim> &, double)> &divided);
  /// Lets soil above a line crack: there it bears no tension, and no less than `water`(place), the pressure of the
  /// water in the crack; negative where no crack reaches. Rock bears no tension in all of a body of which a part lies
  /// there. Undone by `restore`. False: no soil that fails lies above the line. Collective.
  bool crack(const std::function<double(const Vec<dim> &)> &water);
  /// Strength of these cells, and of the bases under them, is divided by `divisor` in all trials from now on.
  /// Collective.
  PetscErrorCode hold(const CellSet &cells, double divisor);
  /// The strength of each body's points that `undrained` trials divide, see undrained_strength.h.
  void take_undrained(const std::vector<std::vector<FrictionalPoint>> &strength);
  void set(double factor, TrialFlow flow);

 private:
  void open_cracks(size_t body);

  struct OfBody {
    std::vector<FrictionalPoint> own;        ///< of points; none where the law has no such strength
    std::vector<FrictionalPoint> undrained;  ///< likewise, without flow of the pore water: in `undrained` trials, and
                                             ///< in all of soil that holds its water
    std::vector<double> divisor;             ///< of points; 0: that of the trial
    double psi = 0;                          ///< mean of its points, by volume [rad]
    bool kept = false;                       ///< no trial divides its strength
    bool cracks = false;                     ///< it cracks, and holds the water of its cracks
    std::vector<double> tension;             ///< if it cracks, of points: what the soil below the cracks bears [Pa]
    std::vector<double> history;             ///< without that water
    Law law;                                 ///< with which the points came, and their shares
    std::vector<double> cohesion_share, friction_share;
  };
  SoilElements<dim> &soil_;
  BaseContact<dim> &bases_;
  StructuresInSoil<dim> &structures_;
  const std::vector<Law> &laws_;
  std::vector<OfBody> bodies_;
};

}  // namespace talus
