// Stress at the start of a quasi-static stage from the weight above and the earth pressure at rest.
#include <algorithm>
#include <cmath>

#include "physics/laws/frictional_strength.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/water_source.h"
#include "simulation/overburden.h"
#include "simulation/statics.h"

namespace talus {
namespace {

/// k0 of a body: its own, else Jaky's 1 - sin(phi) of the friction angle, of which the place has a share, else that of
/// elastic soil held at its sides.
double earth_pressure_at_rest(const BodySource &source, const Law &law, double friction_share) {
  if (source.k0 > 0) return source.k0;
  if (const FrictionalStrength *strength = frictional_strength(law))
    return 1 - std::sin(friction_share * strength->friction_angle);
  const double K = bulk_modulus(law), G = shear_modulus(law);
  return (3 * K - 2 * G) / (3 * K + 4 * G);
}

}  // namespace

/// Vertical stress by the weight of soil and open water above, lateral stress k0 times its effective part.
template <int dim>
void Statics<dim>::start_stress() {
  const int vertical = world_.scene.vertical();
  std::vector<typename Overburden<dim>::Block> blocks;
  for (int c = 0; c < world_.mesh.cell_count(); ++c) {
    const int b = problem_->soil().body_of(c);
    if (b < 0 || !world_.present[b]) continue;
    Barycentric<dim> middle;
    middle.fill(1. / (dim + 1));
    const double water = world_.phases.liquid ? flow_->water_density(c, middle) : 0;
    blocks.push_back(world_.block_of(world_.scene.body[b], c, water, clock_.load_time));
  }
  const Overburden<dim> overburden(world_.mesh, blocks, vertical);
  std::function<double(const Vec<dim> &)> open_water;  // where pore water moves
  if (world_.phases.liquid) require(flow_->find_open_water(clock_.load_time, &open_water));
  for (size_t b = 0; b < world_.bodies.size(); ++b) {
    GaussPoints<dim> &points = problem_->soil().points()[b];
    if (!world_.present[b]) continue;
    if (points.law.holds_water()) let_water_go(points);
    for (int q = 0; q < points.count(); ++q) {
      const Vec<dim> &x = points.position[q];
      Vec<dim> surface = x;
      double weight = overburden.above(x, &surface[vertical]), pressure = 0;
      if (world_.phases.prescribed) {
        pressure = world_.pressure(x, clock_.load_time, static_cast<int>(b));
        if (world_.scene.water->open_water_load) weight += world_.pressure(surface, clock_.load_time, common_water);
      }
      if (world_.phases.liquid) {
        weight += open_water(surface);
        pressure = flow_->stress_pressure(points.cell[q],
                                          problem_->soil().rule().point[q % problem_->soil().points_per_cell()]);
      }
      const double k0 = earth_pressure_at_rest(world_.scene.body[b], world_.laws[b],
                                               points.friction_share.empty() ? 1 : points.friction_share[q]);
      double *stress = &points.stress[q * stress_size<dim>];
      std::fill_n(stress, stress_size<dim>, 0.);
      for (int d = 0; d < 3; ++d) stress[d] = (d == vertical ? 1 : k0) * (pressure - weight);
    }
  }
}

template void Statics<2>::start_stress();
template void Statics<3>::start_stress();

}  // namespace talus
