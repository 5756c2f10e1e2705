// Undrained strength from the stress under which soil has consolidated (SHANSEP).
#include <algorithm>
#include <cmath>

#include "base/rounded.h"
#include "physics/laws/drainage.h"
#include "physics/laws/frictional_strength.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "simulation/statics.h"

namespace talus {

/// The shares of a law's c and phi carry it: s_u over c, and no phi.
template <int dim>
std::string Statics<dim>::take_consolidated_strength(const std::string &stage) {
  std::string said;
  const int vertical = world_.scene.vertical();
  for (size_t b = 0; b < world_.bodies.size(); ++b) {
    if (!consolidates(world_.laws[b])) continue;
    const Shansep shansep = read_drainage(world_.scene.body[b].law).shansep;
    if (!std::ranges::count(shansep.stage, stage)) continue;
    GaussPoints<dim> &p = problem_->soil().points()[b];
    const double c = frictional_strength(p.law)->cohesion;
    const int memory = history_size(p.law);
    p.cohesion_share.resize(p.count(), 1), p.friction_share.resize(p.count(), 1);
    double range[2] = {-1e300, -1e300};  // minus the least, and the largest
    for (int q = 0; p.present && q < p.count(); ++q) {
      const Vec<dim> &x = p.position[q];
      const auto at = [&](const Function &of) { return of(x[0], x[1], dim == 3 ? x[dim - 1] : 0, 0); };
      const double borne = -p.stress[q * stress_size<dim> + vertical] -
                           excess_pressure(p.law, p.history.data() + static_cast<size_t>(q) * memory);
      const double stress = std::max(0., borne);
      double ratio = shansep.overconsolidation_ratio.given() ? at(shansep.overconsolidation_ratio) : 1;
      if (shansep.preconsolidation_stress.given() && stress > 0)
        ratio = std::max(1., at(shansep.preconsolidation_stress) / stress);
      const double strength = std::max(shansep.minimum, shansep.ratio * stress * std::pow(ratio, shansep.exponent));
      p.cohesion_share[q] = strength / c, p.friction_share[q] = 0;
      range[0] = std::max(range[0], -strength), range[1] = std::max(range[1], strength);
    }
    MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_DOUBLE, MPI_MAX, world_.comm);
    shares_to_particles(b);
    said += (said.empty() ? "" : "; ") + std::string("body.") + world_.scene.body[b].name +
            " has consolidated to an undrained strength of " + rounded(-range[0] / 1e3) + " to " +
            rounded(range[1] / 1e3) + " kPa";
  }
  return said;
}

template <int dim>
StrengthShares Statics<dim>::shares_at(int cell, const Barycentric<dim> &l) const {
  const SoilElements<dim> &soil = problem_->soil();
  const GaussPoints<dim> &p = soil.points()[soil.body_of(cell)];
  const auto weight = weights_of_points(l, true);
  StrengthShares found{0, 0};
  for (int a = 0; a < soil.points_per_cell(); ++a) {
    const int q = soil.first_point(cell) + a;
    found.cohesion += weight[a] * p.cohesion_share[q], found.friction += weight[a] * p.friction_share[q];
  }
  return found;
}

template <int dim>
void Statics<dim>::shares_to_particles(size_t body) {
  ParticleArrays<dim> &p = world_.bodies[body]->particles();
  for (int i = 0; i < p.count; ++i) {
    const auto shares = shares_at(p.cell[i], barycentric(world_.mesh.cells[p.cell[i]], p.position[i]));
    p.cohesion_share[i] = shares.cohesion, p.friction_share[i] = shares.friction;
  }
}

template std::string Statics<2>::take_consolidated_strength(const std::string &);
template std::string Statics<3>::take_consolidated_strength(const std::string &);
template StrengthShares Statics<2>::shares_at(int, const Barycentric<2> &) const;
template StrengthShares Statics<3>::shares_at(int, const Barycentric<3> &) const;
template void Statics<2>::shares_to_particles(size_t);
template void Statics<3>::shares_to_particles(size_t);

}  // namespace talus
