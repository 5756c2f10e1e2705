#include "simulation/tracked_points.h"

#include <limits>

namespace talus {

template <int dim>
TrackedPoints<dim>::TrackedPoints(const World<dim> &world) : world_(world) {
  for (const OutputPoint &wanted : world_.scene.output.point) {
    Point point{wanted.name};
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t b = 0; b < world_.bodies.size(); ++b) {
      const ParticleArrays<dim> &p = world_.bodies[b]->particles();
      for (int i = 0; i < p.count; ++i) {
        double distance = 0;
        for (int d = 0; d < dim; ++d)
          distance += (p.position[i][d] - wanted.position[d]) * (p.position[i][d] - wanted.position[d]);
        if (distance < nearest * (1 - 1e-9) || (distance <= nearest * (1 + 1e-9) && p.id[i] < point.id))
          nearest = distance, point.body = static_cast<int>(b), point.id = p.id[i];
      }
    }
    // the same particle whatever the partition: nearest, then smallest number
    double best;
    MPI_Allreduce(&nearest, &best, 1, MPI_DOUBLE, MPI_MIN, world_.comm);
    const bool candidate = nearest <= best * (1 + 1e-9);
    long long id = candidate ? point.id : std::numeric_limits<long long>::max(), winner;
    MPI_Allreduce(&id, &winner, 1, MPI_LONG_LONG, MPI_MIN, world_.comm);
    int body = candidate && point.id == winner ? point.body : -1;
    MPI_Allreduce(MPI_IN_PLACE, &body, 1, MPI_INT, MPI_MAX, world_.comm);
    point.id = static_cast<PetscInt>(winner), point.body = body;
    points_.push_back(point);
  }
}

template <int dim>
int TrackedPoints<dim>::find(Point &point) const {
  const ParticleArrays<dim> &p = world_.bodies[point.body]->particles();
  if (point.index >= 0 && point.index < p.count && p.id[point.index] == point.id) return point.index;
  point.index = -1;
  for (int i = 0; i < p.count; ++i)
    if (p.id[i] == point.id) point.index = i;
  return point.index;
}

template <int dim>
double TrackedPoints<dim>::speed(const std::string &name) {
  for (Point &point : points_)
    if (point.name == name) {
      const int i = find(point);
      if (i < 0) continue;
      Vec<dim> x, v;
      world_.motion->present(*world_.bodies[point.body], i, &x, &v);
      return map<dim>(v).norm();
    }
  return -1;
}

template class TrackedPoints<2>;
template class TrackedPoints<3>;

}  // namespace talus
