#include "simulation/gap_walls.h"

#include <algorithm>
#include <cmath>

#include "base/rounded.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {
namespace {

/// A face of the soil that a pressure loads.
template <int dim>
struct Wall {
  Vec<dim> middle, normal;
};

/// How far away a face of the soil lies that a line from the middle of a wall along its normal meets [m]; negative:
/// none does. The face looks back.
template <int dim>
double distance_to(const SoilFace &face, const Wall<dim> &wall) {
  constexpr double opposite = -0.7;  // product of the normals
  double facing = 0, ahead = 0;
  for (int d = 0; d < dim; ++d) {
    facing += face.normal[d] * wall.normal[d];
    ahead += face.normal[d] * (face.corner[0][d] - wall.middle[d]);
  }
  if (facing > opposite) return -1;
  const double far = ahead / facing;
  Square<dim> edges;  // of the face from its first corner, and its normal
  ColumnVector<dim> hit;
  for (int d = 0; d < dim; ++d) {
    for (int a = 1; a < dim; ++a) edges(d, a - 1) = face.corner[a][d] - face.corner[0][d];
    edges(d, dim - 1) = face.normal[d];
    hit[d] = wall.middle[d] + far * wall.normal[d] - face.corner[0][d];
  }
  const ColumnVector<dim> share = edges.inverse() * hit;
  double sum = 0;
  for (int a = 0; a < dim - 1; ++a) {
    if (share[a] < 0) return -1;
    sum += share[a];
  }
  return sum <= 1 ? far : -1;
}

}  // namespace

template <int dim>
void check_gap_walls(const World<dim> &world) {
  constexpr double narrow = 0.5;  // width over the size of the loaded faces
  const BackgroundMesh<dim> &mesh = world.mesh;
  const auto presses = [](const NamedBoundary &source) {
    return source.kind.quasi_static == OnSoil::load && source.kind.follows;
  };
  if (std::ranges::none_of(world.conditions.sources(), presses)) return;
  const std::vector<int> body_of = bodies_of_cells(mesh, world.scene);
  const std::vector<char> there = world.present_at_start();
  const auto has_soil = [&](int cell) { return body_of[cell] >= 0 && there[body_of[cell]]; };
  const std::vector<SoilFace> surface = world.surface();
  for (const NamedBoundary &source : world.conditions.sources()) {
    if (!presses(source)) continue;
    std::vector<Wall<dim>> walls;
    double box[2 * dim];  // lowest and minus highest
    std::fill_n(box, 2 * dim, 1e300);
    for (const std::string &group : source.groups)
      for (const Facet<dim> &facet : mesh.facets(group)) {
        const int across = mesh.cells[facet.cell].neighbour[facet.face];
        if (!has_soil(facet.cell) || (across >= 0 && has_soil(across)) || across < boundary) continue;
        Wall<dim> &wall = walls.emplace_back(Wall<dim>{{}, facet.normal});
        for (const int node : facet.node)
          for (int d = 0; d < dim; ++d) {
            const double x = mesh.position[node][d];
            wall.middle[d] += x / dim, box[d] = std::min(box[d], x), box[dim + d] = std::min(box[dim + d], -x);
          }
      }
    MPI_Allreduce(MPI_IN_PLACE, box, 2 * dim, MPI_DOUBLE, MPI_MIN, world.comm);
    double size = 0;
    for (int d = 0; d < dim; ++d) size = std::max(size, -box[d] - box[dim + d]);
    std::string where;
    for (const Wall<dim> &wall : walls) {
      double nearest = narrow * size;
      bool bare = false;
      for (const SoilFace &face : surface)
        if (std::abs(face.corner[0][0] - wall.middle[0]) < 2 * size)
          if (const double far = distance_to<dim>(face, wall); far > 0 && far < nearest)
            nearest = far, bare = !face.bounded;
      if (!bare || !where.empty()) continue;
      for (int d = 0; d < dim; ++d) where += (d ? ", " : "(") + rounded(wall.middle[d]);
      where += ") m, and the wall opposite, " + rounded(nearest) + " m away";
    }
    where = text_of_first(world.comm, !where.empty(), where);
    if (!where.empty())
      world.scene.complain(
          "boundary." + source.name + ".group",
          "loads one wall of a gap at " + where +
              ", has no load: what fills a crack presses on both. Give the boundary the facets of both "
              "walls");
  }
}

template void check_gap_walls(const World<2> &);
template void check_gap_walls(const World<3> &);

}  // namespace talus
