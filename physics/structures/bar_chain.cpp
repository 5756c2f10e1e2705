#include "physics/structures/bar_chain.h"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

/// Stiffness that yielding elements and slipping points keep in the linear systems, over their own: what no force holds
/// has no place, and any will do.
constexpr double regular = 1e-9;

}  // namespace

double BarChain::force_of(int e, double pull) const {
  const BarElement &one = element[e];
  if (!bears(e)) return 0;
  if (one.held) return pull;
  return std::clamp(pull, -one.compression / divisor, one.tension / divisor);
}

double BarChain::bond_of(int i) const {
  const double limit = point[i].limit / divisor;
  return std::clamp(point[i].force + (slip_.empty() ? 0 : point[i].stiffness * slip_[i]), -limit, limit);
}

double BarChain::stiffness_of(int e, bool elastic) const {
  if (!bears(e) || element[e].held) return 0;
  if (elastic) return element[e].stiffness;
  const double pull = trial_pull(e);
  return pull == force_of(e, pull) ? element[e].stiffness : 0;
}

double BarChain::stiffness_at(int i, bool elastic) const {
  if (point[i].limit == 0) return 0;
  const double force = point[i].force + (slip_.empty() ? 0 : point[i].stiffness * slip_[i]);
  return elastic || std::abs(force) <= point[i].limit / divisor ? point[i].stiffness : 0;
}

/// Derivative of the energy by the slips [N].
void BarChain::unbalanced(std::vector<double> &force) const {
  force.assign(point.size(), 0);
  for (int e = 0; e < elements(); ++e) {
    const double n = this->force(e);
    force[e] -= n, force[e + 1] += n;
  }
  for (std::size_t i = 0; i < point.size(); ++i) force[i] += bond_of(static_cast<int>(i));
}

/// Solves the tridiagonal system of springs `along` the elements and `at` the points; x is the right side, then the
/// answer.
void BarChain::solve(const std::vector<double> &along, const std::vector<double> &at, std::vector<double> &x) const {
  const std::size_t n = point.size();
  std::vector<double> diagonal(n), factor(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    double own = at[i], all = point[i].stiffness;
    if (i > 0) own += along[i - 1], all = std::max(all, element[i - 1].stiffness);
    if (i + 1 < n) own += along[i], all = std::max(all, element[i].stiffness);
    diagonal[i] = own + regular * all;
  }
  for (std::size_t i = 1; i < n; ++i) {
    factor[i] = along[i - 1] / diagonal[i - 1];
    diagonal[i] -= factor[i] * along[i - 1];
    x[i] += factor[i] * x[i - 1];
  }
  x[n - 1] /= diagonal[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) x[i] = (x[i] + along[i] * x[i + 1]) / diagonal[i];
}

/// Goes along `step` to the least energy, whose slope is a broken line.
double BarChain::share_of_step(const std::vector<double> &step) {
  const std::vector<double> from = slip_;
  std::vector<double> force;
  const auto slope = [&](double share) {
    for (std::size_t i = 0; i < slip_.size(); ++i) slip_[i] = from[i] + share * step[i];
    unbalanced(force);
    double sum = 0;
    for (std::size_t i = 0; i < force.size(); ++i) sum += force[i] * step[i];
    return sum;
  };
  constexpr int most_doublings = 60, most_halvings = 100;
  const double at_start = slope(0);
  double low = 0, at_low = at_start, high = 1, at_high = slope(1);
  for (int k = 0; k < most_doublings && at_high < 0; ++k)
    low = high, at_low = at_high, high *= 2, at_high = slope(high);
  for (int k = 0; k < most_halvings && at_high > 1e-14 * -at_start; ++k) {
    const double secant = low + (high - low) * at_low / (at_low - at_high);
    const double middle = k % 3 == 2 ? (low + high) / 2 : secant;
    if (!(middle > low && middle < high)) break;
    const double now = slope(middle);
    if (now == 0) return middle;
    (now < 0 ? low : high) = middle, (now < 0 ? at_low : at_high) = now;
  }
  slope(high);
  return high;
}

bool BarChain::deform(const std::vector<double> &stretch) {
  constexpr int most_iterations = 200;
  constexpr double tolerance = 1e-12, round_off = 1e-15;
  stretch_ = stretch;
  slip_.assign(point.size(), 0);
  std::vector<double> step, along(element.size()), at(point.size());
  double scale = 0, stiffest = 0;
  for (const BarElement &one : element) stiffest = std::max(stiffest, one.stiffness);
  for (const BondPoint &one : point) stiffest = std::max(stiffest, one.stiffness);
  for (int e = 0; e < elements(); ++e)
    if (bears(e))
      scale = std::max({scale, std::abs(element[e].pull), std::min(element[e].tension, std::abs(trial_pull(e)))});
  for (const BondPoint &p : point) scale = std::max(scale, std::abs(p.force));
  for (int k = 0; k < most_iterations; ++k) {
    unbalanced(step);
    double largest = 0, way = 0;
    for (double &one : step) largest = std::max(largest, std::abs(one)), one = -one;
    for (const double slip : slip_) way = std::max(way, std::abs(slip));
    if (largest <= tolerance * scale + round_off * stiffest * way) return true;
    for (int e = 0; e < elements(); ++e) along[e] = stiffness_of(e, false);
    for (std::size_t i = 0; i < point.size(); ++i) at[i] = stiffness_at(static_cast<int>(i), false);
    solve(along, at, step);
    share_of_step(step);
  }
  return false;
}

void BarChain::tangent(double plastic, double elastic, std::vector<double> &rows) const {
  const std::size_t n = element.size();
  rows.assign(n * n, 0);
  std::vector<double> along(n), at(point.size()), x;
  for (const bool of_elastic : {false, true}) {
    const double share = of_elastic ? elastic : plastic;
    if (share == 0) continue;
    for (std::size_t e = 0; e < n; ++e) along[e] = stiffness_of(static_cast<int>(e), of_elastic);
    for (std::size_t i = 0; i < point.size(); ++i) at[i] = stiffness_at(static_cast<int>(i), of_elastic);
    for (std::size_t e = 0; e < n; ++e) {  // slips for a stretch of 1 of one element
      x.assign(point.size(), 0);
      x[e] = along[e], x[e + 1] = -along[e];
      solve(along, at, x);
      for (std::size_t row = 0; row < n; ++row)
        rows[row * n + e] += share * along[row] * ((row == e ? 1 : 0) + x[row + 1] - x[row]);
    }
  }
}

void BarChain::commit() {
  for (int e = 0; e < elements() && !stretch_.empty(); ++e) {
    BarElement &one = element[e];
    const double pull = trial_pull(e), force = force_of(e, pull);
    if (one.held) continue;
    const bool slack = pull < force && one.compression == 0;  // it is taken up before the bar bears again
    if (!slack && one.stiffness > 0) one.yielded += (pull - force) / one.stiffness;
    one.pull = slack ? pull : force;
    if (!bears(e)) one.pull = 0;
  }
  for (std::size_t i = 0; i < point.size() && !slip_.empty(); ++i) {
    point[i].force = bond_of(static_cast<int>(i));
    point[i].slip += slip_[i];
  }
  stretch_.clear(), slip_.clear();
}

int BarChain::to_tear(double strain) const {
  for (int e = 0; e < elements(); ++e) {
    const double pull = trial_pull(e), beyond = pull - force_of(e, pull);
    if (bears(e) && !element[e].held && beyond > 0 &&
        element[e].yielded + beyond / element[e].stiffness > strain * element[e].length)
      return e;
  }
  return -1;
}

}  // namespace talus
