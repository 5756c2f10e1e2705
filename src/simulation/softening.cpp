#include "simulation/softening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "physics/laws/frictional_strength.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "simulation/failure.h"

namespace talus {
namespace {

/// The least height along gravity, times |gravity|, at which soil ends, over all bodies: top and bottom [m2/s2].
std::array<double, 2> heads(const Scene &scene, const std::vector<BodyReport> &bodies) {
  std::array<double, 2> ends{0, 0};
  for (int d = 0; d < static_cast<int>(scene.gravity.size()); ++d) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const BodyReport &b : bodies)
      if (b.particles > 0) low = std::min(low, b.low[d]), high = std::max(high, b.high[d]);
    const double g = scene.gravity[d];
    ends[0] += std::max(-g * low, -g * high), ends[1] += std::min(-g * low, -g * high);
  }
  return ends;
}

/// Slope of strength over plastic strain at its steepest, over 2 G, in a band of width `size` [m] at a mean stress
/// [Pa].
double slope_of(const Law &law, double size, double pressure) {
  if (!softens(law)) return 0;
  FrictionalStrength one = *frictional_strength(law);
  one.prepare();
  const double scale = one.reference_size > 0 ? size / one.reference_size : 1;
  const double drop = one.cohesion * std::cos(one.friction_angle) - one.residual_c * std::cos(one.residual_phi) +
                      pressure * (std::sin(one.friction_angle) - std::sin(one.residual_phi));
  return one.shape_factor * scale * drop / (2 * shear_modulus(law));
}

}  // namespace

double critical_slip_length(double slope, double poisson_ratio, double size) {
  constexpr double universal = 1.158;  // Uenishi & Rice (2003), eq. (13): of an elastic plane
  return universal * std::sqrt(3.) * size / (2 * (1 - poisson_ratio) * slope);
}

std::vector<Softening> softening_of(const Scene &scene, const std::vector<Law> &laws,
                                    const std::vector<BodyReport> &bodies) {
  std::vector<Softening> all(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyReport &body = bodies[b];
    if (body.particles == 0) continue;  // a later stage adds it
    double middle = 0;
    for (std::size_t d = 0; d < scene.gravity.size(); ++d)
      middle -= scene.gravity[d] * (body.low[d] + body.high[d]) / 2;
    const double pressure = body.mass / body.volume * (heads(scene, bodies)[0] - middle);
    const double length = scene.body[b].averaging_length, size = length > 0 ? 2 * length : body.cell_size;
    all[b].slope = slope_of(laws[b], size, pressure);
    if (all[b].slope > 0) all[b].critical_length = critical_slip_length(all[b].slope, poisson_ratio(laws[b]), size);
  }
  return all;
}

std::vector<std::string> brittle_soils(const Scene &scene, const std::vector<Law> &laws,
                                       const std::vector<BodyReport> &bodies) {
  std::vector<std::string> sentences;
  const std::vector<Softening> softening = softening_of(scene, laws, bodies);
  double gravity = 0;
  for (const double component : scene.gravity) gravity += component * component;
  if (gravity == 0) return sentences;
  const auto [top, bottom] = heads(scene, bodies);
  const double height = (top - bottom) / std::sqrt(gravity);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double length = softening[b].critical_length;
    if (length == 0 || length >= 1.5 * height) continue;
    const double nu = poisson_ratio(laws[b]);
    sentences.push_back(
        "Softening of " + bodies[b].name + " is brittle: a slip surface of about " + rounded(length) +
        " m spreads without more load, and the soil is " + rounded(height) +
        " m high. The slope then falls from one place inside it, at a load that depends on the cells and "
        "on the initial stress (elastic soil presses sideways with nu / (1 - nu) = " +
        rounded(nu / (1 - nu)) +
        "). `talus converge` shows by how much; a smaller shape_factor or a larger reference_size makes "
        "the surface longer");
  }
  return sentences;
}

}  // namespace talus
