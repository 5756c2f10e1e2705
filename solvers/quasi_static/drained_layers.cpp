#include "solvers/quasi_static/drained_layers.h"

#include <algorithm>
#include <cmath>

namespace talus {

template <int dim>
PetscErrorCode DrainedLayers<dim>::begin(double from, double to) {
  PetscFunctionBeginUser;
  thin_.clear();
  if (!nodes_) PetscFunctionReturn(0);
  constexpr PetscInt thin = 1, crossed = 2;
  std::vector<PetscInt> state(nodes_->count(), 0);
  for (const Face &f : faces_)
    for (const int node : f.node)
      state[node] = std::max(state[node], 6 * f.conductivity * to < f.storage * f.height * f.height ? thin : crossed);
  PetscCall(nodes_->maximum(state));
  thin_.assign(nodes_->count(), 0), passes_.assign(nodes_->count(), 0);
  for (int i = 0; i < nodes_->count(); ++i) thin_[i] = state[i] == thin;
  for (const Face &f : faces_) {
    const double water = 2 * std::sqrt(f.conductivity * f.storage / M_PI) * (std::sqrt(to) - std::sqrt(from));
    for (const int node : f.node)
      if (thin_[node]) passes_[node] += f.area / dim * water;
  }
  PetscFunctionReturn(0);
}

template class DrainedLayers<2>;
template class DrainedLayers<3>;

}  // namespace talus
