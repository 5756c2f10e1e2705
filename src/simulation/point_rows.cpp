#include "simulation/point_rows.h"

#include <cmath>
#include <limits>
#include <optional>

#include "simulation/output_fields.h"

namespace talus {

template <int dim>
std::vector<std::string> PointRows<dim>::names(const std::string &prefix) const {
  auto names = output_fields<ParticleState<dim>>(world_.phases, world_.bodies).tracked_names(prefix);
  names.push_back(history_column(prefix + "acceleration", "m/s2"));
  return names;
}

template <int dim>
std::vector<double> PointRows<dim>::at(double time, const Statics<dim> &statics) {
  const auto fields = output_fields<ParticleState<dim>>(world_.phases, world_.bodies);
  const std::size_t count = points_.all().size();
  std::vector<double> found;  // of each point: its fields, its velocity, and on how many ranks it is
  for (auto &point : points_.all()) {
    std::optional<ParticleState<dim>> state;
    if (statics.current())
      state = statics.state_at(point.place);
    else if (const int i = points_.find(point); i >= 0)
      state.emplace(world_.phases, *world_.motion, *world_.bodies[point.body], point.body, i);
    fields.append_tracked(state ? &*state : nullptr, found);
    const Vec<dim> velocity = state ? state->velocity : Vec<dim>{};
    found.insert(found.end(), velocity.begin(), velocity.end());
    found.push_back(state ? 1 : 0);
  }
  MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(found.size()), MPI_DOUBLE, MPI_SUM, world_.comm);
  const double elapsed = velocities_.empty() || statics.current() ? 0 : time - time_;
  time_ = time, velocities_.resize(count * dim);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> row;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t width = found.size() / count;
    const double *of_point = &found[i * width], *velocity = of_point + (width - dim - 1);
    const bool there = of_point[width - 1] > 0;
    if (there)
      row.insert(row.end(), of_point, velocity);
    else
      row.insert(row.end(), width - dim - 1, nan);
    double square = 0;
    for (int d = 0; d < dim; ++d) {
      double &before = velocities_[i * dim + d];
      square += (velocity[d] - before) * (velocity[d] - before), before = velocity[d];
    }
    row.push_back(!there ? nan : elapsed > 0 ? std::sqrt(square) / elapsed : 0);
  }
  return row;
}

template class PointRows<2>;
template class PointRows<3>;

}  // namespace talus
