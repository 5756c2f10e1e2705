#include "simulation/point_rows.h"

#include <cmath>
#include <limits>
#include <optional>

#include "simulation/output_fields.h"

namespace talus {

template <int dim>
std::vector<std::pair<std::string, std::string>> PointRows<dim>::columns() const {
  auto columns = output_fields<ParticleState<dim>>(world_.phases, world_.bodies).tracked();
  columns.emplace_back("acceleration", "m/s2");
  return columns;
}

template <int dim>
std::vector<double> PointRows<dim>::at(double time, const Statics<dim> &statics) {
  const auto fields = output_fields<ParticleState<dim>>(world_.phases, world_.bodies);
  const std::size_t count = points_.all().size();
  std::vector<double> found;  // of each point: its fields, its velocity, and on how many ranks it is
  for (auto &point : points_.all()) {
    std::optional<ParticleState<dim>> state;
    if (!world_.present[point.body])
      state = std::nullopt;  // also in stages by finite elements, which would give the nearest soil there is
    else if (statics.current())
      state = statics.state_at(point.place);
    else if (const int i = points_.find(point); i >= 0)
      state.emplace(world_.phases, *world_.motion, *world_.bodies[point.body], point.body, i);
    fields.append_tracked(state ? &*state : nullptr, found);
    const Vec<dim> velocity = state ? state->velocity : Vec<dim>{};
    found.insert(found.end(), velocity.begin(), velocity.end());
    found.push_back(state ? 1 : 0);
  }
  MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(found.size()), MPI_DOUBLE, MPI_SUM, world_.comm);
  velocities_.resize(count * dim), earlier_.resize(count * dim);
  // a row that follows soon on another one, as at the end of a stage, counts from the row before that
  const bool soon = rows_ > 1 && time - time_ < 0.5 * (time_ - earlier_time_);
  const std::vector<double> before = soon ? earlier_ : velocities_;
  const double elapsed = rows_ == 0 || statics.current() ? 0 : time - (soon ? earlier_time_ : time_);
  if (!soon) earlier_ = velocities_, earlier_time_ = time_;
  rows_ = statics.current() ? 1 : rows_ + 1, time_ = time;
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
      const double change = velocity[d] - before[i * dim + d];
      square += change * change, velocities_[i * dim + d] = velocity[d];
    }
    row.push_back(!there ? nan : elapsed > 0 ? std::sqrt(square) / elapsed : 0);
  }
  return row;
}

template class PointRows<2>;
template class PointRows<3>;

}  // namespace talus
