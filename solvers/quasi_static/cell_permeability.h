#pragma once
/// Relative permeability of a cell in which the pressure is linear, docs/theory/seepage.md (2.2).
#include <array>
#include <cmath>

#include "base/vec.h"
#include "physics/pores/mean_permeability.h"

namespace talus {

template <int dim>
struct CellPermeability {
  double value = 1;
  std::array<double, dim + 1> slope{};  ///< its derivative with the pressure of each vertex [1/Pa]
};

/// `pressure` of the vertices [Pa], `gradient` of their shape functions [1/m], `weight` of the water in a volume
/// [N/m3]. The permeability is the mean over the pressures of the cell as far as suction drives the water, and the mean
/// of the vertices as far as its weight does. Without `with_slope` there are no derivatives.
template <int dim>
CellPermeability<dim> cell_permeability(const SoilPores &soil, const MeanPermeability &mean,
                                        const std::array<double, dim + 1> &pressure,
                                        const std::array<Vec<dim>, dim + 1> &gradient, double weight, bool with_slope) {
  constexpr int corners = dim + 1;
  CellPermeability<dim> cell;
  std::array<double, corners> at, rise{};
  bool full = true;
  for (int a = 0; a < corners; ++a) at[a] = liquid_permeability_at(soil, pressure[a]), full &= pressure[a] >= 0;
  if (full && !with_slope) return cell;
  double vertices = 0;
  for (int a = 0; a < corners; ++a) {
    vertices += at[a] / corners;
    if (!with_slope) continue;
    const double step = 1e-6 * (std::abs(pressure[a]) + 10);
    rise[a] = (liquid_permeability_at(soil, pressure[a] + step) - liquid_permeability_at(soil, pressure[a] - step)) /
              (2 * step);
  }
  Vec<dim> drive{};
  for (int a = 0; a < corners; ++a)
    for (int d = 0; d < dim; ++d) drive[d] += pressure[a] * gradient[a][d];
  const double driven = map<dim>(drive).norm();
  // over the pressures: the mean along each edge, which counts by the square of the difference of its ends
  double sum = 0, squares = 0;
  std::array<double, corners> sum_rise{}, squares_rise{};
  for (int a = 0; a < corners; ++a)
    for (int b = a + 1; b < corners; ++b) {
      const double difference = pressure[a] - pressure[b], square = difference * difference;
      const double along = mean.between(pressure[a], at[a], pressure[b], at[b]);
      sum += along * square, squares += square;
      if (!with_slope) continue;
      sum_rise[a] += (at[a] + along) * difference, sum_rise[b] -= (at[b] + along) * difference;
      squares_rise[a] += 2 * difference, squares_rise[b] -= 2 * difference;
    }
  if (squares == 0 || driven == 0) {  // of equal pressures, or of pressures that differ by round-off
    cell.value = vertices;
    for (int a = 0; a < corners; ++a) cell.slope[a] = rise[a] / corners;
    return cell;
  }
  const double pressures = sum / squares, share = driven / (driven + weight);
  cell.value = share * pressures + (1 - share) * vertices;
  for (int a = 0; a < corners && with_slope; ++a) {
    double along = 0;
    for (int d = 0; d < dim; ++d) along += drive[d] * gradient[a][d];
    const double share_rise = weight / ((driven + weight) * (driven + weight)) * along / driven;
    cell.slope[a] = share * (sum_rise[a] - pressures * squares_rise[a]) / squares + (1 - share) * rise[a] / corners +
                    share_rise * (pressures - vertices);
  }
  return cell;
}

}  // namespace talus
