#include "solvers/quasi_static/undrained_strength.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "physics/laws/laws.h"
#include "solvers/quasi_static/limit_state.h"

namespace talus {
namespace {

/// s_u where the mean stress of the law's own measure stays what it is [Pa].
template <int dim>
double shear_strength(const MohrCoulomb &, const FrictionalStrength::Faded<double> &own, const Stress<dim> &stress) {
  double mean;  // compression positive
  if constexpr (dim == 2) {
    mean = -(stress.xx + stress.yy) / 2;
  } else {
    const Principal<> s = PrincipalAxes<dim>(stress).values();
    mean = -(s.s1 + s.s3) / 2;
  }
  return std::max(0., own.c * std::cos(own.phi) + mean * std::sin(own.phi));
}
template <int dim>
double shear_strength(const DruckerPrager &law, const FrictionalStrength::Faded<double> &own,
                      const Stress<dim> &stress) {
  const double sin_phi = std::sin(own.phi);
  const double cone = own.c * std::cos(own.phi) - sin_phi * Invariants<dim>(stress).p;
  return std::max(0., law.steepness(sin_phi) * cone / law.steepness(0.));
}

}  // namespace

template <int dim>
std::vector<std::vector<FrictionalPoint>> undrained_strength(const SoilElements<dim> &soil, const PoreFlow<dim> &flow,
                                                             const std::vector<Law> &laws) {
  constexpr int components = stress_size<dim>;
  std::vector<std::vector<FrictionalPoint>> all(laws.size());
  for (size_t b = 0; b < laws.size(); ++b) {
    const GaussPoints<dim> &p = soil.points()[b];
    const auto find = [&](auto law) {
      if constexpr (FrictionalLaw<decltype(law)>) {
        law.prepare();
        const int field = plastic_strain_field(laws[b]), size = history_size(laws[b]);
        for (int q = 0; q < p.count(); ++q) {
          Surroundings around{p.size[q]};
          if (!p.cohesion_share.empty()) around.cohesion = p.cohesion_share[q];
          if (!p.friction_share.empty()) around.friction = p.friction_share[q];
          if (!p.suction.empty()) around.suction = p.suction[q];
          const auto own = law.present(p.history[q * size + field], around);
          const auto &l = soil.rule().point[q - soil.first_point(p.cell[q])];
          const bool drains = !flow.active(p.cell[q]) || flow.saturation(p.cell[q], l) < 1;
          Stress<dim> stress;
          std::copy_n(&p.stress[q * components], components, &stress.xx);
          all[b].push_back(drains ? FrictionalPoint{own.c, own.phi, own.phi}
                                  : FrictionalPoint{shear_strength<dim>(law, own, stress), 0, 0});
        }
      }
    };
    laws[b].visit(find);
  }
  return all;
}

template <int dim>
void put_strength(const std::vector<FrictionalPoint> &strength, GaussPoints<dim> &points) {
  if (!frictional_strength(points.law)) return;
  constexpr double c = 1, phi = FrictionalStrength::right_angle / 2;
  points.law = with_changed_strength(points.law, [](auto &law) {
    law.cohesion = c, law.friction_angle = phi, law.reads_shares = true;
    law.residual_cohesion = law.residual_friction_angle = law.residual_dilation_angle = -1, law.shape_factor = 0;
    if constexpr (std::derived_from<std::decay_t<decltype(law)>, MohrCoulomb>)
      law.tension_cutoff = -1, law.suction_cohesion = law.suction_cohesion_rate = law.suction_friction_rate = 0;
    law.dilation_angle = FrictionalStrength::right_angle;  // that is phi, which it cannot exceed
  });
  points.cohesion_share.clear(), points.friction_share.clear();
  for (const FrictionalPoint &one : strength) {
    points.cohesion_share.push_back(one.c / c);
    points.friction_share.push_back(one.phi / phi);
  }
}

template <int dim>
PetscErrorCode find_undrained_failure(QuasiStatic<dim> &problem, PoreFlow<dim> &flow, const std::vector<Law> &laws,
                                      double load_time, double time, StepOutcome *outcome) {
  PetscFunctionBeginUser;
  const auto before = problem.save();
  const std::vector<double> pressure = std::exchange(flow.pressure, flow.accepted);
  const auto strength = undrained_strength(problem.soil(), flow, laws);
  for (size_t b = 0; b < strength.size(); ++b) put_strength(strength[b], problem.soil().points()[b]);
  LimitState<dim> limit(problem);
  LimitSearch found;
  PetscCall(limit.setup(load_time, time));
  PetscCall(limit.search(&found));
  problem.restore(before);
  flow.pressure = pressure;
  outcome->fails = outcome->undrained = found.verdict == LimitVerdict::mechanism;
  outcome->stopped = found.verdict == LimitVerdict::interrupted;
  outcome->iterations += found.iterations;
  PetscFunctionReturn(0);
}

template std::vector<std::vector<FrictionalPoint>> undrained_strength(const SoilElements<2> &, const PoreFlow<2> &,
                                                                      const std::vector<Law> &);
template std::vector<std::vector<FrictionalPoint>> undrained_strength(const SoilElements<3> &, const PoreFlow<3> &,
                                                                      const std::vector<Law> &);
template void put_strength(const std::vector<FrictionalPoint> &, GaussPoints<2> &);
template void put_strength(const std::vector<FrictionalPoint> &, GaussPoints<3> &);
template PetscErrorCode find_undrained_failure(QuasiStatic<2> &, PoreFlow<2> &, const std::vector<Law> &, double,
                                               double, StepOutcome *);
template PetscErrorCode find_undrained_failure(QuasiStatic<3> &, PoreFlow<3> &, const std::vector<Law> &, double,
                                               double, StepOutcome *);

}  // namespace talus
