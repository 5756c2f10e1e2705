#pragma once
/// Explicit steps beyond the critical one create energy: what has been dissipated falls.
#include <algorithm>
#include <string>

#include "base/archive.h"
#include "base/rounded.h"

namespace talus {

class EnergyWatch {
 public:
  /// Takes the energy that has been dissipated, and all that was there or was brought, in the order of time [J].
  /// Returns a sentence when energy is created for the first time. Sound runs lose at most 1 % of what they dissipated
  /// again; such as are beyond their critical step begin with some per cent and multiply them within a few hundred
  /// steps.
  std::string look(double dissipated, double turnover) {
    most_ = std::max(most_, dissipated), turnover_ = std::max({turnover_, turnover, dissipated});
    created_ = std::max(created_, most_ - dissipated);
    if (told_ || !(created_ > visible * turnover_)) return "";
    told_ = true;
    return verdict() + ". What follows is not to be trusted";
  }
  /// Where soil gets stress or places from elsewhere than its motion: energy may begin anew.
  void restart(double dissipated) { most_ = dissipated; }
  /// Has more energy been created than there was?
  bool beyond_all() const { return told_ && !(created_ <= turnover_); }
  std::string verdict() const {
    return "energy is created: " + rounded(created_) + " J, of " + rounded(turnover_) +
           " J that were there or were brought (dissipated_J in history.csv falls). The steps are longer than this "
           "soil bears: take a smaller integrator.fraction. Soil that has grown much by dilation (volume, dilation of "
           "its particles) needs a residual_dilation_angle";
  }
  void serialize(Archive &archive) { archive.serialize("energy watch", most_, turnover_, created_, told_); }

 private:
  static constexpr double visible = 0.05;
  double most_ = 0, turnover_ = 0, created_ = 0;  ///< [J]
  bool told_ = false;
};

}  // namespace talus
