#include "simulation/overburden.h"

#include <algorithm>
#include <cmath>

#include "meshes/exchange.h"

namespace talus {
namespace {

constexpr double aside = 1e-9;  // how far verticals stand beside their places, in the width of the soil

}  // namespace

template <int dim>
Overburden<dim>::Overburden(const BackgroundMesh<dim> &mesh, const std::vector<Block> &mine, int vertical)
    : vertical_(vertical) {
  for (const Block &block : mine)
    for (const Vec<dim> &corner : block.corner) extent_.enclose(corner);
  MPI_Allreduce(MPI_IN_PLACE, extent_.low.data(), dim, MPI_DOUBLE, MPI_MIN, mesh.comm());
  MPI_Allreduce(MPI_IN_PLACE, extent_.high.data(), dim, MPI_DOUBLE, MPI_MAX, mesh.comm());
  double reach = 0;  // verticals stand a little beside their places
  for (int d = 0; d < dim; ++d) reach = std::max(reach, 2 * aside * (extent_.high[d] - extent_.low[d]));

  int rank;
  MPI_Comm_rank(mesh.comm(), &rank);
  const std::vector<Box<dim>> parts = boxes_of_parts(mesh);
  std::vector<int> near;
  std::vector<std::vector<Block>> sent;
  for (int r = 0; r < static_cast<int>(parts.size()); ++r) {
    if (r == rank || !parts[r].meets(parts[rank], reach, vertical)) continue;
    near.push_back(r), sent.emplace_back();
    for (const Block &block : mine) {
      Box<dim> around;
      for (const Vec<dim> &corner : block.corner) around.enclose(corner);
      if (around.meets(parts[r], reach, vertical)) sent.back().push_back(block);
    }
  }
  const std::vector<std::vector<Block>> received = exchange(mesh.comm(), near, sent);
  const auto take = [this](const std::vector<Block> &more) { blocks_.insert(blocks_.end(), more.begin(), more.end()); };
  size_t below = 0;  // of the ranks that are near: in the order of ranks
  for (; below < near.size() && near[below] < rank; ++below) take(received[below]);
  take(mine);
  for (; below < near.size(); ++below) take(received[below]);

  in_strip_.resize(std::max(1, static_cast<int>(std::sqrt(static_cast<double>(blocks_.size())))));
  for (size_t k = 0; k < blocks_.size(); ++k) {
    double from = 1e300, to = -1e300;
    for (const Vec<dim> &corner : blocks_[k].corner) from = std::min(from, corner[0]), to = std::max(to, corner[0]);
    for (int s = strip_of(from); s <= strip_of(to); ++s) in_strip_[s].push_back(static_cast<int>(k));
  }
}

template <int dim>
int Overburden<dim>::strip_of(double x) const {
  const int strips = static_cast<int>(in_strip_.size());
  return std::clamp(static_cast<int>((x - extent_.low[0]) / (extent_.high[0] - extent_.low[0]) * strips), 0,
                    strips - 1);
}

/// The part of the vertical through x that lies in a simplex and above x: barycentric coordinates are linear along it.
/// A vertical along a face would count the blocks on both sides, so it stands a billionth of the width beside x.
template <int dim>
double Overburden<dim>::above(const Vec<dim> &place, double *top) const {
  Vec<dim> x = place;
  for (int d = 0; d < dim; ++d)
    if (d != vertical_)
      x[d] += aside * (extent_.high[d] - extent_.low[d]) * (2 * x[d] > extent_.low[d] + extent_.high[d] ? -1 : 1);
  double weight = 0;
  *top = x[vertical_];
  for (const int k : in_strip_[strip_of(x[0])]) {
    const Block &block = blocks_[k];
    Square<dim> edges;
    for (int a = 0; a < dim; ++a) edges.col(a) = map<dim>(block.corner[a + 1]) - map<dim>(block.corner[0]);
    const Square<dim> inverse = edges.inverse();
    const ColumnVector<dim> at = inverse * (map<dim>(x) - map<dim>(block.corner[0])), slope = inverse.col(vertical_);
    double from = 0, to = 1e300;  // height above x
    const auto cut = [&](double value, double rise) {
      if (rise > 0)
        from = std::max(from, -value / rise);
      else if (rise < 0)
        to = std::min(to, -value / rise);
      else if (value < 0)
        to = 0;
    };
    cut(1 - at.sum(), -slope.sum());
    for (int a = 0; a < dim; ++a) cut(at[a], slope[a]);
    if (to > from) weight += block.unit_weight * (to - from), *top = std::max(*top, x[vertical_] + to);
  }
  return weight;
}

template class Overburden<2>;
template class Overburden<3>;

}  // namespace talus
