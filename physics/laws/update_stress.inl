/// The loops behind update_stress.h, compiled once per (law, dimension) by update_stress_2d.cpp and
/// update_stress_3d.cpp.
#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

#include "physics/block.h"
#include "physics/laws/laws.h"
#include "physics/laws/principal_tangent.h"
#include "physics/laws/update_stress.h"

namespace talus {
namespace {

[[gnu::always_inline]] inline void put(Block<4> &b, int i, const Stress<2> &s) {
  b.value[0][i] = s.xx, b.value[1][i] = s.yy, b.value[2][i] = s.zz, b.value[3][i] = s.xy;
}
[[gnu::always_inline]] inline void put(Block<6> &b, int i, const Stress<3> &s) {
  b.value[0][i] = s.xx, b.value[1][i] = s.yy, b.value[2][i] = s.zz;
  b.value[3][i] = s.xy, b.value[4][i] = s.yz, b.value[5][i] = s.xz;
}

/// R s R^T with R = [cos -sin; sin cos].
template <class Number>
[[gnu::always_inline]] inline Stress<2, Number> rotated(const Stress<2, Number> &s, const std::array<double, 2> &R) {
  const double cos2 = R[0] * R[0] - R[1] * R[1], sin2 = 2 * R[0] * R[1];
  const Number centre = (s.xx + s.yy) / 2, half = (s.xx - s.yy) / 2;
  const Number turned = half * cos2 - s.xy * sin2;
  return {centre + turned, centre - turned, s.zz, half * sin2 + s.xy * cos2};
}
template <class Number>
[[gnu::always_inline]] inline Stress<3, Number> rotated(const Stress<3, Number> &s, const std::array<double, 9> &R) {
  const auto &[a, b, c, d, e, f, g, h, k] = R;
  const Number ax = a * s.xx + b * s.xy + c * s.xz, ay = a * s.xy + b * s.yy + c * s.yz,
               az = a * s.xz + b * s.yz + c * s.zz;
  const Number dx = d * s.xx + e * s.xy + f * s.xz, dy = d * s.xy + e * s.yy + f * s.yz,
               dz = d * s.xz + e * s.yz + f * s.zz;
  const Number gx = g * s.xx + h * s.xy + k * s.xz, gy = g * s.xy + h * s.yy + k * s.yz,
               gz = g * s.xz + h * s.yz + k * s.zz;
  return {ax * a + ay * b + az * c, dx * d + dy * e + dz * f, gx * g + gy * h + gz * k,
          ax * d + ay * e + az * f, dx * g + dy * h + dz * k, ax * g + ay * h + az * k};
}

/// A stress of the law's after a strain, before rotation.
template <int dim, class Number, class OneLaw>
[[gnu::always_inline]] inline Stress<dim, Number> strained_by(const OneLaw &law, Stress<dim, Number> s,
                                                              const Strain<dim, Number> &e,
                                                              typename OneLaw::History &history,
                                                              const Surroundings &around) {
  if constexpr (member::advance<OneLaw, dim, Number>)
    law.advance(s, e, history, around);
  else
    law.trial(s, e, around), law.correct(s, history, around);
  return s;
}

/// `lanes` points that go through one law together.
template <int dim, class OneLaw>
struct PointBlock {
  Block<stress_size<dim>> stress, strain;
  Block<std::tuple_size_v<decltype(Increment<dim>::rotation)>> rotation;
  Block<OneLaw::history.size()> history;
  Block<1> element_size;
  Block<OneLaw::by_place> suction, cohesion, friction;
  Block<1> outside;  ///< 1: outside the yield surface
  Row own, seen;     ///< of one internal variable: what the points have, and what the law sees

  /// Lets the law see internal variable k greater by `excess` of each point ...
  [[gnu::always_inline]] void show(int k, const double *const excess[lanes]) {
    std::memcpy(&own, history.value[k], sizeof own);
    Block<1> more;
    more.load(excess);
    std::memcpy(&seen, more.value[0], sizeof seen);
    seen += own;
    std::memcpy(history.value[k], &seen, sizeof seen);
    asm("" : "+m"(history.value));  // as Block::load has it
  }
  /// ... and adds to what the points have what the law has added.
  [[gnu::always_inline]] void give_back(int k) {
    Row after;
    std::memcpy(&after, history.value[k], sizeof after);
    after = own + (after - seen);
    std::memcpy(history.value[k], &after, sizeof after);
  }

  [[gnu::always_inline]] Surroundings around(double time_step, int i) const {
    Surroundings found{element_size.value[0][i], 0, time_step};
    if constexpr (OneLaw::by_place)
      found.suction = suction.value[0][i], found.cohesion = cohesion.value[0][i], found.friction = friction.value[0][i];
    return found;
  }
  /// One call is the whole body of the loop: what lived in the loop itself would be kept in memory, and the loop stay
  /// scalar.
  template <bool strained>
  [[gnu::always_inline]] void correct(const OneLaw &law, double time_step, int i) {
    auto s = take<Stress<dim>>(stress, i);
    auto h = take<typename OneLaw::History>(history, i);
    const Surroundings around = this->around(time_step, i);
    if constexpr (strained) {
      s = strained_by(law, s, take<Strain<dim>>(strain, i), h, around);
      const auto R = take<decltype(Increment<dim>::rotation)>(rotation, i);
      s = rotated(s, R);
      if constexpr (member::turn<OneLaw, dim>)
        OneLaw::template turn<dim>(
            h, [&R](const Stress<dim> &t) __attribute__((always_inline)) { return rotated(t, R); });
    } else {
      law.correct(s, h, around);
    }
    put(stress, i, s);
    put(history, i, h);
  }
  /// In three loops, of which blocks whose points all stay elastic leave out the second, `correct<false>`.
  [[gnu::always_inline]] void strain_elastically(const OneLaw &law, double time_step, int i) {
    auto s = take<Stress<dim>>(stress, i);
    const Surroundings around = this->around(time_step, i);
    law.trial(s, take<Strain<dim>>(strain, i), around);
    put(stress, i, s);
    outside.value[0][i] = law.admits(s, take<typename OneLaw::History>(history, i), around) ? 0 : 1;
  }
  [[gnu::always_inline]] void rotate(int i) {
    put(stress, i, rotated(take<Stress<dim>>(stress, i), take<decltype(Increment<dim>::rotation)>(rotation, i)));
  }
  bool all_inside() const {
    return std::all_of(outside.value[0], outside.value[0] + lanes, [](double x) { return x == 0; });
  }
};

template <bool strained, int dim, class OneLaw>
[[gnu::always_inline]] inline void correct(const OneLaw &law, double time_step, PointBlock<dim, OneLaw> &block) {
  if constexpr (strained && member::admits<OneLaw, dim>) {
#pragma omp simd
    for (int i = 0; i < lanes; ++i) block.strain_elastically(law, time_step, i);
    if (!block.all_inside()) {
#pragma omp simd
      for (int i = 0; i < lanes; ++i) block.template correct<false>(law, time_step, i);
    }
#pragma omp simd
    for (int i = 0; i < lanes; ++i) block.rotate(i);
  } else {
#pragma omp simd
    for (int i = 0; i < lanes; ++i) block.template correct<strained>(law, time_step, i);
  }
}

/// Calls `use` with the law, or with the simplest case of it if it offers cases (`as_case`).
template <class Use>
void visit_case(const Law &law, Use use) {
  law.visit([&](const auto &one) {
    if constexpr (member::as_case<std::decay_t<decltype(one)>>)
      one.as_case(use);
    else
      use(one);
  });
}

/// Water in the pores of a block of points that it cannot leave: their stress is effective while it is let go.
struct HeldWater {
  double pressure[lanes];  ///< excess over that of [water] [Pa]

  template <std::size_t size>
  void let_go(Block<size> &stress) const {
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < lanes; ++i) stress.value[k][i] += pressure[i];
  }
  template <std::size_t size>
  void hold(Block<size> &stress) const {
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < lanes; ++i) stress.value[k][i] -= pressure[i];
  }
  template <std::size_t size>
  void press(const Block<size> &strain, double stiffness) {
    for (int i = 0; i < lanes; ++i)
      pressure[i] -= stiffness * (strain.value[0][i] + strain.value[1][i] + strain.value[2][i]);
  }
};

/// `law` is a copy, so that no store to the arrays can change it: the compiler then takes what depends on it alone out
/// of the loop.
template <bool strained, int dim, UpdatesStress OneLaw>
void correct_all(OneLaw law, const StressPoints<dim> &points, const Law &whole) {
  constexpr int size = stress_size<dim>, own = static_cast<int>(OneLaw::history.size());
  const bool holds_water = whole.holds_water();
  const int memory = own + (holds_water ? 1 : 0);
  HeldWater water{};
  law.prepare();
  const double time_step = points.time_step, no_suction = 0;
  PointBlock<dim, OneLaw> block;
  if constexpr (OneLaw::by_place) block.cohesion.fill(1), block.friction.fill(1);

  for (int first = 0; first < points.count; first += lanes) {
    const int filled = std::min(lanes, points.count - first);
    const double *stress[lanes], *history[lanes], *strain[lanes], *rotation[lanes], *element_size[lanes],
        *suction[lanes], *cohesion[lanes], *friction[lanes], *excess[lanes];
    double *stress_out[lanes], *history_out[lanes];
    for (int i = 0; i < lanes; ++i) {
      const int p = first + std::min(i, filled - 1);  // the last block repeats its last point
      stress[i] = points.stress_in + p * size;
      history[i] = points.history_in + p * memory;
      stress_out[i] = points.stress_out + p * size, history_out[i] = points.history_out + p * memory;
      element_size[i] = points.size + points.cell[p];
      if (points.excess) excess[i] = points.excess + p;
      if constexpr (OneLaw::by_place) {
        suction[i] = points.suction ? points.suction + p : &no_suction;
        if (points.cohesion_share) cohesion[i] = points.cohesion_share + p;
        if (points.friction_share) friction[i] = points.friction_share + p;
      }
      if constexpr (strained) {
        strain[i] = points.increment[points.cell[p]].strain.data();
        rotation[i] = points.increment[points.cell[p]].rotation.data();
      }
    }
    block.stress.load(stress);
    block.history.load(history);
    block.element_size.load(element_size);
    if constexpr (OneLaw::by_place) {
      block.suction.load(suction);
      if (points.cohesion_share) block.cohesion.load(cohesion);
      if (points.friction_share) block.friction.load(friction);
    }
    if constexpr (strained) block.strain.load(strain), block.rotation.load(rotation);
    if (holds_water) {
      for (int i = 0; i < lanes; ++i) water.pressure[i] = history[i][own];
      water.let_go(block.stress);
    }
    if (points.excess) block.show(points.averaged, excess);
    correct<strained>(law, time_step, block);
    if (points.excess) block.give_back(points.averaged);
    if (holds_water) {
      if constexpr (strained) water.press(block.strain, whole.pore_stiffness());
      water.hold(block.stress);
      for (int i = 0; i < lanes; ++i) history_out[i][own] = water.pressure[i];
    }
    block.stress.store(stress_out), block.history.store(history_out);
  }
}

/// Point by point, with the strain as the `stress_size` variables to differentiate by.
template <int dim, UpdatesStress OneLaw>
void differentiate_all(OneLaw law, const StressPoints<dim> &points, const Law &whole, double *tangent) {
  constexpr int size = stress_size<dim>, own = static_cast<int>(OneLaw::history.size());
  const int memory = own + (whole.holds_water() ? 1 : 0);
  using Number = Dual<size>;
  using Row = std::array<Number, size>;
  law.prepare();
  for (int p = 0; p < points.count; ++p, tangent += size * size) {
    const Increment<dim> &increment = points.increment[points.cell[p]];
    typename OneLaw::History history;
    std::copy_n(points.history_in + p * memory, own, history.begin());
    Row stress, strain;
    for (int k = 0; k < size; ++k) {
      stress[k] = points.stress_in[p * size + k], strain[k] = increment.strain[k];
      strain[k].slope[k] = 1;
    }
    for (int k = 0; k < 3 && whole.holds_water(); ++k) stress[k] += points.history_in[p * memory + own];
    const Surroundings around{points.size[points.cell[p]], points.suction ? points.suction[p] : 0, points.time_step,
                              points.cohesion_share ? points.cohesion_share[p] : 1,
                              points.friction_share ? points.friction_share[p] : 1};
    const auto s = rotated(strained_by<dim>(law, std::bit_cast<Stress<dim, Number>>(stress),
                                            std::bit_cast<Strain<dim, Number>>(strain), history, around),
                           increment.rotation);
    const Row row = std::bit_cast<Row>(s);
    for (int k = 0; k < size; ++k) std::copy_n(row[k].slope.begin(), size, tangent + k * size);
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) tangent[k * size + j] += whole.pore_stiffness();
  }
}

/// One point of the user's law; `tangent` unless null as `update_stress_with_tangent` has it. Stress and strain are
/// turned first, as a UMAT expects them.
template <bool strained, int dim>
void call_one(const Umat &law, const StressPoints<dim> &points, int p, Stress<dim> &s, double *history,
              double *tangent) {
  constexpr int size = stress_size<dim>;
  const Increment<dim> &increment = points.increment[points.cell[p]];
  double rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, at_point[size * size];
  Strain<dim> e{};
  std::memcpy(&s, points.stress_in + p * size, sizeof s);
  if (history != points.history_in + p * law.nstatv)
    std::copy_n(points.history_in + p * law.nstatv, law.nstatv, history);
  if constexpr (strained) {
    std::memcpy(&e, increment.strain.data(), sizeof e);
    s = rotated(s, increment.rotation), e = rotated(e, increment.rotation);
    if constexpr (dim == 2)
      rotation[0] = rotation[4] = increment.rotation[0], rotation[3] = increment.rotation[1],
      rotation[1] = -increment.rotation[1];
    else
      std::copy_n(increment.rotation.data(), 9, rotation);
  }
  law.call({size, &s.xx, &e.xx, history, rotation, points.cell[p], points.size[points.cell[p]], points.time,
            points.time_step, tangent ? at_point : nullptr});
  if (!tangent) return;
  for (int j = 0; j < size; ++j) {  // along one component of the strain before it is turned
    std::array<double, size> unit{};
    unit[j] = 1;
    const auto turned =
        std::bit_cast<std::array<double, size>>(rotated(std::bit_cast<Strain<dim>>(unit), increment.rotation));
    for (int i = 0; i < size; ++i) {
      double sum = 0;
      for (int k = 0; k < size; ++k) sum += at_point[i * size + k] * (k < 3 ? 1 : 2) * turned[k];
      tangent[i * size + j] = sum;
    }
  }
}

template <bool strained, int dim>
void correct_all(const Umat &law, const StressPoints<dim> &points, const Law &) {
  Stress<dim> s;
  for (int p = 0; p < points.count; ++p) {
    call_one<strained>(law, points, p, s, points.history_out + p * law.nstatv, nullptr);
    std::memcpy(points.stress_out + p * stress_size<dim>, &s, sizeof s);
  }
}

template <int dim>
void differentiate_all(const Umat &law, const StressPoints<dim> &points, const Law &, double *tangent) {
  Stress<dim> s;
  std::vector<double> history(law.nstatv);
  for (int p = 0; p < points.count; ++p, tangent += stress_size<dim> * stress_size<dim>)
    call_one<true>(law, points, p, s, history.data(), tangent);
}

}  // namespace

template <int dim>
void update_stress_with_tangent(const Law &law, const StressPoints<dim> &points, double *tangent) {
  visit_case(law, [&](const auto &one) { differentiate_all(one, points, law, tangent); });
  update_stress(law, points);
}

template <int dim>
void update_stress(const Law &law, const StressPoints<dim> &points) {
  visit_case(law, [&](const auto &one) { correct_all<true>(one, points, law); });
}

template <int dim>
void admit_stress(const Law &law, const StressPoints<dim> &points) {
  visit_case(law, [&](const auto &one) { correct_all<false>(one, points, law); });
}

}  // namespace talus
