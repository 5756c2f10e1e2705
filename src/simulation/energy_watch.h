#pragma once
/// Explicit steps beyond the critical one create energy: what has been dissipated falls.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "base/archive.h"
#include "base/rounded.h"

namespace talus {

class EnergyWatch {
 public:
  /// Looks anew, after soil has got stress or places from elsewhere than its motion.
  void begin() { begins_ = true; }
  /// Takes the energy that has been dissipated, and all that was there or was brought, in the order of time [J]. The
  /// sums lack the energy of pore fluids: where these move, `in_motion` is the kinetic energy that soil has, or that it
  /// left with, and no more than that counts as created.
  /// Returns a sentence when energy is created for the first time. Sound runs lose at most 1 % of what they dissipated
  /// again, and with pore fluids 15 % of what was brought; such as are beyond their critical step begin with some per
  /// cent and multiply them within a few hundred steps.
  std::string look(double dissipated, double turnover, std::optional<double> in_motion = {}) {
    if (std::exchange(begins_, false)) most_ = dissipated;
    whole_ = !in_motion;
    most_ = std::max(most_, dissipated), turnover_ = std::max({turnover_, turnover, dissipated});
    created_ = std::max(created_, std::min(most_ - dissipated, in_motion.value_or(most_ - dissipated)));
    if (!std::isfinite(dissipated)) created_ = std::numeric_limits<double>::infinity();
    if (told_ || !(created_ > (whole_ ? 0.05 : 0.5) * turnover_)) return "";
    told_ = true;
    return verdict() + ". What follows is not to be trusted";
  }
  bool told() const { return told_; }
  /// Has more energy been created than there was?
  bool beyond_all() const { return told_ && !(created_ <= turnover_); }
  std::string verdict() const {
    return "energy is created: " + rounded(created_) + " J, of " + rounded(turnover_) +
           " J that were there or were brought (dissipated_J in history.csv falls" +
           (whole_ ? ")" : "; it lacks the energy of pore fluids, which is no reason for so much)") +
           ". Where a smaller integrator.fraction (which --resume takes) "
           "creates less, the steps were longer than this soil bears: soil that has grown by dilation, or by gaps" +
           (whole_ ? " without a volume_cap" : "") +
           ", waits for shorter ones. Otherwise look at volume and dilation of its particles; "
           "dilation needs an end (residual_dilation_angle)" +
           (whole_ ? "" : ", and pores of particles whose soil has come apart grow with the gaps");
  }
  void serialize(Archive &archive) { archive.serialize("energy watch", begins_, most_, turnover_, created_, told_); }

 private:
  bool begins_ = true;
  double most_ = 0, turnover_ = 0, created_ = 0;  ///< [J]
  bool told_ = false, whole_ = true;
};

}  // namespace talus
