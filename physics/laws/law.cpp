#include "physics/laws/law.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "physics/laws/drainage.h"
#include "physics/laws/laws.h"
#include "scene/reader.h"

namespace talus {

Law::Law() : Law(LinearElastic{}) {}

Law::Law(std::shared_ptr<const Kind> kind) : kind_(std::move(kind)) {}
bool Law::holds_water() const { return kind_->holds_water; }
double Law::pore_stiffness() const { return kind_->pore_stiffness; }
Law Law::holding_water(double pore_stiffness) const {
  return Law(std::make_shared<const Kind>(Kind{kind_->law, true, pore_stiffness}));
}
Law Law::drained_as(const Law &other) const {
  return other.holds_water() || holds_water()
             ? Law(std::make_shared<const Kind>(Kind{kind_->law, other.holds_water(), other.pore_stiffness()}))
             : *this;
}

namespace {

/// The internal variables of a law, and the excess pressure behind them.
template <class OneLaw>
constexpr auto history_with_water = [] {
  std::array<HistoryField, OneLaw::history.size() + 1> fields{};
  std::copy(OneLaw::history.begin(), OneLaw::history.end(), fields.begin());
  fields.back() = field_of_excess_pressure;
  return fields;
}();

}  // namespace

namespace {

/// Keys of a law and of the drainage beside it, which are those of one table.
template <class OneLaw>
struct LawKeys {
  OneLaw &law;
  Drainage &drainage;
  template <class Visitor>
  void fields(Visitor &&v) {
    drainage.fields(v), law.fields(v);
  }
  std::string problem() const {
    const std::string of_drainage = drainage.shansep.given() ? drainage.shansep.problem() : "";
    if (!of_drainage.empty()) return of_drainage;
    if constexpr (requires { law.problem(); })
      return law.problem();
    else
      return "";
  }
};

/// K_w / n by Skempton's B = (K_w / n) / (K + K_w / n), or as the difference of K_u = 2 G (1 + nu_u) / (3 (1 - 2 nu_u))
/// and K [Pa].
double pore_stiffness_of(const Law &law, const Drainage &drainage) {
  const double K = bulk_modulus(law), B = drainage.skempton_b, nu_u = drainage.undrained_poisson_ratio;
  return B > 0 ? K * B / (1 - B) : 2 * shear_modulus(law) * (1 + nu_u) / (3 * (1 - 2 * nu_u)) - K;
}

/// Both, of a table that is left as it was.
std::pair<Law, Drainage> read(const DeferredTable &table) {
  Laws kinds = make_kind<Laws>(0);
  Drainage drainage;
  if (!table.reader) return {std::visit([](auto &one) { return Law(one); }, kinds), drainage};
  TableReader reader = *table.reader;
  kinds = make_kind<Laws>(reader.kind("law", kinds_of<Laws>()));
  std::visit(
      [&](auto &one) {
        LawKeys<std::decay_t<decltype(one)>> keys{one, drainage};
        reader.fill(keys);
      },
      kinds);
  Law law = std::visit([](auto &one) { return Law(one); }, kinds);
  if (drainage.undrained()) {
    const double stiffness = pore_stiffness_of(law, drainage);
    if (stiffness <= 0)
      reader.refuse("undrained_poisson_ratio must be above poisson_ratio, " + shortest(poisson_ratio(law)) +
                    ": water makes the soil stiffer");
    law = law.holding_water(stiffness);
  }
  if (drainage.shansep.given()) {
    const FrictionalStrength *strength = frictional_strength(law);
    if (!strength)
      reader.refuse(
          "law must have a cohesion and a friction_angle beside shansep, which takes their place: take "
          "mohr_coulomb or drucker_prager");
    if (!(strength->cohesion > 0))  // a function of place is none yet
      reader.refuse(
          "cohesion must be a number above 0 beside shansep, whose strength is kept as a share of it; take "
          "\"0.1 kPa\" where the soil has none");
    law = with_changed_strength(law, [](FrictionalStrength &one) { one.reads_shares = one.consolidates = true; });
  }
  return {law, drainage};
}

}  // namespace

std::string Shansep::problem() const {
  if (stage.empty()) return "shansep must have a stage, the name of that whose stress gives the strength";
  if (ratio == 0) return "shansep must have a ratio above 0, s_u / sigma'_v of normally consolidated soil";
  if (overconsolidation_ratio.given() && preconsolidation_stress.given())
    return "shansep must have overconsolidation_ratio or preconsolidation_stress, not both";
  return "";
}

Law read_law(const DeferredTable &table) { return read(table).first; }
Drainage read_drainage(const DeferredTable &body) { return read(body).second; }

const char *law_name(const Law &law) {
  return law.visit([](const auto &one) { return one.name; });
}
std::span<const HistoryField> history_fields(const Law &law) {
  return law.visit([&law](const auto &one) -> std::span<const HistoryField> {
    if constexpr (!std::same_as<std::decay_t<decltype(one)>, Umat>)
      if (law.holds_water()) return history_with_water<std::decay_t<decltype(one)>>;
    return one.history;
  });
}
int history_size(const Law &law) { return static_cast<int>(history_fields(law).size()); }
int history_field(const Law &law, std::string_view name) {
  const auto fields = history_fields(law);
  for (std::size_t h = 0; h < fields.size(); ++h)
    if (fields[h].name == name) return static_cast<int>(h);
  return -1;
}
int plastic_strain_field(const Law &law) { return history_field(law, field_of_plastic_strain.name); }

double bulk_modulus(const Law &law) {
  return law.visit([](const auto &one) { return one.bulk_modulus(); }) + law.pore_stiffness();
}
double shear_modulus(const Law &law) {
  return law.visit([](const auto &one) { return one.shear_modulus(); });
}
double poisson_ratio(const Law &law) {
  const double K = bulk_modulus(law), G = shear_modulus(law);
  return (3 * K - 2 * G) / (2 * (3 * K + G));
}
double constrained_modulus(const Law &law) { return bulk_modulus(law) + 4 * shear_modulus(law) / 3; }

double excess_pressure(const Law &law, const double *history) {
  return law.holds_water() ? history[history_size(law) - 1] : 0;
}

double make_effective(const Law &law, double *stress, const double *history) {
  const double excess = excess_pressure(law, history);
  for (int k = 0; k < 3; ++k) stress[k] += excess;
  return excess;
}

bool reads_suction(const Law &law) {
  return law.visit([](const auto &one) { return one.reads_suction(); });
}
bool rate_dependent(const Law &law) {
  return law.visit([](const auto &one) { return one.rate_dependent; });
}
bool comes_apart(const Law &law) {
  return law.visit([](const auto &one) { return one.comes_apart(); });
}
bool strength_varies(const Law &law) {
  return law.visit([](const auto &one) { return one.strength_varies(); });
}
bool reads_shares(const Law &law) {
  const FrictionalStrength *strength = frictional_strength(law);
  return strength && strength->reads_shares;
}
bool consolidates(const Law &law) {
  const FrictionalStrength *strength = frictional_strength(law);
  return strength && strength->consolidates;
}
bool stiffens(const Law &law) {
  return law.visit([](const auto &one) { return member::stiffens<std::decay_t<decltype(one)>>; });
}

const FrictionalStrength *frictional_strength(const Law &law) {
  return law.visit([](const auto &one) -> const FrictionalStrength * {
    if constexpr (FrictionalLaw<std::decay_t<decltype(one)>>)
      return &one;
    else
      return nullptr;
  });
}
bool softens(const Law &law) {
  const FrictionalStrength *strength = frictional_strength(law);
  return strength && strength->softens();
}
Law without_softening(const Law &law) {
  return with_changed_strength(law, [](FrictionalStrength &strength) { strength.shape_factor = 0; });
}
const char *no_strength_reduction(const Law &law) {
  return law.visit([](const auto &one) {
    if constexpr (member::no_reduction<std::decay_t<decltype(one)>>)
      return one.no_reduction;
    else
      return "";
  });
}
bool never_fails(const Law &law) {
  return law.visit([](const auto &one) { return member::never_fails<std::decay_t<decltype(one)>>; });
}
Law with_reduced_strength(const Law &law, double factor) {
  return law
      .visit([factor](auto one) -> Law {
        if constexpr (member::reduce_strength<decltype(one)>) one.reduce_strength(factor);
        return one;
      })
      .drained_as(law);
}

std::string law_problem(const Law &law, int dim) {
  const Umat *umat = law.as<Umat>();
  if (umat && law.holds_water()) return "drainage = \"undrained\" is not for law umat, whose history is the user's";
  return umat ? umat->problem_in(dim) : "";
}
LawTrouble law_trouble(const Law &law) {
  const Umat *umat = law.as<Umat>();
  return umat ? umat->trouble() : LawTrouble{};
}

template <int dim>
double elastic_energy(const Law &law, const Stress<dim> &stress) {
  if (const double water = law.pore_stiffness(); water > 0) {
    const double K = bulk_modulus(law) - water, p = (stress.xx + stress.yy + stress.zz) / 3;
    const double less = p - p * std::sqrt(K / (K + water));  // the soil alone stores as much under the rest
    Stress<dim> of_soil = stress;
    of_soil.xx -= less, of_soil.yy -= less, of_soil.zz -= less;
    return law.visit([&](const auto &one) { return one.elastic_energy(of_soil); });
  }
  return law.visit([&](const auto &one) { return one.elastic_energy(stress); });
}
template <int dim>
double stored_energy(const Law &law, const double *stress) {
  Stress<dim> s;
  static_assert(sizeof s == stress_size<dim> * sizeof(double));
  std::memcpy(&s, stress, sizeof s);
  return elastic_energy<dim>(law, s);
}
template double elastic_energy(const Law &, const Stress<2> &);
template double elastic_energy(const Law &, const Stress<3> &);
template double stored_energy<2>(const Law &, const double *);
template double stored_energy<3>(const Law &, const double *);

}  // namespace talus
