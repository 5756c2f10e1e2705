#include "physics/boundary/prescribed_motion.h"

#include <algorithm>

namespace talus {

template <int dim>
void PrescribedMotion<dim>::setup(int nodes, const std::vector<NamedBoundary> &sources) {
  for (const NamedBoundary &source : sources) kinds_.push_back(source.kind);
  for (Set &set : sets_) set.of_node.assign(nodes, -1);
}

template <int dim>
void PrescribedMotion<dim>::add(int node, int source, const Vec<dim> &normal) {
  const auto &directions = kinds_[source].template on_soil<dim>().directions;
  if (!directions) return;
  for (const Vec<dim> &direction : directions(normal))
    for (int k = kinds_[source].stands_in(); k < 2; ++k) {
      Set &set = sets_[k];
      int &index = set.of_node[node];
      if (index < 0) index = static_cast<int>(set.entry.size()), set.entry.push_back({});
      set.entry[index].add(direction, source);
    }
}

template <int dim>
size_t PrescribedMotion<dim>::reserve() {
  active_.reserve(sets_[1].entry.size());
  return sets_[1].entry.size();
}

template <int dim>
void PrescribedMotion<dim>::begin(const FilledGrid<dim> &grid, bool stand_ins) {
  active_.clear();
  const Set &set = sets_[stand_ins];
  for (int i = 0; i < grid.node_count(); ++i) {
    const int index = set.of_node[grid.mesh_node[i]];
    if (index >= 0) active_.push_back({i, &set.entry[index], {}});
  }
}

template <int dim>
auto PrescribedMotion<dim>::find(int node) -> Active * {
  const auto found =
      std::lower_bound(active_.begin(), active_.end(), node, [](const Active &p, int of) { return p.node < of; });
  return found != active_.end() && found->node == node ? &*found : nullptr;
}

template <int dim>
void PrescribedMotion<dim>::impose(const Active &p, int k, double t, const Vec<dim> &x, Vec<dim> &v) const {
  const Vec<dim> &direction = p.condition->direction[k];
  const auto &speed = kinds_[p.condition->source[k]].template on_soil<dim>().speed;
  const double target = speed ? speed(direction, x, t) : 0;
  add_scaled<dim>(v, target - dot<dim>(v, direction), direction);
}

template class PrescribedMotion<2>;
template class PrescribedMotion<3>;

}  // namespace talus
