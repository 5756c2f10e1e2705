#include "physics/laws/element_test.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "physics/kinematics.h"
#include "physics/laws/update_stress.h"
#include "scene/quantity.h"

namespace talus {
namespace {

/// Increments of the six components of deformation, and of pore pressure over the bulk modulus.
using Unknowns = Eigen::Matrix<double, 7, 1>;
using Jacobian = Eigen::Matrix<double, 7, 7>;

/// What one step prescribes of a component: its strain since the start, or its total stress; or the strain of xx.
struct Prescribed {
  bool stress = false;
  double value = 0;  ///< [-] or [Pa]
  bool as_xx = false;
};
struct Step {
  std::array<Prescribed, 6> of{};
  double suction = 0, time_step = 0;  ///< at its end [Pa], that it takes [s]
};

/// 1 / (K_l / n), the volume that a pore pressure of 1 Pa takes [1/Pa].
double pore_compliance(const ElementTest &test, double bulk_modulus) {
  return test.pore_stiffness > 0 ? 1 / test.pore_stiffness : (1 - test.skempton_b) / (test.skempton_b * bulk_modulus);
}

class Driver {
 public:
  Driver(const Law &law, const ElementTest &test)
      : law_(law), test_(test), K_(bulk_modulus(law)), compliance_(pore_compliance(test, K_)) {
    state_.pore_pressure = test.pore_pressure;
    state_.history.assign(history_size(law), 0);
    for (int i = 0; i < 3; ++i) state_.stress[i] = -test.cell_pressure;
    std::copy(test.stress.begin(), test.stress.end(), state_.stress.begin());
    for (int i = 0; i < 6; ++i) start_[i] = total(state_, i);
    if (test.suction.given()) state_.suction = test.suction(0);
  }

  std::vector<ElementState> walk() {
    std::vector<ElementState> states{state_};
    double from = 0;
    const std::vector<double> legs = test_.type == TestType::controlled ? std::vector<double>{1} : test_.strain;
    for (const double to : legs) {
      guess_.setZero();
      for (int k = 1; k <= test_.steps; ++k) {
        const double share = static_cast<double>(k) / test_.steps;
        Step step = prescribed(from + (to - from) * share);
        step.time_step = test_.duration / test_.steps;
        const double all = static_cast<double>(legs.size()) * test_.steps;
        if (test_.suction.given()) step.suction = test_.suction(static_cast<double>(states.size()) / all);
        advance(step, states.size(), 0);
        states.push_back(state_);
      }
      from = to;
    }
    return states;
  }

 private:
  static double total(const ElementState &s, int i) { return s.stress[i] - (i < 3 ? s.pore_pressure : 0); }

  /// The test's own rule: `driven` is its strain, or t of a controlled one.
  Step prescribed(double driven) const {
    Step step;
    auto &of = step.of;
    const auto keep_stress = [&](int i) { of[i] = {true, start_[i]}; };
    const auto strain = [&](int i, double value) { of[i].value = value; };
    // a round sample stays round: softening soil would choose one side to bulge at, by round-off
    const auto keep_side_stress = [&] {
      keep_stress(0);
      if (start_[0] == start_[2])
        of[2].as_xx = true;
      else
        keep_stress(2);
    };
    switch (test_.type) {
      case TestType::triaxial_compression:
        strain(1, -driven), keep_side_stress();
        break;
      case TestType::triaxial_extension:
        strain(1, driven), keep_side_stress();
        break;
      case TestType::biaxial:
        strain(1, -driven), keep_stress(0);
        break;
      case TestType::oedometer:
        strain(1, -driven);
        break;
      case TestType::simple_shear:
        strain(3, driven), keep_stress(1);
        break;
      case TestType::isotropic_compression:
        for (int i = 0; i < 3; ++i) strain(i, -driven / 3);
        break;
      case TestType::controlled:
        for (int i = 0; i < 6; ++i) {
          if (test_.control.stress[i].given()) of[i] = {true, test_.control.stress[i](driven)};
          if (test_.control.strain[i].given()) of[i] = {false, test_.control.strain[i](driven)};
        }
    }
    return step;
  }

  /// The accepted state deformed by dF = [e^xx xy xz; 0 e^yy yz; 0 0 e^zz].
  ElementState deformed(const Unknowns &x, const Step &step) const {
    const Gradient<3> g{std::expm1(x[0]), x[3], x[5], 0, std::expm1(x[1]), x[4], 0, 0, std::expm1(x[2])};
    Increment<3> increment;
    decompose<3>(g, increment);
    ElementState next = state_;
    const int cell = 0;
    StressPoints<3> point{};
    point.count = 1, point.cell = &cell, point.increment = &increment, point.size = &test_.element_size;
    point.stress_in = state_.stress.data(), point.history_in = state_.history.data();
    point.stress_out = next.stress.data(), point.history_out = next.history.data();
    point.suction = &step.suction, point.time_step = step.time_step, point.time = state_.time;
    update_stress<3>(law_, point);
    for (int i = 0; i < 6; ++i) next.strain[i] += x[i];
    next.pore_pressure += K_ * x[6], next.suction = step.suction, next.time += step.time_step;
    return next;
  }

  /// How far a state is from what is prescribed [Pa].
  Unknowns residual(const ElementState &next, const Unknowns &x, const Step &step) const {
    Unknowns r;
    for (int i = 0; i < 6; ++i) {
      const Prescribed &one = step.of[i];
      const double strain = one.as_xx ? next.strain[0] : one.value;
      r[i] = one.stress ? total(next, i) - one.value : K_ * (next.strain[i] - strain);
    }
    r[6] = K_ * (test_.undrained ? compliance_ * K_ * x[6] + x[0] + x[1] + x[2] : x[6]);
    return r;
  }

  Jacobian slope(const Unknowns &x, const Unknowns &r, const Step &step) const {
    constexpr double width = 1e-8;  // large against the round-off of the stress, small against a step
    Jacobian slope;
    for (int k = 0; k < 7; ++k) {
      Unknowns moved = x;
      moved[k] += width;
      slope.col(k) = (residual(deformed(moved, step), moved, step) - r) / width;
    }
    return slope;
  }

  /// Finds the step's deformation, in two halves where Newton's method does not.
  void advance(const Step &step, std::size_t number, int depth) {
    constexpr int deepest = 8;
    const ElementState before = state_;
    if (solve(step)) return;
    if (depth == deepest) give_up(number);
    Step half = step, rest = step;
    for (int i = 0; i < 6; ++i)
      half.of[i].value = (step.of[i].value + (step.of[i].stress ? total(before, i) : before.strain[i])) / 2;
    half.suction = (step.suction + before.suction) / 2, half.time_step = rest.time_step = step.time_step / 2;
    guess_ /= 2;
    advance(half, number, depth + 1);
    advance(rest, number, depth + 1);
  }

  bool solve(const Step &step) {
    constexpr int most = 60, shortest_cut = 12;
    Unknowns x = guess_;
    for (int i = 0; i < 6; ++i)
      if (!step.of[i].stress && !step.of[i].as_xx) x[i] = step.of[i].value - state_.strain[i];
    ElementState next = deformed(x, step);
    Unknowns r = residual(next, x, step);
    for (int iteration = 0; iteration < most; ++iteration) {
      double scale = 1e-12 * K_;  // of the stress that round-off is counted from
      for (int i = 0; i < 6; ++i)
        scale = std::max({scale, std::abs(next.stress[i]), std::abs(total(next, i)), K_ * std::abs(x[i])});
      if (!std::isfinite(r.norm())) return false;
      if (r.cwiseAbs().maxCoeff() <= 1e-11 * scale) {
        state_ = next, guess_ = x;
        return true;
      }
      const Unknowns full = -slope(x, r, step).fullPivLu().solve(r);
      double share = 1;
      for (int cut = 0; cut <= shortest_cut; ++cut, share /= 2) {  // the residual must fall
        const Unknowns moved = x + share * full;
        const ElementState trial = deformed(moved, step);
        const Unknowns rest = residual(trial, moved, step);
        if (rest.norm() < r.norm() || cut == shortest_cut) {
          x = moved, next = trial, r = rest;
          break;
        }
      }
    }
    return false;
  }

  [[noreturn]] void give_up(std::size_t number) const {
    const std::string trouble = law_trouble(law_).text;
    if (!trouble.empty())
      throw ElementTestError("test " + test_.name + ", step " + std::to_string(number) + ": " + trouble);
    throw ElementTestError("test " + test_.name + ": no stress of the law " + law_name(law_) + " answers step " +
                           std::to_string(number) + "; before it p' = " + shortest(state_.mean_pressure()) +
                           " Pa, q = " + shortest(state_.deviator()) +
                           " Pa. Take more steps; a soil that softens faster than its own elasticity unloads needs a "
                           "smaller element_size");
  }

  const Law &law_;
  const ElementTest &test_;
  double K_, compliance_;
  ElementState state_;
  std::array<double, 6> start_{};  ///< total stress [Pa]
  Unknowns guess_ = Unknowns::Zero();
};

}  // namespace

bool Control::given() const {
  for (int i = 0; i < 6; ++i)
    if (strain[i].given() || stress[i].given()) return true;
  return false;
}

std::string Control::problem() const {
  for (int i = 0; i < 6; ++i)
    if (strain[i].given() && stress[i].given())
      return std::string("takes either ") + strain_keys[i] + " or " + stress_keys[i];
  return "";
}

std::string ElementTest::problem() const {
  if (!stress.empty() && stress.size() != 3 && stress.size() != 6)
    return "stress must have 3 components (xx, yy, zz) or 6";
  if (type != TestType::controlled && strain.empty()) return "needs strain, at least one value";
  if (control.given() && type != TestType::controlled) return "a table control belongs to type = \"controlled\"";
  if (!control.given() && type == TestType::controlled)
    return "type = \"controlled\" needs a table control, for instance with stress_yy";
  if (!undrained && (skempton_b < 1 || pore_stiffness > 0))
    return "skempton_b and pore_stiffness need undrained = true";
  if (undrained && suction.given()) return "takes either undrained or suction: water that cannot leave fills the pores";
  if (skempton_b < 1 && pore_stiffness > 0) return "takes either skempton_b or pore_stiffness";
  const bool closed = type == TestType::oedometer || type == TestType::isotropic_compression;
  if (closed && undrained && skempton_b == 1 && pore_stiffness == 0)
    return "a sample that keeps its volume cannot be compressed; give pore_stiffness or a skempton_b below 1";
  return "";
}

double ElementState::deviator() const {
  const auto &[xx, yy, zz, xy, yz, xz] = stress;
  return std::sqrt(((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) / 2 +
                   3 * (xy * xy + yz * yz + xz * xz));
}

void refuse_unsuitable(const Law &law, const ElementTest &test) {
  const std::string of = "test." + test.name + ": the law " + law_name(law);
  if (test.suction.given() && !reads_suction(law)) throw std::invalid_argument(of + " takes no strength from suction");
  if (reads_shares(law))
    throw std::invalid_argument(of +
                                " has a strength that is a function of place, and a sample has no place; give numbers "
                                "for cohesion and friction_angle");
  if (test.duration == 0 && rate_dependent(law))
    throw std::invalid_argument(of + " flows with time; give the test a duration, such as \"1 s\"");
}

std::vector<ElementState> drive(const Law &law, const ElementTest &test) {
  refuse_unsuitable(law, test);
  return Driver(law, test).walk();
}

}  // namespace talus
