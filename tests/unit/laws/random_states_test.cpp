/// A million random states of every law, of random parameters: 2 dimensions, 50 soils, 10,000 points each. Stress and
/// strain of a point share their axes Q (for laws whose trial stress is linear in the strain that is no loss of
/// generality), so that each update can be repeated in the axes, where principal stresses can be read off: there they
/// are compared with the yield surface, written anew in this file.
#include <gtest/gtest.h>

#include "drawn.h"

namespace talus {
namespace {

using Triple = Eigen::Vector3d;  // along the axes

constexpr double size = 0.7, time_step = 1e-3;  // [m], [s]

/// What becomes of a point in the axes: Kirchhoff stress for the laws that return it, else Cauchy.
struct Update {
  Triple start, strain, trial, end;
  const double *before, *after;  ///< history
  Surroundings around;
  double one;      ///< 1 for Hencky's laws, else 0: they find strain beside 1, so that its round-off is that of 1
  double largest;  ///< stress, and round-off, that goes with it: per cents of the moduli [Pa]
};

double mean(const Triple &s) { return s.sum() / 3; }
double shear(const Triple &s) { return std::sqrt((s.array() - mean(s)).square().sum() / 2); }  // sqrt(J2)
double magnitude(const Update &u) { return u.trial.norm() + u.start.norm() + u.one * u.largest; }

template <class OneLaw>
Triple strained(const OneLaw &law, const Triple &s, const Triple &e) {
  const double G = law.shear_modulus(), K = law.bulk_modulus();
  return s + 2 * G * e + (K - 2 * G / 3) * e.sum() * Triple::Ones();
}
template <class OneLaw>
Triple elastic_part(const OneLaw &law, const Triple &s) {
  return (s.array() - mean(s)).matrix() / (2 * law.shear_modulus()) +
         Triple::Constant(mean(s) / (3 * law.bulk_modulus()));
}

/// How far the end is from what the law admits, over the stresses of the update. A law whose end is not written down
/// here is refused, also where it derives from one whose end is.
template <class OneLaw>
double miss(const OneLaw &, const Update &) = delete;
double miss(const LinearElastic &, const Update &u) { return (u.end - u.trial).norm() / (magnitude(u) + 1e-300); }
/// That of `drawn`, which is elastic.
double miss(const Umat &, const Update &u) { return miss(LinearElastic{}, u); }

/// A soil that softens returns to its strength after the plastic strain that the strength at the start would cause.
double miss(const MohrCoulomb &law, const Update &u) {
  Triple s = u.trial;
  std::sort(s.data(), s.data() + 3, std::greater<>());
  const Principal<> trial{s[0], s[1], s[2]};
  auto m = law.strength(u.before[0], u.around);
  if (law.softens()) {
    const Principal<> x = law.admissible(trial, m);
    m = law.strength(u.before[0] + law.shearing(Principal<>{s[0] - x.s1, s[1] - x.s2, s[2] - x.s3}), u.around);
  }
  const auto excess = [&](const Triple &t) {
    const double high = t.maxCoeff(), low = t.minCoeff();
    return std::max((high - low) + (high + low) * m.sin_phi - m.twice_c_cos_phi, high - m.tension);
  };
  const double whole = magnitude(u) + m.twice_c_cos_phi;
  return (excess(u.trial) <= 0 ? (u.end - u.trial).norm() : std::abs(excess(u.end))) / whole;
}

double miss(const DruckerPrager &law, const Update &u) {
  auto m = law.strength(u.before[0], u.around);
  if (law.softens()) {
    const double f = shear(u.trial) + m.eta * mean(u.trial) - m.limit,
                 slip = std::max(0., f) / (law.G + law.K * m.eta * m.eta_bar);
    const bool torn = mean(u.trial) - law.K * m.eta_bar * slip >= m.apex;
    const double plastic = (torn ? shear(u.trial) / law.G : slip) / std::sqrt(3.);
    m = law.strength(u.before[0] + plastic, u.around);
  }
  const auto excess = [&](const Triple &t) { return shear(t) + m.eta * mean(t) - m.limit; };
  return (excess(u.trial) <= 0 ? (u.end - u.trial).norm() : std::abs(excess(u.end))) / (magnitude(u) + m.limit);
}

/// The circle touches the envelope of (HB.1) over `divisor`, by bisection for the point that it touches. Next to the
/// apex the envelope ends on a tangent.
double miss(const HoekBrown &law, const Update &u) {
  const auto excess = [&](const Triple &t) {
    const double high = t.maxCoeff(), low = t.minCoeff(), centre = -(high + low) / 2;
    const auto touching = [&](double x) {
      const double d = law.intact_strength * std::pow(x, law.a), rise = law.a * law.m_b * std::pow(x, law.a - 1);
      const double normal = (x - law.s) * law.scale + d / (2 + rise), tau = d * std::sqrt(1 + rise) / (2 + rise);
      const double slope = rise / std::sqrt(1 + rise) / 2 / law.divisor;
      return Triple(normal + tau / law.divisor * slope, tau / law.divisor * std::sqrt(1 + slope * slope),
                    slope / std::sqrt(1 + slope * slope));
    };
    double below = law.least, above = 1e9;
    if (const Triple last = touching(below); last[0] > centre)
      return std::max((high - low) / 2 - last[1] - (centre - last[0]) * last[2], high - law.limit);
    for (int k = 0; k < 200; ++k) {
      const double x = std::sqrt(below * above);
      (touching(x)[0] < centre ? below : above) = x;
    }
    return std::max((high - low) / 2 - touching(below)[1], high - law.limit);
  };
  const double whole = magnitude(u) + law.apex;
  return (excess(u.trial) <= 0 ? (u.end - u.trial).norm() : std::abs(excess(u.end))) / whole;
}

/// No tension, and tau = tau_y + mu gamma_dot where it flows.
double miss_of_fluid(const Newtonian &law, const Update &u, double yield_stress) {
  const double rate = std::sqrt(3.) * (u.after[0] - u.before[0]) / u.around.time_step;
  const double tau = shear(u.trial) > yield_stress ? yield_stress + law.viscosity * rate : shear(u.trial);
  return (std::abs(mean(u.end) - std::min(0., mean(u.trial))) + std::abs(shear(u.end) - tau)) /
         (magnitude(u) + yield_stress);
}
double miss(const Newtonian &law, const Update &u) { return miss_of_fluid(law, u, 0); }
double miss(const Bingham &law, const Update &u) { return miss_of_fluid(law, u, law.yield_stress); }

/// No tension, and tau = mu(I) p where it flows.
double miss(const MuI &law, const Update &u) {
  const double pressure = std::max(0., -mean(u.trial)),
               rate = std::sqrt(3.) * (u.after[0] - u.before[0]) / u.around.time_step;
  const double I = rate * law.grain_size * std::sqrt(law.solid_density / pressure);
  const double mu = law.static_friction + (law.limiting_friction - law.static_friction) * I / (I + law.inertial_number);
  const bool flows = shear(u.trial) > law.static_friction * pressure;
  const double tau = pressure == 0 ? 0 : flows ? mu * pressure : shear(u.trial);
  // what the rate is read from is a loss of stress, over G dt: its round-off counts by the slope of tau over that
  const double slope =
      (law.limiting_friction - law.static_friction) * std::sqrt(pressure) / (law.G * u.around.time_step * law.rate);
  return (std::abs(mean(u.end) + pressure) + std::abs(shear(u.end) - tau) / (1 + slope)) / magnitude(u);
}

/// Flow ends on the ellipse; nothing ends outside of it.
double miss(const CamClay &law, const Update &u) {
  const double p = law.attraction - mean(u.end), q = std::sqrt(3.) * shear(u.end);
  const double pc = (law.preconsolidation_pressure + law.attraction) * std::exp(u.after[3]);
  const double f = q * q / (law.M * law.M) + p * (p - pc), whole = pc * pc + p * p;
  const bool torn = p <= 1.1e-3 * law.attraction;  // held at the least pressure
  return (torn ? 0 : u.after[0] != u.before[0] ? std::abs(f) : std::max(0., f)) / whole;
}

// Of Kirchhoff stress.
double miss(const HenckyElastic &law, const Update &u) { return miss(static_cast<const LinearElastic &>(law), u); }
double miss(const HenckyMohrCoulomb &law, const Update &u) { return miss(static_cast<const MohrCoulomb &>(law), u); }
double miss(const HenckyDruckerPrager &law, const Update &u) {
  return miss(static_cast<const DruckerPrager &>(law), u);
}

/// Its elements, which no strain has moved before, follow the backbone along the deviator of the strain; the base law
/// returns the stress.
Triple strained(const HystereticMohrCoulomb &law, const Triple &s, const Triple &e) {
  const Triple sheared = e.array() - mean(e);
  const double gamma = 2 * shear(e);
  double tau = law.lasting * gamma;
  for (int k = 0; k < Backbone::sliders; ++k) tau += std::min(law.stiffness[k] * gamma, law.limit[k]);
  return s + law.bulk_modulus() * e.sum() * Triple::Ones() + (gamma > 0 ? 2 * tau / gamma : 0) * sheared;
}
double miss(const HystereticMohrCoulomb &law, const Update &u) {
  return miss(static_cast<const MohrCoulomb &>(law), u);
}

/// Work that is lost, over the stresses and strains that take part; not below 0 but for round-off.
double loss(const IsotropicElastic &law, const Update &u) {
  const Triple plastic = u.strain - elastic_part(law, u.end - u.start);
  return u.end.dot(plastic) / (magnitude(u) * (u.strain.norm() + elastic_part(law, u.trial).norm() + u.one) + 1e-300);
}
/// Counted from -attraction the plastic work is p sqrt(deps_v^2 + M^2 deps_q^2) (Roscoe & Burland 1968): it cannot be
/// negative. The stress itself, counted from 0, may do a little less where a soil whose p_c has fallen below 2 a bears
/// tension.
double loss(const CamClay &law, const Update &u) {
  const double p = law.attraction - mean(u.end), q = std::sqrt(3.) * shear(u.end);
  const double volume = u.before[1] - u.after[1], sheared = u.after[0] - u.before[0];
  if (p <= 1.1e-3 * law.attraction) return 0;
  const double closed = p * std::hypot(volume, law.M * sheared),
               whole = std::hypot(p, q) * (std::hypot(volume, sheared) + 1e-6);
  const bool was_torn = law.attraction - mean(u.start) < 0.1 * law.attraction;
  EXPECT_NEAR((p * volume + q * sheared) / whole, closed / whole,
              was_torn ? 1e-3 : 1e-6);  // what twelve Newton steps leave
  return (p * volume + q * sheared) / whole;
}

/// Stress that its elements do not know of does no harm to them, but work may be won from it: hysteretic_test.cpp looks
/// at closed cycles.
double loss(const HystereticMohrCoulomb &, const Update &) { return 0; }

template <class OneLaw>
constexpr bool keeps_volume = [] {
  if constexpr (!std::is_same_v<OneLaw, Umat>)
    for (const HistoryField &field : OneLaw::history)
      if (std::string_view(field.name) == "volume_strain") return true;
  return false;
}();
template <class OneLaw>
constexpr bool is_hencky = keeps_volume<OneLaw> && !std::is_same_v<OneLaw, CamClay>;

struct Worst {
  double miss = 0, turned = 0, loss = 0;
};

template <int dim, class OneLaw>
void examine(const OneLaw &soil, Random &random, Worst &worst) {
  constexpr int n = 10000, directions = 61;
  OneLaw law = soil;
  law.prepare();
  Points<dim> points(law, n, size), in_axes(law, n, size);
  const int memory = history_size(points.law);
  const double strong =
      std::is_same_v<OneLaw, CamClay> ? 1e6 : 0.03 * shear_modulus(points.law);  // an elastic strain of per cents
  std::vector<Matrix> Q;
  for (int k = 0; k < directions; ++k) Q.push_back(random.rotation<dim>());
  const auto fields = history_fields(points.law);
  for (int i = 0; i < n; ++i) {
    const double whole = strong * std::pow(10, random.between(-4, 0)), pressure = random.between(-1, 2) * whole;
    Triple s(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    in_axes.stress[i] = components<dim>((whole * s - pressure * Triple::Ones()).asDiagonal());
    points.suction[i] = in_axes.suction[i] = random.between(0, 1e5);
    for (int k = 0; k < memory; ++k) {
      double &h = in_axes.history[i * memory + k];
      if (fields[k].kept) h = random.between(-0.2, 0.2);
      if (std::string_view(fields[k].name) == "plastic_strain" && law.strength_varies()) h = random.between(0, 0.02);
    }
  }
  in_axes.admit();
  for (int i = 0; i < n; ++i) {
    const double whole = std::pow(10, random.between(-8, -1));
    const Triple e(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    in_axes.increment[i].strain = components<dim>((whole * e).asDiagonal());
    const Matrix &q = Q[i % directions];
    points.stress[i] = components<dim>(q * matrix<dim>(in_axes.stress[i]) * q.transpose());
    points.increment[i].strain = components<dim>(q * matrix<dim>(in_axes.increment[i].strain) * q.transpose());
  }
  points.history = in_axes.history;
  const auto start = in_axes.stress;
  const auto before = in_axes.history;
  points.update(), in_axes.update();
  for (int i = 0; i < n; ++i) {
    const auto &s = in_axes.stress[i], &e = in_axes.increment[i].strain;
    Update u{{start[i][0], start[i][1], start[i][2]},
             {e[0], e[1], e[2]},
             {},
             {s[0], s[1], s[2]},
             before.data() + i * memory,
             in_axes.history.data() + i * memory,
             {size, in_axes.suction[i], time_step},
             is_hencky<OneLaw> ? 1. : 0.,
             0.03 * law.bulk_modulus()};
    double J = 1;
    if constexpr (is_hencky<OneLaw>)
      J = std::exp(u.after[memory - 1]), u.start *= std::exp(u.before[memory - 1]), u.end *= J;
    if constexpr (!std::is_same_v<OneLaw, CamClay>) u.trial = strained(law, u.start, u.strain);
    worst.miss = std::max(worst.miss, miss(law, u));
    worst.loss = std::max(worst.loss, -loss(law, u));
    const Matrix &q = Q[i % directions];
    const double whole =
        std::max(magnitude(u) / J, matrix<dim>(s).norm()) + (std::is_same_v<OneLaw, CamClay> ? 1e3 : 0);
    worst.turned =
        std::max(worst.turned, (q * matrix<dim>(s) * q.transpose() - matrix<dim>(points.stress[i])).norm() / whole);
    for (int k = 3; k < stress_size<dim>; ++k) worst.turned = std::max(worst.turned, std::abs(s[k]) / whole);
  }
}

template <class OneLaw>
class RandomStates : public ::testing::Test {};
TYPED_TEST_SUITE(RandomStates, TypesOf<Laws>::type);

/// The return ends on the surface; stress, strain and its end keep the same axes, whichever these are; no work is won.
TYPED_TEST(RandomStates, end_where_the_law_says) {
  Random random;
  Worst worst;
  for (int number = 0; number < 50; ++number) {
    const TypeParam law = drawn<TypeParam>(random, number);
    examine<2>(law, random, worst);
    examine<3>(law, random, worst);
  }
  EXPECT_LT(worst.miss, 1e-12);
  EXPECT_LT(worst.turned, 1e-11);
  EXPECT_LT(worst.loss, 1e-14);
  std::printf("%-22s million states: surface %.1e, axes %.1e, work won %.1e\n", TypeParam::name, worst.miss,
              worst.turned, worst.loss);
}

/// Strains from 1e-8 to 10 %, many steps, with rotation, under suction: no stress or history stops being a number.
TYPED_TEST(RandomStates, survive_random_walks) {
  Random random;
  for (int number = 0; number < 60; ++number) {
    SCOPED_TRACE(number);
    const Law law = drawn<TypeParam>(random, number);
    const auto walk = [&]<int dim>(Dim<dim>) {
      Points<dim> points(law, 64, size);
      for (int step = 0; step < 100; ++step) {
        for (int i = 0; i < 64; ++i) {
          points.increment[i].strain = random.symmetric<dim>(std::pow(10, random.between(-8, -1)));
          if (step % 3 == 0) points.increment[i].strain = {};
          points.turn(i, random.rotation<dim>());
          points.suction[i] = random.between(0, 1e5);
        }
        points.update();
      }
      for (const auto &s : points.stress)
        for (const double component : s) ASSERT_TRUE(std::isfinite(component));
      for (const double h : points.history) ASSERT_TRUE(std::isfinite(h));
    };
    walk(Dim<2>()), walk(Dim<3>());
  }
}

}  // namespace
}  // namespace talus
