#include "simulation/tracked_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "scene/output_source.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {

namespace {

/// To the millimetre: places on a map have seven digits before it.
std::string coordinate(double x) {
  std::ostringstream text;
  text.precision(12);
  text << std::round(1e3 * x) / 1e3 + 0.0;  // no -0
  return text.str();
}

std::string in_words(const double *x, int count) {
  std::string text;
  for (int d = 0; d < count; ++d) text += (d ? ", " : "(") + coordinate(x[d]);
  return text + ") m";
}

}  // namespace

template <int dim>
TrackedPoints<dim>::TrackedPoints(const World<dim> &world, std::array<double, 2> corner) : world_(world) {
  const std::string on_map =
      corner == std::array<double, 2>{}
          ? ""
          : "; x and y count from the corner of the mesh, which is at " + in_words(corner.data(), 2) + " of the map";
  for (const OutputPoint &wanted : world_.scene.output->point) {
    Vec<dim> place;
    std::copy_n(wanted.position.begin(), dim, place.begin());
    const Found found = nearest_particle(wanted.name, place);
    if (!found.near_soil())
      world_.scene.complain("output.point." + wanted.name + ".position",
                            "must be in the soil or at its surface; the nearest particle is " +
                                rounded(found.distance) + " m away, in a cell of " + rounded(found.cell_size) + " m" +
                                on_map);
    points_.push_back(found.point);
    if (found.distance <= 0.5 * found.cell_size) continue;
    far_off_.push_back("output.point." + wanted.name + ": its position " + in_words(place.data(), dim) +
                       " has no particle within half a cell: the one that is followed, the nearest, lies at " +
                       in_words(found.at.data(), dim) + ", " + rounded(found.distance) + " m away, in a cell of " +
                       rounded(found.cell_size) + " m" + on_map);
  }
}

template <int dim>
TrackedPoints<dim>::TrackedPoints(const World<dim> &world, const std::vector<Vec<dim>> &places) : world_(world) {
  for (const Vec<dim> &place : places)
    if (const Found found = nearest_particle("", place); found.in_soil()) points_.push_back(found.point);
}

/// The same particle whatever the partition: nearest, then smallest number.
template <int dim>
typename TrackedPoints<dim>::Found TrackedPoints<dim>::nearest_particle(const std::string &name,
                                                                        const Vec<dim> &place) const {
  Point point{name, place};
  Vec<dim> at{};
  double nearest = std::numeric_limits<double>::infinity();
  double sizes[2] = {0, 0};  // of the cell of the nearest, and of its particles
  for (size_t b = 0; b < world_.bodies.size(); ++b) {
    const ParticleArrays<dim> &p = world_.bodies[b]->particles();
    for (int i = 0; i < p.count; ++i) {
      double distance = 0;
      for (int d = 0; d < dim; ++d) distance += (p.position[i][d] - place[d]) * (p.position[i][d] - place[d]);
      if (distance < nearest * (1 - 1e-9) || (distance <= nearest * (1 + 1e-9) && p.id[i] < point.id))
        nearest = distance, point.body = static_cast<int>(b), point.id = p.id[i],
        sizes[0] = std::pow(world_.mesh.volume[p.cell[i]], 1. / dim), sizes[1] = std::pow(p.volume[i], 1. / dim),
        at = p.position[i];
    }
  }
  double best;
  MPI_Allreduce(&nearest, &best, 1, MPI_DOUBLE, MPI_MIN, world_.comm);
  const bool candidate = nearest <= best * (1 + 1e-9);
  if (!candidate) sizes[0] = sizes[1] = 0;
  MPI_Allreduce(MPI_IN_PLACE, sizes, 2, MPI_DOUBLE, MPI_MAX, world_.comm);
  long long id = candidate ? point.id : std::numeric_limits<long long>::max(), winner;
  MPI_Allreduce(&id, &winner, 1, MPI_LONG_LONG, MPI_MIN, world_.comm);
  point.body = candidate && point.id == winner ? point.body : -1;
  MPI_Allreduce(MPI_IN_PLACE, &point.body, 1, MPI_INT, MPI_MAX, world_.comm);
  if (!candidate || point.id != winner) at.fill(std::numeric_limits<double>::lowest());
  MPI_Allreduce(MPI_IN_PLACE, at.data(), dim, MPI_DOUBLE, MPI_MAX, world_.comm);
  point.id = static_cast<PetscInt>(winner);
  return {point, at, std::sqrt(best), sizes[0], sizes[1]};
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
bool TrackedPoints<dim>::velocity(const std::string &name, Vec<3> *v) {
  for (Point &point : points_)
    if (point.name == name) {
      const int i = find(point);
      if (i < 0) continue;
      Vec<dim> x, mine;
      world_.motion->present(*world_.bodies[point.body], i, &x, &mine);
      v->fill(0);
      std::copy(mine.begin(), mine.end(), v->begin());
      return true;
    }
  return false;
}

template <int dim>
std::vector<std::string> TrackedPoints<dim>::without_soil() {
  std::vector<int> there;
  for (Point &point : points_) there.push_back(find(point) >= 0);
  MPI_Allreduce(MPI_IN_PLACE, there.data(), static_cast<int>(there.size()), MPI_INT, MPI_MAX, world_.comm);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (!there[k]) names.push_back(points_[k].name);
  return names;
}

template class TrackedPoints<2>;
template class TrackedPoints<3>;

}  // namespace talus
