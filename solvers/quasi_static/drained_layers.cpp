#include "solvers/quasi_static/drained_layers.h"

#include <algorithm>
#include <cmath>

namespace talus {

namespace {
constexpr double grows = 4;  // power of time with which a crossed layer conducts
constexpr double closed =
    100;  // times of crossing after which it conducts 1e8 times as much: the node has the pressure beyond
}  // namespace

/// Time in which a change of pressure crosses the cell beneath [s].
template <int dim>
double DrainedLayers<dim>::crossing_time(const Face &f) {
  return f.storage * f.height * f.height / (6 * f.conductivity);
}

/// Water through a layer until a time after the change, per area and pressure [m/Pa].
template <int dim>
double DrainedLayers<dim>::passed(const Face &f, double t) {
  const double crossed = crossing_time(f), until = std::min(t, crossed);
  const double water = 2 * std::sqrt(f.conductivity * f.storage * until / M_PI);
  return t <= crossed ? water : water * (1 + (std::pow(t / crossed, grows + 1) - 1) / (2 * (grows + 1)));
}

template <int dim>
PetscErrorCode DrainedLayers<dim>::begin(double from, double to) {
  PetscFunctionBeginUser;
  layered_.clear();
  if (!nodes_) PetscFunctionReturn(0);
  constexpr PetscInt layered = 1, without = 2;
  std::vector<PetscInt> state(nodes_->count(), 0);
  for (const Face &f : faces_)
    for (const int node : f.node)
      state[node] = std::max(state[node], to < closed * crossing_time(f) ? layered : without);
  PetscCall(nodes_->maximum(state));
  layered_.assign(nodes_->count(), 0), passes_.assign(nodes_->count(), 0);
  for (int i = 0; i < nodes_->count(); ++i) layered_[i] = state[i] == layered;
  for (const Face &f : faces_) {
    const double water = passed(f, to) - passed(f, from);
    for (const int node : f.node)
      if (layered_[node]) passes_[node] += f.area / dim * water;
  }
  PetscFunctionReturn(0);
}

template class DrainedLayers<2>;
template class DrainedLayers<3>;

}  // namespace talus
