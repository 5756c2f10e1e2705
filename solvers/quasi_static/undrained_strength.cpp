#include "solvers/quasi_static/undrained_strength.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "physics/laws/laws.h"
#include "solvers/quasi_static/limit_state.h"

namespace talus {
namespace {

/// Mean stress of Mohr's circle, in the plane or of the largest and the least, positive in compression [Pa].
double mean_of_circle(const Stress<2> &stress) { return -(stress.xx + stress.yy) / 2; }
double mean_of_circle(const Stress<3> &stress) {
  const Principal<> s = PrincipalAxes<3>(stress).values();
  return -(s.s1 + s.s3) / 2;
}
/// s_u where the mean stress of the law's own measure stays what it is [Pa].
template <int dim>
double shear_strength(const MohrCoulomb &, const FrictionalStrength::Faded<double> &own, const Stress<dim> &stress) {
  return std::max(0., own.c * std::cos(own.phi) + mean_of_circle(stress) * std::sin(own.phi));
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
std::vector<FrictionalPoint> undrained_strength(const GaussPoints<dim> &p, const Law &whole,
                                                const std::function<bool(int)> &drains) {
  constexpr int components = stress_size<dim>;
  std::vector<FrictionalPoint> all;
  const int field = plastic_strain_field(whole), size = history_size(whole);
  const auto effective_stress = [&](int q) {
    Stress<dim> stress;
    std::copy_n(&p.stress[q * components], components, &stress.xx);
    const double excess = excess_pressure(whole, &p.history[q * size]);
    stress.xx += excess, stress.yy += excess, stress.zz += excess;
    return stress;
  };
  whole.visit([&](auto law) {
    if constexpr (FrictionalLaw<decltype(law)>) {
      law.prepare();
      for (int q = 0; q < p.count(); ++q) {
        Surroundings around{p.size[q]};
        if (!p.cohesion_share.empty()) around.cohesion = p.cohesion_share[q];
        if (!p.friction_share.empty()) around.friction = p.friction_share[q];
        if (!p.suction.empty()) around.suction = p.suction[q];
        const auto own = law.present(p.history[q * size + field], around);
        all.push_back(drains(q) ? FrictionalPoint{own.c, own.phi, own.phi}
                                : FrictionalPoint{shear_strength<dim>(law, own, effective_stress(q)), 0, 0});
      }
    } else if constexpr (std::same_as<decltype(law), HoekBrown>) {
      law.prepare();
      for (int q = 0; q < p.count(); ++q) {
        const Stress<dim> stress = effective_stress(q);
        const auto [c, phi] = law.line_at(PrincipalAxes<dim>(stress).values().s1);
        all.push_back(drains(q) ? FrictionalPoint{c, phi, phi}
                                : FrictionalPoint{law.radius_at(mean_of_circle(stress)), 0, 0});
      }
    }
  });
  return all;
}

template <int dim>
std::vector<std::vector<FrictionalPoint>> undrained_strength(const SoilElements<dim> &soil, const PoreFlow<dim> &flow,
                                                             const std::vector<Law> &laws) {
  std::vector<std::vector<FrictionalPoint>> all;
  for (size_t b = 0; b < laws.size(); ++b) {
    const GaussPoints<dim> &p = soil.points()[b];
    all.push_back(undrained_strength<dim>(p, laws[b], [&](int q) {
      const auto &l = soil.rule().point[q - soil.first_point(p.cell[q])];
      return !flow.active(p.cell[q]) || flow.saturation(p.cell[q], l) < 1;
    }));
  }
  return all;
}

template <int dim>
void put_strength(const std::vector<FrictionalPoint> &strength, GaussPoints<dim> &points) {
  if (strength.empty()) return;
  const Law &law = points.law;
  if (const HoekBrown *rock = law.as<HoekBrown>()) {
    MohrCoulomb tangents;
    static_cast<IsotropicElastic &>(tangents) = *rock;
    points.law = Law(tangents).drained_as(law);
  }
  constexpr double c = 1, phi = FrictionalStrength::right_angle / 2;
  points.law = with_changed_strength(points.law, [](auto &law) {
    law.cohesion = c, law.friction_angle = phi, law.reads_shares = true;
    law.residual_cohesion = law.residual_friction_angle = law.residual_dilation_angle = law.residual_ratio = -1;
    law.shape_factor = 0;
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

template std::vector<FrictionalPoint> undrained_strength(const GaussPoints<2> &, const Law &,
                                                         const std::function<bool(int)> &);
template std::vector<FrictionalPoint> undrained_strength(const GaussPoints<3> &, const Law &,
                                                         const std::function<bool(int)> &);
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
