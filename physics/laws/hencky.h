#pragma once
#include <algorithm>

#include "physics/laws/drucker_prager.h"
#include "physics/laws/linear_elastic.h"
#include "physics/laws/mohr_coulomb.h"
#include "physics/laws/tensor_functions.h"

namespace talus {

/// A law that is hyperelastic within its yield surface: the Kirchhoff stress is tau = C : 1/2 ln b_e (Hencky), b_e the
/// elastic left Cauchy-Green tensor, which a step carries to dF b_e dF^T; sigma = tau / J. Since the law is isotropic,
/// b_e follows from tau, and history needs J alone. The return map acts on tau, by exponential map the small-strain one
/// (de Souza Neto, Peric & Owen 2008, sec. 14.4). docs/theory/laws/hencky.md says how it differs from the update of
/// (2.5).
template <class Base>
struct Hencky : Base {
  static constexpr auto history = [] {
    std::array<HistoryField, Base::history.size() + 1> fields{};
    std::copy(Base::history.begin(), Base::history.end(), fields.begin());
    fields.back() = {"volume_strain", one, "ln of the volume without gaps over the initial one", true};
    return fields;
  }();
  using History = std::array<double, history.size()>;

  template <int dim, class Number>
  [[gnu::always_inline]] void advance(Stress<dim, Number> &s, const Strain<dim, Number> &e, History &history,
                                      const Surroundings &around) const {
    double &volume_strain = history.back();
    const Number volume = exponential(volume_strain);
    const Number pressure = (s.xx + s.yy + s.zz) * (volume / (9 * this->K)), over_2G = volume * (1 / (2 * this->G));
    const Number third = (s.xx + s.yy + s.zz) * over_2G * (1. / 3);
    // 2 eps_e = ln b_e, of the accepted stress and then of the trial
    const Strain<dim, Number> elastic = affine<dim, Number>(s, 2 * over_2G, 2 * (pressure - third));
    const Strain<dim, Number> b = sandwich<dim, Number>(exponential_of(e), exponential_of(elastic));
    const Strain<dim, Number> trial = logarithm_of(b);
    s = affine<dim, Number>(trial, this->G, (trial.xx + trial.yy + trial.zz) * (this->lambda / 2));
    const Number before = volume_strain + (e.xx + e.yy + e.zz), opened = correct_kirchhoff(s, history, around);
    const Number after = before - opened;
    s = affine<dim, Number>(s, exponential(-after), 0);
    volume_strain = value_of(after);
  }

  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &s, History &history, const Surroundings &around) const {
    const Number volume = exponential(history.back());
    s = affine<dim, Number>(s, volume, 0);
    correct_kirchhoff(s, history, around);
    s = affine<dim, Number>(s, 1 / volume, 0);
  }

 private:
  /// Returns the volumetric strain of gaps that open: what is plastic and no dilation.
  template <int dim, class Number>
  [[gnu::always_inline]] Number correct_kirchhoff(Stress<dim, Number> &s, History &history,
                                                  const Surroundings &around) const {
    typename Base::History of_base;
    for (std::size_t k = 0; k < of_base.size(); ++k) of_base[k] = history[k];
    const Number trial = s.xx + s.yy + s.zz;
    Base::correct(s, of_base, around);
    Number opened = 0;
    if constexpr (of_base.size() > 0) {
      const bool dilates = of_base[1] != history[1];
      opened = dilates ? Number(0) : (trial - (s.xx + s.yy + s.zz)) * (1 / (3 * this->K));
    }
    for (std::size_t k = 0; k < of_base.size(); ++k) history[k] = of_base[k];
    return opened;
  }
};

struct HenckyElastic : Hencky<LinearElastic> {
  static constexpr const char *name = "hencky_elastic";
  static constexpr const char *meaning = "hyperelasticity in logarithmic strain (Hencky)";
};
struct HenckyDruckerPrager : Hencky<DruckerPrager> {
  static constexpr const char *name = "hencky_drucker_prager";
  static constexpr const char *meaning = "drucker_prager with Hencky's hyperelasticity";

  template <class Use>
  void as_case(Use use) const {
    DruckerPrager::as_case([&]<class Case>(const Case &one) { use(Hencky<Case>{one}); });
  }
};
struct HenckyMohrCoulomb : Hencky<MohrCoulomb> {
  static constexpr const char *name = "hencky_mohr_coulomb";
  static constexpr const char *meaning = "mohr_coulomb with Hencky's hyperelasticity";

  template <class Use>
  void as_case(Use use) const {
    MohrCoulomb::as_case([&]<class Case>(const Case &one) { use(Hencky<Case>{one}); });
  }
};

}  // namespace talus
