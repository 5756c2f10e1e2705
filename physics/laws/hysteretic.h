#pragma once
#include <algorithm>
#include <string>

#include "physics/laws/backbone.h"
#include "physics/laws/mohr_coulomb.h"

namespace talus {

/// A law whose shear stiffness within its yield surface is that of small strain and falls with strain along a backbone;
/// cycles take energy by Masing's rules. In parallel lie elements of von Mises' kind, elastic and perfectly plastic
/// (Iwan 1967, J. Appl. Mech. 34), each with its share of the stiffness and a deviator of its own. Their increments
/// move the stress of the point, which the base law then returns to its surface; what that takes away is none of
/// theirs. docs/theory/laws/hysteretic.md.
template <class Base>
struct Hysteretic : Base, Backbone {
  static constexpr int components = 5;  ///< stored of a deviator: xx, yy, xy, yz, xz
  static constexpr int first_tensor = static_cast<int>(Base::history.size());
  struct Name {
    char text[16];
  };
  static constexpr auto names = [] {
    constexpr const char *axes[components] = {"xx", "yy", "xy", "yz", "xz"};
    std::array<Name, sliders * components> all{};
    for (int k = 0; k < sliders * components; ++k) {
      const int number = k / components + 1;
      const char text[] = {
          's', 'l', 'i', 'd', 'e', 'r', '_', static_cast<char>('0' + number / 10), static_cast<char>('0' + number % 10),
          '_'};
      std::copy_n(text, sizeof text, all[k].text);
      std::copy_n(axes[k % components], 2, all[k].text + sizeof text);
    }
    return all;
  }();
  static constexpr auto history = [] {
    std::array<HistoryField, first_tensor + sliders * components> fields{};
    std::copy(Base::history.begin(), Base::history.end(), fields.begin());
    for (int k = 0; k < sliders * components; ++k)
      fields[first_tensor + k] = {names[k].text, pascal, "deviatoric stress of a spring with its slider", false, true};
    return fields;
  }();
  using History = std::array<double, history.size()>;

  template <class Visitor>
  void fields(Visitor &&v) {
    Base::fields(v);
    Backbone::fields(v);
  }
  std::string problem() const {
    const std::string of_base = Base::problem();
    return of_base.empty() ? Backbone::problem() : of_base;
  }
  void prepare() {
    Base::prepare();
    discretise(this->G);
  }

  template <int dim, class Number>
  [[gnu::always_inline]] void advance(Stress<dim, Number> &s, const Strain<dim, Number> &e, History &history,
                                      const Surroundings &around) const {
    const Number volume = e.xx + e.yy + e.zz, third = volume * (1. / 3);
    const double over = 2 * lasting;
    const Number exx = e.xx - third, eyy = e.yy - third, ezz = e.zz - third;
    const Number pressed = volume * this->K;
    s.xx += pressed + exx * over, s.yy += pressed + eyy * over, s.zz += pressed + ezz * over, s.xy += e.xy * over;
    if constexpr (dim == 3) s.yz += e.yz * over, s.xz += e.xz * over;
#pragma GCC unroll 12
    for (int k = 0; k < sliders; ++k) {
      double *own = history.data() + first_tensor + components * k;
      const double twice = 2 * stiffness[k], most = limit[k] * limit[k];
      const Number xx = exx * twice + own[0], yy = eyy * twice + own[1], xy = e.xy * twice + own[2], zz = -xx - yy;
      Number square = (xx * xx + yy * yy + zz * zz) * 0.5 + xy * xy, yz = 0, xz = 0;
      if constexpr (dim == 3) {
        yz = e.yz * twice + own[3], xz = e.xz * twice + own[4];
        square += yz * yz + xz * xz;
      }
      const bool slides = square > most;
      const Number root = sqrt(slides ? square : Number(most > 0 ? most : 1));
      const Number share = slides ? limit[k] / root : Number(1);
      const auto put = [&](double &stored, const Number &trial, Number &of_point) __attribute__((always_inline)) {
        const Number end = trial * share;
        of_point += end - stored;
        stored = value_of(end);
      };
      s.zz += zz * share + own[0] + own[1];
      put(own[0], xx, s.xx), put(own[1], yy, s.yy), put(own[2], xy, s.xy);
      if constexpr (dim == 3) put(own[3], yz, s.yz), put(own[4], xz, s.xz);
    }
    correct(s, history, around);
  }

  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &s, History &history, const Surroundings &around) const {
    typename Base::History of_base;
    for (std::size_t k = 0; k < of_base.size(); ++k) of_base[k] = history[k];
    Base::correct(s, of_base, around);
    for (std::size_t k = 0; k < of_base.size(); ++k) history[k] = of_base[k];
  }

  /// Turns the tensors of a history: `turned(stress)` is the stress in the turned frame.
  template <int dim, class Turn>
  [[gnu::always_inline]] static void turn(History &history, const Turn &turned) {
#pragma GCC unroll 12
    for (int k = 0; k < sliders; ++k) {
      double *own = history.data() + first_tensor + components * k;
      Stress<dim> s;
      s.xx = own[0], s.yy = own[1], s.zz = -own[0] - own[1], s.xy = own[2];
      if constexpr (dim == 3) s.yz = own[3], s.xz = own[4];
      s = turned(s);
      own[0] = s.xx, own[1] = s.yy, own[2] = s.xy;
      if constexpr (dim == 3) own[3] = s.yz, own[4] = s.xz;
    }
  }
};

struct HystereticMohrCoulomb : Hysteretic<MohrCoulomb> {
  static constexpr const char *name = "hysteretic_mohr_coulomb";
  static constexpr const char *meaning =
      "mohr_coulomb whose shear stiffness falls with strain and whose cycles take energy (Masing), from small strain "
      "on";

  template <class Use>
  void as_case(Use use) const {
    MohrCoulomb::as_case([&]<class Case>(const Case &one) { use(Hysteretic<Case>{one, *this}); });
  }
};

}  // namespace talus
