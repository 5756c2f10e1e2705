#include <algorithm>
#include <map>
#include <sstream>
#include <stdexcept>

#include "meshes/locate.h"
#include "particles/body.h"
#include "physics/laws/strength_by_place.h"
#include "scene/body_source.h"

namespace talus {
namespace {

/// Orbits of the symmetry group of a simplex: `a` at one vertex, `b` at the others.
template <int dim>
void add_orbit(std::vector<std::array<double, dim + 1>> &points, double a, double b) {
  for (int k = 0; k <= dim; ++k) {
    std::array<double, dim + 1> n;
    n.fill(b), n[k] = a;
    points.push_back(n);
  }
}

/// Centroids of the upright sub-triangles (and, with `inverted`, of all) of a triangle cut into k by k.
void add_triangle_lattice(std::vector<std::array<double, 3>> &points, int k, bool inverted) {
  for (int i = 0; i < k; ++i)
    for (int j = 0; i + j < k; ++j) {
      points.push_back({(i + 1. / 3) / k, (j + 1. / 3) / k, 1 - (i + j + 2. / 3) / k});
      if (inverted && i + j < k - 1) points.push_back({(i + 2. / 3) / k, (j + 2. / 3) / k, 1 - (i + j + 4. / 3) / k});
    }
}

std::vector<std::array<double, 3>> triangle_lattice(int n) {
  std::vector<std::array<double, 3>> points;
  for (int k = 1; k * k <= n; ++k)
    if (k * k == n) add_triangle_lattice(points, k, true);
  for (int k = 2; k * (k + 1) / 2 <= n; ++k)
    if (k * (k + 1) / 2 == n) add_triangle_lattice(points, k, false);
  if (n == 12) {  // the three Gauss points in each of four congruent sub-triangles
    const auto gauss = triangle_lattice(3);
    const std::array<double, 3> corner[3]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        middle[3]{{0, .5, .5}, {.5, 0, .5}, {.5, .5, 0}};
    const auto put = [&](const std::array<double, 3> &a, const std::array<double, 3> &b,
                         const std::array<double, 3> &c) {
      for (const auto &g : gauss) {
        std::array<double, 3> p;
        for (int k = 0; k < 3; ++k) p[k] = g[0] * a[k] + g[1] * b[k] + g[2] * c[k];
        points.push_back(p);
      }
    };
    for (int k = 0; k < 3; ++k) put(corner[k], middle[(k + 2) % 3], middle[(k + 1) % 3]);
    put(middle[0], middle[1], middle[2]);
  }
  return points;
}

std::vector<std::array<double, 4>> tetrahedron_lattice(int n) {
  std::vector<std::array<double, 4>> points;
  if (n == 4) {  // Gauss points of second order
    add_orbit<3>(points, (5 + 3 * std::sqrt(5.)) / 20, (5 - std::sqrt(5.)) / 20);
    return points;
  }
  if (n == 8) {
    add_orbit<3>(points, 5. / 8, 1. / 8);
    add_orbit<3>(points, 1. / 8, 7. / 24);
    return points;
  }
  for (int k = 1; k * (k + 1) * (k + 2) / 6 <= n; ++k)
    if (k * (k + 1) * (k + 2) / 6 == n)
      for (int a = 0; a < k; ++a)
        for (int b = 0; a + b < k; ++b)
          for (int c = 0; a + b + c < k; ++c) {
            const double x = (a + .25) / k, y = (b + .25) / k, z = (c + .25) / k;
            points.push_back({x, y, z, 1 - x - y - z});
          }
  return points;
}

template <int dim>
double value(const Function &f, const Vec<dim> &x, double t = 0) {
  return f(x[0], x[1], dim == 3 ? x[2] : 0, t);
}

template <int dim>
bool inside(const DenseBox &box, const Vec<dim> &x) {
  for (int d = 0; d < dim; ++d)
    if (x[d] < box.from[d] || x[d] > box.to[d]) return false;
  return true;
}

}  // namespace

template <int dim>
Square<dim> displacement_gradient(const std::vector<Function> &displacement, const Vec<dim> &x, double h) {
  Square<dim> f = Square<dim>::Identity();
  for (int j = 0; j < dim; ++j) {
    Vec<dim> a = x, b = x;
    a[j] -= h, b[j] += h;
    for (int i = 0; i < dim; ++i)
      f(i, j) += (value<dim>(displacement[i], b) - value<dim>(displacement[i], a)) / (2 * h);
  }
  return f;
}
template Square<2> displacement_gradient<2>(const std::vector<Function> &, const Vec<2> &, double);
template Square<3> displacement_gradient<3>(const std::vector<Function> &, const Vec<3> &, double);

template <>
std::vector<std::array<double, 3>> lattice<2>(int n) {
  return triangle_lattice(n);
}
template <>
std::vector<std::array<double, 4>> lattice<3>(int n) {
  return tetrahedron_lattice(n);
}

template <int dim>
void seed(Body<dim> &body, const BackgroundMesh<dim> &mesh, int id_stride,
          const std::function<double(const Vec<dim> &)> &density) {
  const BodySource &source = body.source();
  std::map<int, std::vector<std::array<double, dim + 1>>> lattices;
  const auto points_in = [&](int cell) -> const std::vector<std::array<double, dim + 1>> & {
    Vec<dim> centre{};
    for (int node : mesh.cells[cell].node)
      for (int d = 0; d < dim; ++d) centre[d] += mesh.position[node][d] / (dim + 1);
    int n = particles_per_cell<dim>(source);
    for (const DenseBox &box : source.dense)
      if (inside<dim>(box, centre)) n = box.particles_per_cell;
    auto &points = lattices[n];
    if (points.empty()) points = lattice<dim>(n);
    return points;
  };
  std::vector<int> cells;
  for (const std::string &region : source.region) {
    const std::vector<int> more = mesh.region(region);
    cells.insert(cells.end(), more.begin(), more.end());
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());  // regions may share cells
  PetscInt count = 0;
  for (int cell : cells) count += static_cast<PetscInt>(points_in(cell).size());
  PetscCallVoid(body.resize(count));

  ParticleArrays<dim> &p = body.particles();
  const StrengthByPlace strength(source.law, body.law());
  int i = 0;
  for (int cell : cells) {
    const auto &points = points_in(cell);
    for (size_t k = 0; k < points.size(); ++k, ++i) {
      Vec<dim> x{};
      for (int a = 0; a <= dim; ++a)
        for (int d = 0; d < dim; ++d) x[d] += points[k][a] * mesh.position[mesh.cells[cell].node[a]][d];
      p.reference[i] = p.position[i] = x;
      p.cell[i] = cell;
      p.id[i] =
          static_cast<PetscInt>(mesh.global_cell[cell % mesh.cells_in_sheet()] * id_stride + static_cast<long long>(k));
      p.volume[i] = mesh.volume[cell] / static_cast<double>(points.size());
      p.mass[i] = density(x) * p.volume[i];
      for (int d = 0; d < dim; ++d) p.velocity[i][d] = source.velocity.empty() ? 0 : value<dim>(source.velocity[d], x);
      for (int s = 0; s < stress_size<dim>; ++s)
        p.stress[i * stress_size<dim> + s] = source.stress.empty() ? 0 : value<dim>(source.stress[s], x);
      for (int h = 0; h < body.history_count(); ++h) p.history[i * body.history_count() + h] = 0;
      if (p.cohesion_share) {
        const auto shares = strength.shares(body.law(), x[0], x[1], dim == 3 ? x[dim - 1] : 0);
        p.cohesion_share[i] = shares.cohesion, p.friction_share[i] = shares.friction;
      }
      if (!source.displacement.empty()) {
        p.volume[i] *=
            displacement_gradient<dim>(source.displacement, x, 1e-5 * mesh.mean_edge[mesh.cells[cell].node[0]])
                .determinant();
        for (int d = 0; d < dim; ++d) p.position[i][d] += value<dim>(source.displacement[d], x);
      }
      p.initial_volume[i] = p.volume[i];
      body.refer_to_stress(i);
    }
  }
}

template <int dim>
int particles_per_cell(const BodySource &source) {
  return source.particles_per_cell > 0 ? source.particles_per_cell : dim == 2 ? 3 : 4;
}

template int particles_per_cell<2>(const BodySource &);
template int particles_per_cell<3>(const BodySource &);
template void seed<2>(Body<2> &, const BackgroundMesh<2> &, int, const std::function<double(const Vec<2> &)> &);
template void seed<3>(Body<3> &, const BackgroundMesh<3> &, int, const std::function<double(const Vec<3> &)> &);

}  // namespace talus
