#pragma once
#include <string>
#include <utility>

#include "base/units.h"
#include "physics/laws/history.h"
#include "physics/laws/lanes.h"
#include "physics/laws/stress.h"
#include "scene/quantity.h"
#include "scene/required.h"

namespace talus {

/// Modified Cam-clay (Roscoe & Burland 1968; Muir Wood 1990, ch. 5), docs/theory/laws/cam_clay.md. With p positive in
/// compression and counted from -`attraction`, v = 1 + e, triaxial q: elastic dv = -kappa dp / p and 2 G = 3 K (1 - 2
/// nu) / (1 + nu), K = v p / kappa; yield at q^2 = M^2 p (p_c - p), associated flow; hardening dv^p = -(lambda - kappa)
/// dp_c / p_c. Volume changes are integrated exactly, so that v + kappa ln p + (lambda - kappa) ln p_c never changes;
/// flow is implicit (Borja & Lee 1990, Comput. Methods Appl. Mech. Eng. 78), solved for t = q / (M p): below 1 on the
/// wet side of critical state, above it on the dry side. The result always lies on the ellipse.
struct CamClay {
  static constexpr const char *name = "cam_clay";
  static constexpr const char *meaning = "modified Cam-clay";
  static constexpr std::array<HistoryField, 4> history{{
      field_of_plastic_strain,
      {"plastic_volume", one, "plastic volumetric strain, positive in expansion"},
      {"volume_strain", one, "ln of the specific volume over its initial one", true},
      {"consolidation", one, "ln of the preconsolidation pressure over its initial one", true},
  }};
  using History = std::array<double, history.size()>;

  static constexpr const char *no_reduction =
      "has a strength that follows from its preconsolidation pressure, in place of a cohesion and a friction angle";

  double compression_slope = required;          ///< lambda [-]
  double swelling_slope = required;             ///< kappa [-]
  double critical_stress_ratio = required;      ///< M [-]
  double poisson_ratio = required;              ///< nu [-]
  double void_ratio = required;                 ///< e at the start [-]
  double preconsolidation_pressure = required;  ///< p_c at the start, counted from p = 0 [Pa]
  double attraction = 1e3;                      ///< the ellipse begins at p = -attraction [Pa]

  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("compression_slope", compression_slope, one, Range{1e-4, 10, {0.01, 1}},
             "lambda: slope of normal compression, v against ln p");
    v.number("swelling_slope", swelling_slope, one, Range{1e-5, 10, {1e-3, 0.2}},
             "kappa: slope of unloading, v against ln p");
    v.number("critical_stress_ratio", critical_stress_ratio, one, Range{0.1, 3, {0.5, 1.8}},
             "M: q / p at critical state; 6 sin(phi) / (3 - sin(phi)) in triaxial compression");
    v.number("poisson_ratio", poisson_ratio, one, Range{0, 0.49, {0.1, 0.45}}, "Poisson's ratio nu");
    v.number("void_ratio", void_ratio, one, Range{0.01, 20, {0.2, 5}}, "void ratio e at the start");
    v.number("preconsolidation_pressure", preconsolidation_pressure, pascal, Range{1, 1e9, {1e3, 1e7}},
             "largest past mean effective stress, at the start");
    v.number("attraction", attraction, pascal, Range{1e-3, 1e7, {1e-3, 1e5}},
             "mean tension that the soil can carry; it gives the soil a stiffness at zero stress");
  }
  std::string problem() const {
    if (compression_slope > swelling_slope) return "";
    return "compression_slope must exceed swelling_slope, " + shortest(swelling_slope) +
           ": soil hardens as it is compressed";
  }

  static constexpr bool by_place = false, rate_dependent = false, stiffens = true;
  bool reads_suction() const { return false; }
  bool strength_varies() const { return true; }
  bool comes_apart() const { return false; }
  /// At the preconsolidation pressure [Pa].
  double bulk_modulus() const { return (1 + void_ratio) * (preconsolidation_pressure + attraction) / swelling_slope; }
  double shear_modulus() const { return shear_over_bulk() * bulk_modulus(); }  ///< [Pa]
  double shear_over_bulk() const { return 3 * (1 - 2 * poisson_ratio) / (2 * (1 + poisson_ratio)); }

  /// Against the unstressed state, at the specific volume of the start [J/m3].
  template <int dim>
  double elastic_energy(const Stress<dim> &s) const {
    const Invariants<dim> stress(s);
    const double p = std::max(attraction - stress.p, 1e-6 * attraction), over_K = swelling_slope / (1 + void_ratio);
    return over_K *
           (p - attraction - attraction * std::log(p / attraction) + stress.q * stress.q / (2 * shear_over_bulk() * p));
  }

  // Of the parameters alone, set by prepare().
  double v0 = 0, log_pc0 = 0, M = 0, ratio = 0, plastic_slope = 0, log_least = 0;
  void prepare() {
    v0 = 1 + void_ratio, log_pc0 = std::log(preconsolidation_pressure + attraction), M = critical_stress_ratio;
    ratio = shear_over_bulk(), plastic_slope = compression_slope - swelling_slope;
    log_least = std::log(1e-3 * attraction);
  }

  /// Flow on the ellipse. With D the plastic volume and t_tr where the trial's pressure meets the ellipse (0 beyond
  /// p_c), associated flow asks for q_trial = S = M p t + 6 G t D / (M (1 - t^2)). Over w, t = (t_tr + w) / (1 + w), S
  /// is nearly straight: t runs from t_tr to critical state, t = 1, and D / (1 - t^2) is regular there.
  template <class Number>
  struct Flow {
    Number G, q;                     ///< shear modulus and trial deviator [Pa]
    Number log_p, log_pc;            ///< of the trial [ln Pa]
    Number trial_t, volume_per_log;  ///< t_tr, (lambda - kappa) kappa / (lambda v)
    double M, compression_slope, swelling_slope;

    struct State {
      Number t, p, log_pc, volume, q;  ///< volume: plastic, positive in compression; q: S
      Number slope;                    ///< dS / dw
    };
    [[gnu::always_inline]] State at(const Number &w) const {
      const double plastic_slope = compression_slope - swelling_slope, over = 1 / compression_slope;
      const Number share = 1 / (1 + w), t = (trial_t + w) * share, tt = t * t, log_ratio = logarithm(1 + tt);
      const Number since = log_ratio - (log_pc - log_p);  // how far p_c / p has grown
      const Number p = exponential(log_p - (plastic_slope * over) * since), side = 1 / (1 + t);
      const Number turn = 1 / (1 + trial_t * trial_t), z = (t - trial_t) * (t + trial_t) * turn;
      const Number series = 1 - z * (1. / 2 - z * (1. / 3 - z * (1. / 4 - z * (1. / 5 - z * (1. / 6)))));
      const bool small = z * z < 1e-6, beyond = log_pc < log_p;
      const Number smooth = (small ? series : since / (small ? Number(1) : z)) * w * (t + trial_t) * turn;
      const Number over_gap = volume_per_log * (beyond ? since * (1 + w) : smooth) * side;  // D / (1 - t^2)
      const Number bend = 2 * t / (1 + tt), stiff = (6 / M) * G, speed = (1 - trial_t) * share * share;
      const Number slope = M * p * (1 - (plastic_slope * over) * t * bend) * speed +
                           stiff * (over_gap * speed + (volume_per_log * bend + 2 * t * over_gap) * t * side * share);
      return {
          t,    p, log_pc + (swelling_slope * over) * since, volume_per_log * since, M * p * t + stiff * t * over_gap,
          slope};
    }

    /// Where S = q: Newton's method, kept in a bracket. Twelve steps give all digits, also for strains of 10 % at once.
    [[gnu::always_inline]] double solve() const {
      double w = 0, low = 0, high = 1e300;
      const auto narrow = [&](int) __attribute__((always_inline)) {
        const State s = at(w);
        const bool above = s.q > q;
        high = above ? w : high, low = above ? low : w;
        const double newton = w - (s.q - q) / s.slope, middle = high < 1e299 ? 0.5 * (low + high) : 2 * w + 1;
        const double kept = newton <= high ? newton : middle;
        w = newton >= low ? kept : middle;
      };
      [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) { (narrow(k), ...); }
      (std::make_integer_sequence<int, 12>());  // written out: a loop here would not be vectorised over points
      return w;
    }
  };

  /// The whole update: what the increment adds to the volume is known, how much of it is plastic is not.
  template <int dim, class Number>
  [[gnu::always_inline]] void advance(Stress<dim, Number> &s, const Strain<dim, Number> &e, History &history,
                                      const Surroundings &) const {
    auto &[plastic_strain, plastic_volume, volume_strain, consolidation] = history;
    const Number spread = e.xx + e.yy + e.zz;
    const double v = v0 * exponential(volume_strain);
    const Number growth = v * (exponential(spread) - 1), over_v = plastic_slope / (v + growth / 2);
    const Invariants<dim, Number> start(s);
    const Number p_start = attraction - start.p;
    const double least = 1e-3 * attraction;
    const Number p_0 = p_start > least ? p_start : Number(least);
    const Number far = logarithm(p_0) - growth * (1 / swelling_slope),
                 log_p = far > log_least ? far : Number(log_least);
    const double log_pc = log_pc0 + consolidation;

    // The shear modulus of the step is that of the geometric mean of its first and its trial pressure, of which more
    // than p_c (or the first) is not reached.
    const Number half = logarithm(p_0) > log_pc ? logarithm(p_0) : Number(log_pc);
    const Number top = log_p < half ? log_p : half;
    const Number G = (ratio / swelling_slope) * v * exponential((logarithm(p_0) + top) * 0.5);
    const Number third = spread * (1. / 3), twice_G = 2 * G;
    s.xx = start.deviator.xx + twice_G * (e.xx - third);
    s.yy = start.deviator.yy + twice_G * (e.yy - third);
    s.zz = start.deviator.zz + twice_G * (e.zz - third);
    s.xy += twice_G * e.xy;
    if constexpr (dim == 3) s.yz += twice_G * e.yz, s.xz += twice_G * e.xz;
    const Number q = Invariants<dim, Number>(s).q * 1.7320508075688772;

    const Number p_trial = exponential(log_p), room = exponential(log_pc - log_p) - 1;
    const Number trial_t = sqrt(room > 0 ? room : 0);
    const bool elastic = q * q <= M * M * p_trial * p_trial * room;
    const Number per_log = over_v * (swelling_slope / compression_slope);
    const double found =
        Flow<double>{value_of(G),       value_of(q), value_of(log_p),   log_pc,        value_of(trial_t),
                     value_of(per_log), M,           compression_slope, swelling_slope}
            .solve();
    const Flow<Number> flow{G, q, log_p, log_pc, trial_t, per_log, M, compression_slope, swelling_slope};
    const auto last = flow.at(found);
    const auto end = flow.at(found - (last.q - q) / last.slope);  // the last step carries the derivatives of the root

    const Number shrunk = M * end.p * end.t / (q > 0 ? q : Number(1));
    const Number unsheared = 1 / (1 + 6 * G * end.volume / (M * M * end.p));  // of a trial without deviator
    const Number flown = q > 0 ? shrunk : unsheared, share = elastic ? Number(1) : flown;
    const Number p = (elastic ? p_trial : end.p) - attraction;
    s.xx = share * s.xx - p, s.yy = share * s.yy - p, s.zz = share * s.zz - p;
    s.xy *= share;
    if constexpr (dim == 3) s.yz *= share, s.xz *= share;
    plastic_strain += value_of(q * (1 - share) / (3 * G));
    plastic_volume -= elastic ? 0 : value_of(end.volume);
    volume_strain += value_of(spread);
    consolidation += elastic ? 0 : value_of(end.log_pc) - log_pc;
  }

  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &s, History &history, const Surroundings &around) const {
    advance(s, Strain<dim, Number>{}, history, around);
  }
};

}  // namespace talus
