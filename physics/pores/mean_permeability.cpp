#include "physics/pores/mean_permeability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace talus {
namespace {

constexpr double least = 1e-3;              // suction of the table [Pa]
constexpr int octaves = 43, to_a_one = 32;  // up to 9 GPa: soil is dry at 1 GPa

}  // namespace

double liquid_permeability_at(const SoilPores &soil, double pressure) {
  if (pressure >= 0) return 1;
  const double wet = std::visit([&](const auto &one) { return one.effective(-pressure); }, soil.retention());
  return liquid_permeability(soil.relative(), {wet, 1 - wet, -pressure});
}

MeanPermeability::MeanPermeability(const SoilPores &soil) : soil_(soil) {
  // Gauss & Legendre, four points
  constexpr std::array<std::pair<double, double>, 4> rule{{{0.0694318442029737, 0.1739274225687269},
                                                           {0.3300094782075719, 0.3260725774312731},
                                                           {0.6699905217924281, 0.3260725774312731},
                                                           {0.9305681557970263, 0.1739274225687269}}};
  suction_.push_back(0);
  for (int k = 0; k <= octaves * to_a_one; ++k)
    suction_.push_back(least * std::exp2(static_cast<double>(k) / to_a_one));
  const std::size_t count = suction_.size();
  std::vector<double> part(count - 1);
  for (std::size_t k = 0; k < count; ++k) at_.push_back(liquid_permeability_at(soil_, -suction_[k]));
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const double width = suction_[k + 1] - suction_[k];
    for (const auto &[place, weight] : rule)
      part[k] += weight * width * liquid_permeability_at(soil_, -suction_[k] - place * width);
  }
  below_.assign(count, 0), above_ = below_;
  for (std::size_t k = 1; k < count; ++k) below_[k] = below_[k - 1] + part[k - 1];
  for (std::size_t k = count - 1; k-- > 0;) above_[k] = above_[k + 1] + part[k];
}

/// Cubic between the points of the table, whose slope is k_rl at them.
MeanPermeability::Sums MeanPermeability::sums(double suction) const {
  const double inside = std::clamp(suction, 0., suction_.back());
  const double place = inside > least ? 1 + std::log2(inside / least) * to_a_one : 0;
  const std::size_t k = std::min(static_cast<std::size_t>(place), suction_.size() - 2);
  const double width = suction_[k + 1] - suction_[k], r = (inside - suction_[k]) / width;
  const double rise = below_[k + 1] - below_[k], a = at_[k] * width, b = at_[k + 1] * width;
  const double gained = r * (a + r * (3 * rise - 2 * a - b + r * (a + b - 2 * rise)));
  return {below_[k] + gained, above_[k + 1] + (rise - gained)};
}

double MeanPermeability::between(double p, double at_p, double q, double at_q) const {
  constexpr double narrow = 0.05;  // of the larger suction: k_rl is smooth, and differences of sums are not exact
  if (p < q) return between(q, at_q, p, at_p);
  if (q >= 0) return 1;
  if (p - q <= -narrow * q) return (at_p + 4 * liquid_permeability_at(soil_, (p + q) / 2) + at_q) / 6;
  const Sums dry = sums(-q), wet = sums(std::max(0., -p));
  const double sum = dry.below < wet.above ? dry.below - wet.below : wet.above - dry.above;
  return (std::max(0., p) + sum) / (p - q);
}

}  // namespace talus
