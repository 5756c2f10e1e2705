#include "physics/structures/structures_in_motion.h"

#include <algorithm>
#include <cmath>

#include "physics/structures/placed_points.h"

namespace talus {

template <int dim>
void StructuresInMotion<dim>::begin(const FilledGrid<dim> &grid) {
  std::vector<Vec<dim>> points;
  std::vector<std::pair<int, int>> of;  // bar and point
  std::vector<Bar<dim>> &bars = structures_.bars();
  first_.assign(1, 0);
  for (std::size_t b = 0; b < bars.size(); ++b) {
    first_.push_back(first_.back() + bars[b].points());
    if (!resumes_) bars[b].part_place = bars[b].now;
    for (int i = 0; bars[b].present && i < bars[b].points(); ++i)
      points.push_back(bars[b].part_place[i]), of.emplace_back(static_cast<int>(b), i);
  }
  resumes_ = false, seen_ = structures_.changes();
  std::vector<char> found;
  const std::vector<int> cells(grid.mesh_cell.begin(), grid.mesh_cell.begin() + grid.cell_count());
  places_.clear();
  for (const PlacedPoint<dim> &one : place_points<dim>(mesh_, cells, points, &found)) {
    const int cell = grid.find_cell(one.cell);
    places_.push_back({of[one.point].first, of[one.point].second, cell, grid.shape[cell].node, one.coordinate});
  }
  for (std::size_t k = 0; k < of.size(); ++k) bars[of[k].first].in_soil[of[k].second] = found[k];
  for (Bar<dim> &bar : bars)
    if (bar.present) bar.find_absent();
}

template <int dim>
void StructuresInMotion<dim>::add_force(const FilledGrid<dim> &grid, const StressOf &stress, Vec<dim> *force) {
  if (seen_ != structures_.changes()) begin(grid);  // structures have come or gone since
  for (Place &place : places_) {
    const Bar<dim> &bar = structures_.bars()[place.bar];
    Vec<dim> sum{};
    if (place.point > 0)
      add_scaled<dim>(sum, -bar.chain.committed_force(place.point - 1), bar.along(place.point - 1, bar.now));
    if (place.point < bar.elements())
      add_scaled<dim>(sum, bar.chain.committed_force(place.point), bar.along(place.point, bar.now));
    for (int k = 0; k <= dim; ++k) add_scaled<dim>(force[place.node[k]], place.share[k], sum);
    if (bar.rubs())
      place.normal_stress = bar.normal_stress(bar.along_at(place.point, bar.now), stress(place.cell), structures_.up());
  }
}

template <int dim>
void StructuresInMotion<dim>::advance(const FilledGrid<dim> &grid, const Vec<dim> *u, double step) {
  constexpr int width = dim + 2;  // way, normal stress, mobility [1/kg]
  // (omega step)^2 = 1 of a bar alone, whose elements share their nodes with up to four others: a soil at 0.86 of its
  // own critical step is stable with it
  constexpr double most_mobile = 20;
  std::vector<double> sums(first_.back() * width, 0);
  for (const Place &place : places_) {
    double *sum = &sums[(first_[place.bar] + place.point) * width];
    for (int k = 0; k <= dim; ++k) {
      for (int d = 0; d < dim; ++d) sum[d] += place.share[k] * u[place.node[k]][d];
      if (grid.mass[place.node[k]] > 0) sum[dim + 1] += place.share[k] * place.share[k] / grid.mass[place.node[k]];
    }
    sum[dim] = place.normal_stress;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm());
  std::vector<double> stretch;
  for (std::size_t b = 0; b < structures_.bars().size(); ++b) {
    Bar<dim> &bar = structures_.bars()[b];
    if (!bar.present) continue;
    const double *sum = &sums[first_[b] * width];
    stretch.assign(bar.elements(), 0);
    for (int e = 0; e < bar.elements(); ++e) stretch[e] = -bar.length_now(e);
    for (int i = 0; i < bar.points(); ++i) {
      for (int d = 0; d < dim; ++d) bar.now[i][d] += sum[i * width + d];
      bar.set_bond(i, sum[i * width + dim], true);
    }
    for (int e = 0; e < bar.elements(); ++e) {
      BarElement &one = bar.chain.element[e];
      stretch[e] = one.absent ? 0 : stretch[e] + bar.length_now(e);
      const double mobility = std::max(sum[e * width + dim + 1], sum[(e + 1) * width + dim + 1]);
      const double own = bar.share * bar.keys.axial_stiffness / one.length;
      one.stiffness = mobility > 0 ? std::min(own, 1 / (most_mobile * step * step * mobility)) : own;
      bar.softened = std::min(bar.softened, one.stiffness / own);
    }
    bar.chain.deform(stretch);
    if (bar.keys.rupture_strain > 0)
      for (int e; (e = bar.chain.to_tear(bar.keys.rupture_strain)) >= 0;) bar.chain.element[e].torn = 1;
    bar.chain.commit();
    for (BarElement &one : bar.chain.element) one.stiffness = bar.share * bar.keys.axial_stiffness / one.length;
  }
}

template class StructuresInMotion<2>;
template class StructuresInMotion<3>;

}  // namespace talus
