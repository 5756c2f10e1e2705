#include "solvers/quasi_static/trial_strength.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/laws/laws.h"
#include "solvers/quasi_static/undrained_strength.h"

namespace talus {
namespace {

/// With the tensile strength and what suction adds to c divided by `factor`, the latter also times what Davis's
/// strength leaves of it; c and phi come from the shares of the points. `psi` is that of the soil's own flow [rad].
Law law_of_trial(const Law &law, double psi, double factor, TrialFlow flow) {
  if (const HoekBrown *own = law.as<HoekBrown>()) {
    HoekBrown one = *own;
    one.reduce_strength(factor);
    one.divisor = own->divisor, one.reads_shares = true;
    if (flow != TrialFlow::own) one.dilation_angle = FrictionalStrength::right_angle;
    return Law(one).drained_as(law);
  }
  return with_changed_strength(with_reduced_strength(law, factor), [&](auto &one) {
    const auto &own = *law.as<std::decay_t<decltype(one)>>();
    if constexpr (std::derived_from<std::decay_t<decltype(one)>, MohrCoulomb>) {
      const FrictionalPoint peak{1, own.friction_angle, own.dilation_angle};
      one.suction_cohesion = own.suction_cohesion * strength_of_trial(peak, factor, flow).c;
    }
    one.cohesion = own.cohesion, one.friction_angle = own.friction_angle, one.reads_shares = true;
    one.dilation_angle = flow == TrialFlow::own ? psi : FrictionalStrength::right_angle;  // but never above phi
    one.residual_cohesion = one.residual_friction_angle = one.residual_dilation_angle = one.residual_ratio = -1;
    one.shape_factor = 0;
  });
}

}  // namespace

bool non_associated(const Law &law) {
  if (law.pore_stiffness() > 0) return false;
  if (const HoekBrown *rock = law.as<HoekBrown>()) return rock->dilation_angle < FrictionalStrength::right_angle;
  const FrictionalStrength *strength = frictional_strength(law);
  return strength && strength->dilation_angle < strength->friction_angle;
}

bool has_energy(const Law &law) {
  return law.visit([](const auto &one) {
    using Own = std::decay_t<decltype(one)>;
    if constexpr (std::same_as<Own, MohrCoulomb> || std::same_as<Own, DruckerPrager>)
      return one.dilation_angle >= one.friction_angle;
    if constexpr (std::same_as<Own, HoekBrown>) return one.dilation_angle >= FrictionalStrength::right_angle;
    return std::same_as<Own, LinearElastic>;
  });
}

FrictionalPoint strength_of_trial(const FrictionalPoint &own, double factor, TrialFlow flow) {
  FrictionalStrength divided;
  divided.cohesion = own.c, divided.friction_angle = own.phi, divided.dilation_angle = own.psi;
  divided.reduce_strength(factor);
  const double phi = divided.friction_angle, psi = divided.dilation_angle;
  if (flow != TrialFlow::davis) return {divided.cohesion, phi, flow == TrialFlow::own ? psi : phi};
  const double beta = std::cos(psi) * std::cos(phi) / (1 - std::sin(psi) * std::sin(phi));
  const double reduced = std::atan(beta * std::tan(phi));
  return {beta * divided.cohesion, reduced, reduced};
}

bool may_crack(const Law &law) {
  return law.visit([](const auto &one) {
    using OneLaw = std::decay_t<decltype(one)>;
    return std::derived_from<OneLaw, MohrCoulomb> || std::same_as<OneLaw, HoekBrown>;
  });
}

/// Of a point whose shear strength is c and phi [Pa]. Where friction hardly limits it, a hundred times the cohesion
/// stands for a tension that no slope reaches. That of rock is so small that none is left to it.
static double tensile_strength(const Law &law, const FrictionalPoint &p) {
  if (law.as<HoekBrown>()) return 0;
  const double apex = std::min(100 * p.c, p.phi > 0 ? p.c / std::tan(p.phi) : std::numeric_limits<double>::infinity());
  return law.visit([&](const auto &one) {
    if constexpr (std::derived_from<std::decay_t<decltype(one)>, MohrCoulomb>)
      if (one.tension_cutoff >= 0) return std::min(apex, one.tension_cutoff);
    return apex;
  });
}

template <int dim>
TrialStrength<dim>::TrialStrength(SoilElements<dim> &soil, BaseContact<dim> &bases, StructuresInSoil<dim> &structures,
                                  const std::vector<Law> &laws)
    : soil_(soil), bases_(bases), structures_(structures), laws_(laws) {
  for (size_t b = 0; b < laws.size(); ++b) {
    const GaussPoints<dim> &p = soil.points()[b];
    OfBody &body = bodies_.emplace_back();
    body.law = p.law, body.cohesion_share = p.cohesion_share, body.friction_share = p.friction_share;
    body.divisor.assign(p.count(), 0);
    if (laws[b].pore_stiffness() > 0) {
      body.undrained = undrained_strength<dim>(p, laws[b], [](int) { return false; });
      continue;
    }
    if (const HoekBrown *rock = laws[b].as<HoekBrown>()) {
      const auto drained = [](int) { return true; };
      body.own = undrained_strength<dim>(p, laws[b], drained);
      for (FrictionalPoint &one : body.own) one.psi = std::min(one.phi, rock->dilation_angle);
    }
    if (!frictional_strength(laws[b])) continue;
    FrictionalStrength strength = *frictional_strength(laws[b]);
    strength.prepare();
    const int field = plastic_strain_field(laws[b]), size = history_size(laws[b]);
    double volume = 0;
    for (int q = 0; q < p.count(); ++q) {
      Surroundings around{p.size[q]};
      if (!p.cohesion_share.empty()) around.cohesion = p.cohesion_share[q];
      if (!p.friction_share.empty()) around.friction = p.friction_share[q];
      const auto now = strength.present(p.history[q * size + field], around);
      body.own.push_back({now.c, now.phi, std::asin(std::min(now.sin_psi, std::sin(now.phi)))});
      volume += p.volume[q], body.psi += p.volume[q] * body.own.back().psi;
    }
    if (volume > 0) body.psi /= volume;
  }
}

template <int dim>
void TrialStrength<dim>::restore() {
  bases_.let_go(), structures_.set_trial(1);
  for (size_t b = 0; b < bodies_.size(); ++b) {
    GaussPoints<dim> &p = soil_.points()[b];
    const OfBody &body = bodies_[b];
    if (body.cracks && !body.law.holds_water()) {  // without the room for the water
      const size_t whole = history_size(p.law), own = whole - 1;
      std::vector<double> history;
      for (size_t k = 0; k < p.history.size(); ++k)
        if (k % whole < own) history.push_back(p.history[k]);
      p.history = p.trial_history = history;
    } else if (body.cracks) {
      const size_t whole = history_size(p.law);
      for (size_t k = whole - 1; k < p.history.size(); k += whole) p.history[k] = body.history[k];
    }
    p.law = bodies_[b].law;
    p.cohesion_share = bodies_[b].cohesion_share, p.friction_share = bodies_[b].friction_share;
  }
}

/// The water of a crack bears a part of the stress at its points: the law sees no tension beyond its pressure. Below
/// the line water in tension bears the soil's own tensile strength, and `set` takes from the cohesion what friction
/// gains by it: the same Mohr-Coulomb soil, with its apex as its cut-off.
template <int dim>
bool TrialStrength<dim>::crack(const std::function<double(const Vec<dim> &)> &water) {
  bool any = false;
  for (size_t b = 0; b < bodies_.size(); ++b) {
    GaussPoints<dim> &p = soil_.points()[b];
    OfBody &body = bodies_[b];
    int reached = 0;
    for (int q = 0; p.present && q < p.count(); ++q) reached = reached || water(p.position[q]) >= 0;
    MPI_Allreduce(MPI_IN_PLACE, &reached, 1, MPI_INT, MPI_MAX, soil_.nodes().comm());
    if (!reached || never_fails(laws_[b])) continue;
    any = body.cracks = true, body.history = p.history;
    const size_t own = history_size(p.law) - (p.law.holds_water() ? 1 : 0), was = history_size(p.law);
    std::vector<double> history;
    for (int q = 0; q < p.count(); ++q) {
      for (size_t k = 0; k < own; ++k) history.push_back(p.history[q * was + k]);
      const double pressure = water(p.position[q]);
      const auto &strength = body.own.empty() ? body.undrained : body.own;
      body.tension.push_back(pressure < 0 ? tensile_strength(laws_[b], strength[q]) : 0);
      history.push_back(pressure < 0 ? -body.tension.back() : pressure);
    }
    p.history = p.trial_history = history;
    p.law = p.law.holding_water(0);
  }
  return any;
}

template <int dim>
void TrialStrength<dim>::open_cracks(size_t b) {
  GaussPoints<dim> &p = soil_.points()[b];
  Law law = with_changed_strength(p.law, [](auto &one) {
    if constexpr (std::derived_from<std::decay_t<decltype(one)>, MohrCoulomb>) one.tension_cutoff = 0;
  });
  if (const HoekBrown *rock = p.law.template as<HoekBrown>()) {
    HoekBrown cracked = *rock;
    cracked.tension_cutoff = 0, law = cracked;
  }
  p.law = law.holding_water(0);
}

template <int dim>
void TrialStrength<dim>::keep(size_t body) {
  bodies_[body].kept = true;
  std::fill(bodies_[body].divisor.begin(), bodies_[body].divisor.end(), 1.);
}

template <int dim>
double TrialStrength<dim>::confine(const std::function<bool(const Vec<dim> &, double)> &divided) {
  bases_.confine(divided);
  double volume[2] = {0, 0};  // where it is divided, and all
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const GaussPoints<dim> &p = soil_.points()[b];
    for (int q = 0; p.present && q < p.count(); ++q) {
      const bool here = !bodies_[b].kept && divided(p.position[q], p.size[q]);
      bodies_[b].divisor[q] = here ? 0 : 1;
      volume[0] += here ? p.volume[q] : 0, volume[1] += p.volume[q];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, volume, 2, MPI_DOUBLE, MPI_SUM, soil_.nodes().comm());
  return volume[0] / volume[1];
}

template <int dim>
PetscErrorCode TrialStrength<dim>::hold(const CellSet &cells, double divisor) {
  PetscFunctionBeginUser;
  PetscCall(bases_.hold(cells, divisor));
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const GaussPoints<dim> &p = soil_.points()[b];
    for (int q = 0; q < p.count(); ++q)
      if (cells[p.cell[q]]) bodies_[b].divisor[q] = divisor;
  }
  PetscFunctionReturn(0);
}

template <int dim>
void TrialStrength<dim>::take_undrained(const std::vector<std::vector<FrictionalPoint>> &strength) {
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (laws_[b].pore_stiffness() == 0) bodies_[b].undrained = strength[b];
}

template <int dim>
void TrialStrength<dim>::set(double factor, TrialFlow flow) {
  bases_.set_trial(factor), structures_.set_trial(factor);
  for (size_t b = 0; b < bodies_.size(); ++b) {
    GaussPoints<dim> &p = soil_.points()[b];
    const OfBody &body = bodies_[b];
    const auto divisor = [&](int q) { return body.divisor[q] > 0 ? body.divisor[q] : factor; };
    if (flow == TrialFlow::undrained || laws_[b].pore_stiffness() > 0) {
      std::vector<FrictionalPoint> divided;
      for (int q = 0; q < static_cast<int>(body.undrained.size()); ++q)
        divided.push_back(strength_of_trial(body.undrained[q], divisor(q), flow));
      put_strength(divided, p);
      if (body.cracks) open_cracks(b);
      continue;
    }
    p.law = law_of_trial(laws_[b], body.psi, body.kept ? 1 : factor, flow);
    if (body.cracks) open_cracks(b);
    if (body.own.empty()) continue;
    const FrictionalStrength *whole = frictional_strength(laws_[b]);  // null: rock, whose share is that of its tangent
    const auto share = [](double part, double of) { return of > 0 ? part / of : 1; };
    p.cohesion_share.resize(p.count()), p.friction_share.resize(p.count());
    for (int q = 0; q < p.count(); ++q) {
      FrictionalPoint now = strength_of_trial(body.own[q], divisor(q), flow);
      if (body.cracks) now.c = std::max(0., now.c - body.tension[q] * std::tan(now.phi));
      p.cohesion_share[q] = share(now.c, whole ? whole->cohesion : body.own[q].c);
      p.friction_share[q] = whole ? share(now.phi, whole->friction_angle) : 1;
    }
  }
}

template class TrialStrength<2>;
template class TrialStrength<3>;

}  // namespace talus
