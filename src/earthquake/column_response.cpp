#include "earthquake/column_response.h"

#include "earthquake/oscillator.h"

namespace talus {

GroundMotion layer_response(const GroundMotion &motion, double period, double damping) {
  constexpr int modes = 10;
  constexpr double left = 1e-3;  // of the vibration
  const double fades = -std::log(left) * period / (2 * std::numbers::pi * damping);
  std::vector<double> ground = motion.acceleration;
  ground.resize(ground.size() + static_cast<std::size_t>(std::ceil(fades / motion.step)), 0.);
  GroundMotion mean{motion.step, std::vector<double>(ground.size())};
  double rigid = 1;  // share of the mass that moves with the ground: of the modes that are left out
  for (int n = 0; n < modes; ++n) {
    const double order = 2 * n + 1, share = 8 / std::pow(std::numbers::pi * order, 2);
    Oscillator mode(period / order, damping, motion.step);
    for (std::size_t k = 0; k + 1 < ground.size(); ++k) {
      mode.go_on(ground[k], ground[k + 1]);
      mean.acceleration[k + 1] += share * mode.acceleration();
    }
    rigid -= share;
  }
  for (std::size_t k = 0; k < ground.size(); ++k) mean.acceleration[k] += rigid * ground[k];
  return mean;
}

}  // namespace talus
