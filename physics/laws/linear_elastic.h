#pragma once
#include "physics/laws/history.h"
#include "physics/laws/isotropic_elastic.h"

namespace talus {

/// Linear elasticity without a limit of strength.
struct LinearElastic : IsotropicElastic {
  static constexpr const char *name = "linear_elastic";
  static constexpr const char *meaning = "linear elasticity";
  static constexpr std::array<HistoryField, 0> history{};
  using History = std::array<double, history.size()>;

  static constexpr bool never_fails = true;
  static constexpr const char *no_reduction = "is elastic and never fails";

  bool comes_apart() const { return false; }

  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &, History &, const Surroundings &) const {}
};

}  // namespace talus
