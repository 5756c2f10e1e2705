#pragma once
/// Mean stress of the cells, whose divergence moves the nodes, docs/theory (3.6).
#include <array>
#include <vector>

#include "physics/soil_motion/patch_means.h"
#include "physics/soil_motion/soil_state.h"
#include "scene/scene.h"

namespace talus {

enum class Locking;

template <int dim>
class CellStress {
 public:
  explicit CellStress(int cells) { make_room(mean_, cells); }

  /// Means of `stress` [body][point][stress_size] over the points of a state, weighted by their volumes, and of its
  /// pressure over patches, (4.7).
  void find(const FilledGrid<dim> &grid, const std::vector<PointSet> &points, const std::vector<double *> &stress,
            const SoilState<dim> &state, Locking locking, PatchMeans &patches);
  /// Forces of a cell on its nodes [N].
  std::array<Vec<dim>, dim + 1> forces(int cell, const SoilState<dim> &state) const {
    const auto &s = mean_[cell];
    const double w = state.weight[cell];
    std::array<Vec<dim>, dim + 1> force{};
    for (int k = 0; k < dim; ++k) {
      const Vec<dim> &g = state.shape[cell].gradient[k];
      Vec<dim> f;
      if constexpr (dim == 2)
        f = {w * (s[0] * g[0] + s[3] * g[1]), w * (s[3] * g[0] + s[1] * g[1])};
      else
        f = {w * (s[0] * g[0] + s[3] * g[1] + s[5] * g[2]), w * (s[3] * g[0] + s[1] * g[1] + s[4] * g[2]),
             w * (s[5] * g[0] + s[4] * g[1] + s[2] * g[2])};
      for (int d = 0; d < dim; ++d) force[k + 1][d] = -f[d], force[0][d] += f[d];
    }
    return force;
  }
  /// Force per area on soil in a cell through a face of outward normal n: sigma n [Pa].
  Vec<dim> traction(int cell, const Vec<dim> &n) const {
    const auto &s = mean_[cell];
    if constexpr (dim == 2)
      return {s[0] * n[0] + s[3] * n[1], s[3] * n[0] + s[1] * n[1]};
    else
      return {s[0] * n[0] + s[3] * n[1] + s[5] * n[2], s[3] * n[0] + s[1] * n[1] + s[4] * n[2],
              s[5] * n[0] + s[4] * n[1] + s[2] * n[2]};
  }

  /// Mean effective stress of a cell [Pa].
  Eigen::Matrix3d mean(int cell) const {
    const auto &s = mean_[cell];
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) m(k, k) = s[k];
    m(0, 1) = m(1, 0) = s[3];
    if constexpr (dim == 3) m(1, 2) = m(2, 1) = s[4], m(0, 2) = m(2, 0) = s[5];
    return m;
  }

 private:
  std::vector<std::array<double, stress_size<dim>>> mean_;  ///< [cell] [Pa]
};

}  // namespace talus
