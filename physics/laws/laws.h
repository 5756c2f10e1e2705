#pragma once
/// The soil models. A law is a plain struct. To add one: its file, one word in `Law`, and in tests/unit/laws its
/// examples and claims. What a law has:
/// - `name`, `meaning`: how scenes call it, and what it is
/// - `history`, `History`: its internal variables at a point (names, units, meanings), and their values
/// - `fields(visitor)`: its parameters, for reader and descriptions; `problem()`: what is wrong between them, or ""
/// - `prepare()`: derives constants from the parameters, once per update of all points
/// - `reads_suction()`: does its strength depend on `Surroundings::suction`?
/// - `reads_shares`: do c and phi of a point follow from the shares in its `Surroundings`? Absent: never
/// - `stiffens`: may its elastic stiffness exceed its moduli? Absent: never
/// - `by_place`: does the compiled case read suction and shares of its `Surroundings`?
/// - `rate_dependent`: does its stress depend on the time that a strain takes?
/// - `as_case(use)`: where the law is compiled in several cases, calls `use` with the one that fits its parameters
/// - `trial(s, e, around)`: adds the elastic stress of a strain increment (IsotropicElastic's, unless the law has its
/// own)
/// - `advance(s, e, history, around)`: in place of `trial` and `correct`, where a law does both in one
/// - `correct(s, history, around)`: returns the trial stress to the yield surface; does not change admissible stress
/// - `reduce_strength(factor)`: divides its strength, for factors of safety; a law that cannot has `no_reduction`, the
/// reason that completes "law umat ...", and a law without any limit of strength also has `never_fails`
/// - `bulk_modulus()`, `shear_modulus()`, `elastic_energy(s)`, `comes_apart()`, `strength_varies()`
/// `trial` and `correct` are templates over the number type too: a run with Duals (dual.h) gives the consistent
/// tangent. History takes values only (`value_of`).
///
/// They run in a loop over points that must vectorise: straight-line code; choices as `?:` between values that are
/// computed before; comparisons not joined by && or &. The exception is `Umat`, which is called point by
/// point.
#include <cstring>
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
/// Names, units and meanings of the internal variables of the law at a point.
inline std::span<const HistoryField> history_fields(const Law &law) {
  return std::visit([](const auto &one) { return std::span<const HistoryField>(one.history); }, law);
}
inline int history_size(const Law &law) { return static_cast<int>(history_fields(law).size()); }

/// Does the law need a phase model with suction?
inline bool reads_suction(const Law &law) {
  return std::visit([](const auto &one) { return one.reads_suction(); }, law);
}
/// Does stress depend on the time that a strain takes?
inline bool rate_dependent(const Law &law) {
  return std::visit([](const auto &one) { return one.rate_dependent; }, law);
}
/// Index of a history field; -1 where the law has none of this name.
inline int history_field(const Law &law, std::string_view name) {
  const auto fields = history_fields(law);
  for (std::size_t h = 0; h < fields.size(); ++h)
    if (fields[h].name == name) return static_cast<int>(h);
  return -1;
}
/// Index among the history fields of the plastic strain that softening reads; -1 where there is none.
inline int plastic_strain_field(const Law &law) { return history_field(law, field_of_plastic_strain.name); }

inline double bulk_modulus(const Law &law) {  ///< K [Pa]
  return std::visit([](const auto &one) { return one.bulk_modulus(); }, law);
}
inline double shear_modulus(const Law &law) {  ///< G [Pa]
  return std::visit([](const auto &one) { return one.shear_modulus(); }, law);
}
inline double poisson_ratio(const Law &law) {  ///< nu [-]
  const double K = bulk_modulus(law), G = shear_modulus(law);
  return (3 * K - 2 * G) / (2 * (3 * K + G));
}
inline double constrained_modulus(const Law &law) {  ///< K + 4/3 G, of the elastic wave [Pa]
  return bulk_modulus(law) + 4 * shear_modulus(law) / 3;
}

/// What is wrong with a law in a dimension, beyond what its parameters alone show, or "".
inline std::string law_problem(const Law &law, int dim) {
  const Umat *umat = std::get_if<Umat>(&law);
  return umat ? umat->problem_in(dim) : "";
}
/// The first thing that went wrong inside of a law since it was read, if it can go wrong, and the cell of its point.
inline Umat::Trouble law_trouble(const Law &law) {
  const Umat *umat = std::get_if<Umat>(&law);
  return umat ? umat->trouble() : Umat::Trouble{};
}

/// Does soil of this law bear no or only so much tension, and open freely beyond? Then the volume that its particles
/// gain by opening is that of gaps.
inline bool comes_apart(const Law &law) {
  return std::visit([](const auto &one) { return one.comes_apart(); }, law);
}

/// Does strength differ from point to point? Then averaged stress may lie outside the yield surface of the mean
/// history.
inline bool strength_varies(const Law &law) {
  return std::visit([](const auto &one) { return one.strength_varies(); }, law);
}

/// Do c and phi of a point follow from the shares in its surroundings?
inline bool reads_shares(const Law &law) {
  return std::visit(
      [](const auto &one) {
        if constexpr (requires { one.reads_shares; })
          return one.reads_shares;
        else
          return false;
      },
      law);
}

/// May the soil become stiffer than its moduli say?
inline bool stiffens(const Law &law) {
  return std::visit(
      [](const auto &one) {
        return requires { one.stiffens; };
      },
      law);
}

/// Why a factor of safety cannot reduce the strength of this law, as the end of a sentence that begins with its name;
/// "" where it can.
inline const char *no_strength_reduction(const Law &law) {
  return std::visit(
      [](const auto &one) {
        if constexpr (requires { one.no_reduction; })
          return one.no_reduction;
        else
          return "";
      },
      law);
}
/// Has the law no limit of strength? Its soil may stand beside soil whose strength is reduced.
inline bool never_fails(const Law &law) {
  return std::visit(
      [](const auto &one) {
        return requires { one.never_fails; };
      },
      law);
}
/// The law with its strength divided by `factor`; a law without strength to reduce as it is.
inline Law with_reduced_strength(const Law &law, double factor) {
  return std::visit(
      [factor](auto one) -> Law {
        static_assert(
            requires { one.reduce_strength(factor); } != requires { one.no_reduction; },
            "a law has reduce_strength(factor) or the reason no_reduction");
        if constexpr (requires { one.reduce_strength(factor); }) one.reduce_strength(factor);
        return one;
      },
      law);
}

/// Elastic energy per volume [J/m3].
template <int dim>
double elastic_energy(const Law &law, const Stress<dim> &stress) {
  return std::visit([&](const auto &one) { return one.elastic_energy(stress); }, law);
}
/// The same of a stress as stored, [stress_size] [Pa].
template <int dim>
double stored_energy(const Law &law, const double *stress) {
  Stress<dim> s;
  static_assert(sizeof s == stress_size<dim> * sizeof(double));
  std::memcpy(&s, stress, sizeof s);
  return elastic_energy<dim>(law, s);
}

}  // namespace talus
