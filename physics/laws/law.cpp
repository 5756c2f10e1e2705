#include "physics/laws/law.h"

#include <cstring>

#include "physics/laws/laws.h"
#include "scene/reader.h"

namespace talus {

Law::Law() : Law(LinearElastic{}) {}

Law read_law(const DeferredTable &table) {
  Laws law;
  read_one_of(table, "law", law);
  return law;
}

const char *law_name(const Law &law) {
  return law.visit([](const auto &one) { return one.name; });
}
std::span<const HistoryField> history_fields(const Law &law) {
  return law.visit([](const auto &one) { return std::span<const HistoryField>(one.history); });
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
  return law.visit([](const auto &one) { return one.bulk_modulus(); });
}
double shear_modulus(const Law &law) {
  return law.visit([](const auto &one) { return one.shear_modulus(); });
}
double poisson_ratio(const Law &law) {
  const double K = bulk_modulus(law), G = shear_modulus(law);
  return (3 * K - 2 * G) / (2 * (3 * K + G));
}
double constrained_modulus(const Law &law) { return bulk_modulus(law) + 4 * shear_modulus(law) / 3; }

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
  return law.visit([factor](auto one) -> Law {
    if constexpr (member::reduce_strength<decltype(one)>) one.reduce_strength(factor);
    return one;
  });
}

std::string law_problem(const Law &law, int dim) {
  const Umat *umat = law.as<Umat>();
  return umat ? umat->problem_in(dim) : "";
}
LawTrouble law_trouble(const Law &law) {
  const Umat *umat = law.as<Umat>();
  return umat ? umat->trouble() : LawTrouble{};
}

template <int dim>
double elastic_energy(const Law &law, const Stress<dim> &stress) {
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
