/// The average of plastic strain over a length, on the unit square and cube with shifted nodes.
#include "transfer/nonlocal_strain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "box_mesh.h"

namespace talus {
namespace {

using test::BoxMesh;
using test::SharedFile;
using test::sum;

/// One point in each cell, with strain as its only history.
template <int dim>
struct Filled {
  Filled(int n, double length)
      : file(BoxMesh(dim, n)),
        mesh(BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file.name(), {})),
        grid(mesh),
        nonlocal(mesh, length, 0, 1) {
    for (int c = 0; c < mesh.cell_count(); ++c) {
      cell.push_back(grid.enter_cell(c)), volume.push_back(mesh.volume[c]), strain.push_back(0);
      Vec<dim> centre{};
      for (int i : mesh.cells[c].node)
        for (int d = 0; d < dim; ++d) centre[d] += mesh.position[i][d] / (dim + 1);
      place.push_back(centre);
    }
    grid.complete();
    points.count = static_cast<int>(cell.size()), points.cell = cell.data();
    points.volume = volume.data(), points.history = strain.data();
  }
  template <class Function>
  void set(Function f) {
    for (std::size_t q = 0; q < strain.size(); ++q) strain[q] = f(place[q]);
  }
  std::vector<double> averages() {
    std::vector<double> seen = strain;
    for (std::size_t q = 0; q < seen.size(); ++q) seen[q] += nonlocal.excess()[q];
    return seen;
  }

  SharedFile file;
  BackgroundMesh<dim> mesh;
  FilledGrid<dim> grid;
  NonlocalStrain<dim> nonlocal;
  std::vector<int> cell;
  std::vector<double> volume, strain;
  std::vector<Vec<dim>> place;
  PointSet points;
};

/// Root mean square of a - b, weighted by volume.
double distance(const std::vector<double> &a, const std::vector<double> &b, const std::vector<double> &volume) {
  double square = 0, all = 0;
  for (std::size_t q = 0; q < a.size(); ++q) square += volume[q] * (a[q] - b[q]) * (a[q] - b[q]), all += volume[q];
  return std::sqrt(sum(square) / sum(all));
}

/// cos(pi x) has no flux at x = 0 and 1: its average is cos(pi x) / (1 + pi^2 l^2).
template <int dim>
double error_of_cosine(int n) {
  constexpr double length = 0.3, pi = std::numbers::pi;
  Filled<dim> box(n, length);
  box.set([](const Vec<dim> &x) { return 1 + std::cos(pi * x[0]); });
  EXPECT_EQ(box.nonlocal.begin(box.grid, box.points), 0);
  std::vector<double> exact;
  for (const auto &x : box.place) exact.push_back(1 + std::cos(pi * x[0]) / (1 + pi * pi * length * length));
  return distance(box.averages(), exact, box.volume);
}

TEST(NonlocalStrain, converges_at_second_order_in_the_plane) {
  const double coarse = error_of_cosine<2>(8), middle = error_of_cosine<2>(16), fine = error_of_cosine<2>(32);
  EXPECT_LT(fine, 2e-3);
  EXPECT_GT(std::log2(coarse / middle), 1.7);
  EXPECT_GT(std::log2(middle / fine), 1.8);
}
TEST(NonlocalStrain, converges_at_second_order_in_space) {
  EXPECT_GT(std::log2(error_of_cosine<3>(5) / error_of_cosine<3>(10)), 1.6);
}

/// The average moves strain, it makes none; uniform strain stays.
TEST(NonlocalStrain, keeps_the_sum_of_the_strain) {
  Filled<2> box(12, 0.2);
  box.set([](const Vec<2> &x) { return x[0] > 0.4 && x[0] < 0.5 ? 1 + x[1] : 0.; });
  EXPECT_EQ(box.nonlocal.begin(box.grid, box.points), 0);
  const auto average = box.averages();
  double gain = 0;
  for (std::size_t q = 0; q < average.size(); ++q) gain += box.volume[q] * (average[q] - box.strain[q]);
  EXPECT_NEAR(sum(gain), 0, 1e-8);
  box.set([](const Vec<2> &) { return 0.25; });
  EXPECT_EQ(box.nonlocal.begin(box.grid, box.points), 0);
  for (const double a : box.averages()) EXPECT_NEAR(a, 0.25, 1e-8);
}

TEST(NonlocalStrain, follows_a_change_and_halves_what_is_left_of_it) {
  Filled<2> box(16, 0.25), aim(16, 0.25);
  const auto band = [](const Vec<2> &x) { return x[1] < 0.3 ? 0.1 : 0.; };
  EXPECT_EQ(box.nonlocal.begin(box.grid, box.points), 0);
  aim.set(band);
  EXPECT_EQ(aim.nonlocal.begin(aim.grid, aim.points), 0);
  box.set(band);
  const auto wanted = aim.averages();
  double left = distance(std::vector<double>(wanted.size(), 0.), wanted, box.volume);
  for (int step = 0; step < 10; ++step) {
    EXPECT_EQ(box.nonlocal.update(box.grid, box.points), 0);
    const double now = distance(box.averages(), wanted, box.volume);
    EXPECT_LT(now, 0.55 * left);
    left = now;
  }
}

/// Soil of another body takes no part, though its cells are in the grid.
TEST(NonlocalStrain, stays_within_its_body) {
  Filled<2> box(16, 0.25), alone(16, 0.25);
  const auto band = [](const Vec<2> &x) { return x[0] < 0.1 ? 0.1 : 0.; };
  box.set(band), alone.set(band);
  int kept = 0;  // the points of x < 0.5 come first
  for (int q = 0; q < alone.points.count; ++q)
    if (alone.place[q][0] < 0.5) {
      alone.cell[kept] = alone.cell[q], alone.volume[kept] = alone.volume[q], alone.strain[kept] = alone.strain[q];
      alone.place[kept++] = alone.place[q];
    }
  alone.points.count = kept;
  EXPECT_EQ(box.nonlocal.begin(box.grid, box.points), 0);
  EXPECT_EQ(alone.nonlocal.begin(alone.grid, alone.points), 0);
  double within[2]{}, had[2]{};
  const auto all = box.averages(), part = alone.averages();
  for (std::size_t q = 0; q < all.size(); ++q)
    if (box.place[q][0] < 0.5) within[0] += box.volume[q] * all[q], had[0] += box.volume[q] * box.strain[q];
  for (int q = 0; q < kept; ++q) within[1] += alone.volume[q] * part[q], had[1] += alone.volume[q] * alone.strain[q];
  EXPECT_LT(sum(within[0]), 0.95 * sum(had[0]));
  EXPECT_NEAR(sum(within[1]), sum(had[1]), 1e-8);
}

/// Strain on a line is spread as exp(-|x| / l) / (2 l): it has the peak of a band of the width 2 l, which is what
/// softening takes for the size of a cell.
TEST(NonlocalStrain, has_a_band_of_twice_the_length) {
  constexpr double length = 0.1;
  const int n = 64;
  Filled<2> box(n, length);
  box.set([](const Vec<2> &x) { return x[0] > 0.5 && x[0] < 0.5 + 1. / n ? 1 : 0.; });
  EXPECT_EQ(box.nonlocal.begin(box.grid, box.points), 0);
  const auto average = box.averages();
  double total = 0, peak = 0;
  for (std::size_t q = 0; q < average.size(); ++q)
    total += box.volume[q] * box.strain[q], peak = std::max(peak, average[q]);
  MPI_Allreduce(MPI_IN_PLACE, &peak, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  // the sides of the square are 5 l away and reflect exp(-10); means over cells of l / 6 lower the peak by some percent
  EXPECT_NEAR(sum(total) / peak, 2 * length, 0.3 * length);
  for (int c = 0; c < box.mesh.cell_count(); ++c) EXPECT_EQ(box.nonlocal.size()[c], 2 * length);
}

}  // namespace
}  // namespace talus
