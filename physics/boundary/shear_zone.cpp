#include "physics/boundary/shear_zone.h"

#include <algorithm>
#include <cmath>

namespace talus {

ShearZoneGrid::ShearZoneGrid(const ShearZone &zone) : zone_(zone) {
  const double half = zone.thickness / 2, first = half / in_zone;
  width_.assign(in_zone, first);
  const double beside = zone.reach - half;
  double sum = 0;
  for (double next = first; sum < beside; sum += next) next *= growth, width_.push_back(next);
  cells_ = static_cast<int>(width_.size());
  for (int i = in_zone; i < cells_; ++i) width_[i] *= beside / sum;
  for (System *system : {&heat_, &water_}) {
    const double diffusivity = system == &heat_ ? zone.thermal_diffusivity() : zone.hydraulic_diffusivity();
    system->inverse.resize(cells_), system->above.resize(cells_);
    for (int i = 0; i + 1 < cells_; ++i) system->conductance.push_back(2 * diffusivity / (width_[i] + width_[i + 1]));
    system->conductance.push_back(system == &heat_ ? 0 : 2 * diffusivity / width_.back());
  }
  answer_.resize(size()), before_.resize(cells_);
}

void ShearZoneGrid::factorise(System &system, double step) const {
  double behind = 0, rest = 0;  // the pivot less its `behind`, found without a difference, so that heat is conserved
  for (int i = 0; i < cells_; ++i) {
    rest = width_[i] + (i > 0 ? behind * rest * system.inverse[i - 1] : 0);
    behind = step * system.conductance[i];
    system.inverse[i] = 1 / (rest + behind), system.above[i] = behind * system.inverse[i];
  }
}

/// `x` holds the source per volume, and then the solution.
void ShearZoneGrid::solve(const System &system, double *x) const {
  double carried = 0;
  for (int i = 0; i < cells_; ++i) {
    x[i] = width_[i] * x[i] + carried;
    carried = system.above[i] * x[i];
  }
  double next = 0;
  for (int i = cells_ - 1; i >= 0; --i) x[i] = next = system.inverse[i] * x[i] + system.above[i] * next;
}

void ShearZoneGrid::set_step(double step) {
  if (step == step_) return;
  step_ = step;
  factorise(heat_, step), factorise(water_, step);
  std::fill(answer_.begin(), answer_.end(), 0);
  std::fill_n(answer_.begin(), in_zone, 1 / (zone_.heat_capacity * zone_.thickness));
  solve(heat_, answer_.data());
  for (int i = 0; i < cells_; ++i) answer_[cells_ + i] = zone_.thermal_pressurisation * answer_[i];
  solve(water_, answer_.data() + cells_);
  pressure_per_heat_ = pressure(answer_.data());
}

void ShearZoneGrid::spread(double *state) {
  std::copy_n(state, cells_, before_.begin());
  solve(heat_, state);
  for (int i = 0; i < cells_; ++i) state[cells_ + i] += zone_.thermal_pressurisation * (state[i] - before_[i]);
  solve(water_, state + cells_);
}

double ShearZoneGrid::heat(const double *state) const {
  double sum = 0;
  for (int i = 0; i < cells_; ++i) sum += width_[i] * state[i];
  return 2 * zone_.heat_capacity * sum;
}

}  // namespace talus
