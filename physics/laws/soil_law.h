#pragma once
/// What a soil law states of itself. A law is a plain struct. To add one: its file, one word in laws.h, and in
/// tests/unit/laws its examples, its random parameters and what its stress must be. It has the members of `SoilLaw`
/// below, most of which IsotropicElastic and FrictionalStrength bring; a missing one does not compile.
///
/// `trial`, `advance` and `correct` are templates over the number type too: a run with Duals (dual.h) gives the
/// consistent tangent. History takes values only (`value_of`). They run in a loop over points that must vectorise:
/// straight-line code; choices as `?:` between values that are computed before; comparisons not joined by && or &. The
/// exception is a law that is called point by point.
#include <concepts>
#include <span>
#include <type_traits>

#include "physics/laws/dual.h"
#include "physics/laws/frictional_strength.h"
#include "physics/laws/history.h"
#include "physics/laws/stress.h"

namespace talus {

/// The members that a law may have.
namespace member {

/// Stands for a visitor of parameters, and for whoever uses a case of a law.
struct Anyone {
  template <class Any>
  void operator()(const Any &) const {}
};

/// `name`, `meaning`: how scenes call it, and what it is.
template <class OneLaw>
concept name = requires {
  { OneLaw::name } -> std::convertible_to<const char *>;
  { OneLaw::meaning } -> std::convertible_to<const char *>;
};
/// `fields(visitor)`: its parameters, for reader and descriptions. Where something may be wrong between them,
/// `problem()` says what, or "".
template <class OneLaw>
concept fields = requires(OneLaw &law) {
  law.fields(Anyone{});
};
/// `history`: its internal variables at a point, with names, units and meanings.
template <class OneLaw>
concept history = requires(const OneLaw &law) {
  std::span<const HistoryField>(law.history);
};
/// `bulk_modulus()`, `shear_modulus()` [Pa] and `elastic_energy(s)` per volume [J/m3].
template <class OneLaw>
concept elasticity = requires(const OneLaw &law, const Stress<2> &in_plane, const Stress<3> &in_space) {
  { law.bulk_modulus() } -> std::same_as<double>;
  { law.shear_modulus() } -> std::same_as<double>;
  { law.elastic_energy(in_plane) } -> std::same_as<double>;
  { law.elastic_energy(in_space) } -> std::same_as<double>;
};
/// `stiffens`: may its elastic stiffness exceed its moduli? Absent: never.
template <class OneLaw>
concept stiffens = requires {
  requires OneLaw::stiffens;
};
/// `reads_suction()`: does its strength depend on `Surroundings::suction`?
/// `strength_varies()`: does its strength differ from point to point?
/// `comes_apart()`: does it bear no or only so much tension, and open freely beyond?
template <class OneLaw>
concept strength = requires(const OneLaw &law) {
  { law.reads_suction() } -> std::same_as<bool>;
  { law.strength_varies() } -> std::same_as<bool>;
  { law.comes_apart() } -> std::same_as<bool>;
};
/// `rate_dependent`: does its stress depend on the time that a strain takes?
template <class OneLaw>
concept rate_dependent = requires {
  { OneLaw::rate_dependent } -> std::convertible_to<bool>;
};
/// `reduce_strength(factor)`: divides its strength, for factors of safety.
template <class OneLaw>
concept reduce_strength = requires(OneLaw &law) {
  law.reduce_strength(1.);
};
/// `no_reduction`: why it has no such function, to complete "law umat ...".
template <class OneLaw>
concept no_reduction = requires {
  { OneLaw::no_reduction } -> std::convertible_to<const char *>;
};
/// `never_fails`: has it no limit of strength? Absent: it has one.
template <class OneLaw>
concept never_fails = requires {
  requires OneLaw::never_fails;
};

/// `prepare()`: derives constants from the parameters, once per update of all points.
/// `by_place`: does the compiled case read suction and shares of its `Surroundings`?
template <class OneLaw>
concept prepared = requires(OneLaw &law) {
  law.prepare();
  { OneLaw::by_place } -> std::convertible_to<bool>;
};
/// `correct(s, history, around)`: returns the trial stress to the yield surface; does not change admissible stress.
/// `History`: the values of its internal variables.
template <class OneLaw, int dim, class Number>
concept correct = requires(const OneLaw &law, Stress<dim, Number> &s, typename OneLaw::History &h,
                           const Surroundings &around) {
  requires std::tuple_size_v<typename OneLaw::History>
  == OneLaw::history.size();
  law.correct(s, h, around);
};
/// `admits(s, history, around)`: is a trial stress within the yield surface, so that `correct` leaves it and the
/// history as they are? Absent: it is as dear as `correct`.
template <class OneLaw, int dim>
concept admits = requires(const OneLaw &law, const Stress<dim> &s, const typename OneLaw::History &h,
                          const Surroundings &around) {
  { law.admits(s, h, around) } -> std::same_as<bool>;
};
/// `trial(s, e, around)`: adds the elastic stress of a strain increment.
template <class OneLaw, int dim, class Number>
concept trial = requires(const OneLaw &law, Stress<dim, Number> &s, const Strain<dim, Number> &e,
                         const Surroundings &around) {
  law.trial(s, e, around);
};
/// `advance(s, e, history, around)`: in place of `trial` and `correct`, where a law does both in one.
template <class OneLaw, int dim, class Number>
concept advance = requires(const OneLaw &law, Stress<dim, Number> &s, const Strain<dim, Number> &e,
                           typename OneLaw::History &h, const Surroundings &around) {
  law.advance(s, e, h, around);
};
/// `turn<dim>(history, turned)`: turns the tensors among its internal variables by `turned(stress)`. Absent: there are
/// none.
template <class OneLaw, int dim>
concept turn = requires(typename OneLaw::History &h) {
  OneLaw::template turn<dim>(h, [](const Stress<dim> &s) { return s; });
};
/// `as_case(use)`: where the law is compiled in several cases, calls `use` with the one that fits its parameters.
template <class OneLaw>
concept as_case = requires(const OneLaw &law) {
  law.as_case(Anyone{});
};
/// `call(point)`: updates one point of its own type `Point`, in place of all these.
template <class OneLaw>
concept call = requires(const OneLaw &law, const typename OneLaw::Point &point) {
  law.call(point);
};

}  // namespace member

/// Updates the stress of points with this type of number.
template <class OneLaw, int dim, class Number>
concept UpdatesStressOf = member::correct<OneLaw, dim, Number> &&
    (member::trial<OneLaw, dim, Number> || member::advance<OneLaw, dim, Number>);
/// What the loop over points is compiled for: a law, or one of its cases.
template <class OneLaw>
concept UpdatesStress = member::prepared<OneLaw> && UpdatesStressOf<OneLaw, 2, double> &&
    UpdatesStressOf<OneLaw, 3, double> && UpdatesStressOf<OneLaw, 2, Dual<4>> && UpdatesStressOf<OneLaw, 3, Dual<6>>;

/// Has strength that can be divided, or says why it cannot; only such a law may be without any limit of strength.
template <class OneLaw>
concept SaysIfReduced = member::reduce_strength<OneLaw>
!= member::no_reduction<OneLaw> && (member::no_reduction<OneLaw> || !member::never_fails<OneLaw>);

/// A law with cohesion and friction: results show its `present(plastic_strain, around)` strength, and the
/// `share_of_strength(s, plastic_strain, around)` that a stress takes.
template <class OneLaw>
concept FrictionalLaw = std::derived_from<OneLaw, FrictionalStrength> &&
    requires(const OneLaw &law, const Stress<2> &in_plane, const Stress<3> &in_space, const Surroundings &around) {
  { law.present(0., around) } -> std::same_as<FrictionalStrength::Faded<double>>;
  { law.share_of_strength(in_plane, 0., around) } -> std::same_as<double>;
  { law.share_of_strength(in_space, 0., around) } -> std::same_as<double>;
};

template <class OneLaw>
concept SoilLaw = member::name<OneLaw> && member::fields<OneLaw> && member::history<OneLaw> &&
    member::elasticity<OneLaw> && member::strength<OneLaw> && member::rate_dependent<OneLaw> && SaysIfReduced<OneLaw> &&
    (!std::derived_from<OneLaw, FrictionalStrength> ||
     FrictionalLaw<OneLaw>)&&(member::call<OneLaw> || member::as_case<OneLaw> || UpdatesStress<OneLaw>);

}  // namespace talus
