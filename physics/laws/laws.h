#pragma once
/// The soil models. A law is a plain struct. To add one: its file, one word in `Law`, and in tests/unit/laws its
/// examples and claims. What a law has:
/// - `name`, `meaning`: how scenes call it, and what it is
/// - `history`, `History`: fields it remembers of a point, and their values
/// - `fields(visitor)`: its parameters, for reader and descriptions; `problem()`: what is wrong between them, or ""
/// - `prepare()`: derives what follows from the parameters alone, once per update of all points
/// - `reads_suction()`: does its strength follow `Surroundings::suction`?
/// - `takes_suction`: the same of the compiled case
/// - `rate_dependent`: does its stress depend on the time that a strain takes?
/// - `as_case(use)`: where the law is compiled in several cases, calls `use` with the one that serves its parameters
/// - `trial(s, e, around)`: adds the elastic stress of a strain increment (IsotropicElastic's, unless the law has its
/// own)
/// - `advance(s, e, history, around)`: in place of trial and correct, where a law does not part them
/// - `correct(s, history, around)`: brings the trial back to what the law admits; leaves admissible stress alone
/// - `bulk_modulus()`, `shear_modulus()`, `elastic_energy(s)`, `cohesionless()`, `strength_varies()`
/// `trial` and `correct` are templates over the number type too: a run with Duals (dual.h) gives the consistent
/// tangent. History takes values only (`value_of`).
///
/// They run in a loop over points that must vectorise: straight-line code; choices as `?:` between
/// values that are already there; comparisons not joined by && or &. The exception is `Umat`, which is called point by
/// point.
#include <span>
#include <string_view>
#include <variant>

#include "physics/laws/bingham.h"
#include "physics/laws/cam_clay.h"
#include "physics/laws/drucker_prager.h"
#include "physics/laws/hencky.h"
#include "physics/laws/linear_elastic.h"
#include "physics/laws/mohr_coulomb.h"
#include "physics/laws/mu_i.h"
#include "physics/laws/newtonian.h"
#include "physics/laws/umat.h"
#include "scene/deferred.h"

namespace talus {

using Law = std::variant<LinearElastic, MohrCoulomb, DruckerPrager, CamClay, MuI, Newtonian, Bingham, HenckyElastic,
                         HenckyMohrCoulomb, HenckyDruckerPrager, Umat>;

/// The law that key "law" of a body names, with its parameters. Throws like the reader.
Law read_law(const DeferredTable &table);

inline const char *law_name(const Law &law) {
  return std::visit([](const auto &one) { return one.name; }, law);
}
/// Names, units and meanings of what the law remembers of a point.
inline std::span<const HistoryField> history_fields(const Law &law) {
  return std::visit([](const auto &one) { return std::span<const HistoryField>(one.history); }, law);
}
inline int history_size(const Law &law) { return static_cast<int>(history_fields(law).size()); }

/// Must the phase model bring suction?
inline bool reads_suction(const Law &law) {
  return std::visit([](const auto &one) { return one.reads_suction(); }, law);
}
/// Does stress depend on the time that a strain takes?
inline bool rate_dependent(const Law &law) {
  return std::visit([](const auto &one) { return one.rate_dependent; }, law);
}
/// Place of the plastic strain that softening reads among the history fields; -1 where there is none.
inline int plastic_strain_field(const Law &law) {
  const auto fields = history_fields(law);
  for (std::size_t h = 0; h < fields.size(); ++h)
    if (std::string_view(fields[h].name) == "plastic_strain") return static_cast<int>(h);
  return -1;
}

inline double bulk_modulus(const Law &law) {  ///< K [Pa]
  return std::visit([](const auto &one) { return one.bulk_modulus(); }, law);
}
inline double shear_modulus(const Law &law) {  ///< G [Pa]
  return std::visit([](const auto &one) { return one.shear_modulus(); }, law);
}
inline double constrained_modulus(const Law &law) {  ///< K + 4/3 G, of the elastic wave [Pa]
  return bulk_modulus(law) + 4 * shear_modulus(law) / 3;
}

/// What is wrong with a law in a dimension that its parameters alone do not show, or "".
inline std::string law_problem(const Law &law, int dim) {
  const Umat *umat = std::get_if<Umat>(&law);
  return umat ? umat->problem_in(dim) : "";
}
/// The first thing that went wrong inside of a law since it was read, if it can go wrong, and the cell of its point.
inline Umat::Trouble law_trouble(const Law &law) {
  const Umat *umat = std::get_if<Umat>(&law);
  return umat ? umat->trouble() : Umat::Trouble{};
}

/// Does soil of this law open without resistance? Then volume that particles gain by opening gaps is not the soil's.
inline bool cohesionless(const Law &law) {
  return std::visit([](const auto &one) { return one.cohesionless(); }, law);
}

/// Does strength differ from point to point? Then averaged stress may lie outside the mean strength.
inline bool strength_varies(const Law &law) {
  return std::visit([](const auto &one) { return one.strength_varies(); }, law);
}

/// Elastic energy per volume [J/m3].
template <int dim>
double elastic_energy(const Law &law, const Stress<dim> &stress) {
  return std::visit([&](const auto &one) { return one.elastic_energy(stress); }, law);
}

}  // namespace talus
