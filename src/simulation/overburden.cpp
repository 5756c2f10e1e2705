#include "simulation/overburden.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace talus {

template <int dim>
Overburden<dim>::Overburden(MPI_Comm comm, const std::vector<Block> &mine, int vertical) : vertical_(vertical) {
  int ranks;
  MPI_Comm_size(comm, &ranks);
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  const int bytes = static_cast<int>(mine.size() * sizeof(Block));
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  blocks_.resize(starts[ranks] / sizeof(Block));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, blocks_.data(), counts.data(), starts.data(), MPI_BYTE, comm);
  low_.fill(1e300), high_.fill(-1e300);
  for (const Block &block : blocks_)
    for (const Vec<dim> &corner : block.corner)
      for (int d = 0; d < dim; ++d) low_[d] = std::min(low_[d], corner[d]), high_[d] = std::max(high_[d], corner[d]);
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
  return std::clamp(static_cast<int>((x - low_[0]) / (high_[0] - low_[0]) * strips), 0, strips - 1);
}

/// The part of the vertical through x that lies in a simplex and above x: barycentric coordinates are linear along it.
/// A vertical along a face would count the blocks on both sides, so it stands a billionth of the width beside x.
template <int dim>
double Overburden<dim>::above(const Vec<dim> &place, double *top) const {
  constexpr double aside = 1e-9;
  Vec<dim> x = place;
  for (int d = 0; d < dim; ++d)
    if (d != vertical_) x[d] += aside * (high_[d] - low_[d]) * (2 * x[d] > low_[d] + high_[d] ? -1 : 1);
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
