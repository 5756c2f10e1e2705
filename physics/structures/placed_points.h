#pragma once
/// The cells in which points of structures lie.
#include <algorithm>
#include <limits>
#include <tuple>
#include <vector>

#include "meshes/locate.h"

namespace talus {

/// A point whose cell is on this rank.
template <int dim>
struct PlacedPoint {
  int point, cell;                         ///< cell of the mesh
  std::array<double, dim + 1> coordinate;  ///< barycentric, none below zero
};

/// Finds the points in `cells` (local numbers). A point beside them by less than a fifth of a cell, as on a slope that
/// is drawn less exactly, lies in the nearest; one between cells in that which comes first in the file, on whatever
/// rank. `found` says of each point whether some rank has it. Collective.
template <int dim>
std::vector<PlacedPoint<dim>> place_points(const BackgroundMesh<dim> &mesh, const std::vector<int> &cells,
                                           const std::vector<Vec<dim>> &points, std::vector<char> *found) {
  constexpr double beside = 0.2, inside = -1e-9;
  constexpr long long nobody = std::numeric_limits<long long>::max();
  const int count = static_cast<int>(points.size());
  std::vector<int> by_x(count);
  for (int k = 0; k < count; ++k) by_x[k] = k;
  std::sort(by_x.begin(), by_x.end(),
            [&](int a, int b) { return std::tie(points[a][0], a) < std::tie(points[b][0], b); });
  std::vector<double> best(count, -std::numeric_limits<double>::infinity());  // inside is as good as deep inside
  std::vector<PlacedPoint<dim>> candidate(count, PlacedPoint<dim>{0, -1, {}});
  for (const int c : cells) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const int node : mesh.cells[c].node)
      low = std::min(low, mesh.position[node][0]), high = std::max(high, mesh.position[node][0]);
    const double margin = beside * (high - low);
    auto one =
        std::lower_bound(by_x.begin(), by_x.end(), low - margin, [&](int a, double x) { return points[a][0] < x; });
    for (; one != by_x.end() && points[*one][0] <= high + margin; ++one) {
      const auto l = barycentric<dim>(mesh.cells[c], points[*one]);
      const double least = *std::min_element(l.begin(), l.end()), depth = least >= inside ? 1 : least;
      PlacedPoint<dim> &last = candidate[*one];
      const bool better =
          depth > best[*one] || (depth == best[*one] && mesh.global_cell[c] < mesh.global_cell[last.cell]);
      if (depth < -beside || !better) continue;
      best[*one] = depth, last = {*one, c, l};
    }
  }
  std::vector<double> of_all = best;
  MPI_Allreduce(MPI_IN_PLACE, of_all.data(), count, MPI_DOUBLE, MPI_MAX, mesh.comm());
  std::vector<long long> owner(count, nobody);
  for (int k = 0; k < count; ++k)
    if (candidate[k].cell >= 0 && best[k] == of_all[k]) owner[k] = mesh.global_cell[candidate[k].cell];
  std::vector<long long> first = owner;
  MPI_Allreduce(MPI_IN_PLACE, first.data(), count, MPI_LONG_LONG, MPI_MIN, mesh.comm());
  std::vector<PlacedPoint<dim>> mine;
  found->assign(count, 0);
  for (int k = 0; k < count; ++k) {
    (*found)[k] = first[k] != nobody;
    if (owner[k] == nobody || owner[k] != first[k]) continue;
    PlacedPoint<dim> &one = mine.emplace_back(candidate[k]);
    double sum = 0;
    for (double &share : one.coordinate) share = std::max(0., share), sum += share;
    for (double &share : one.coordinate) share /= sum;
  }
  return mine;
}

}  // namespace talus
