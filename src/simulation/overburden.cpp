#include "simulation/overburden.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace talus {

template <int dim>
Overburden<dim>::Overburden(MPI_Comm comm, const std::vector<Block> &mine) {
  int ranks;
  MPI_Comm_size(comm, &ranks);
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  const int bytes = static_cast<int>(mine.size() * sizeof(Block));
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  blocks_.resize(starts[ranks] / sizeof(Block));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, blocks_.data(), counts.data(), starts.data(), MPI_BYTE, comm);
  const auto extent = [](const Block &block) {
    double low = block.corner[0][0], high = low;
    for (const Vec<dim> &corner : block.corner) low = std::min(low, corner[0]), high = std::max(high, corner[0]);
    return std::pair{low, high};
  };
  low_ = 1e300, high_ = -1e300;
  for (const Block &block : blocks_)
    low_ = std::min(low_, extent(block).first), high_ = std::max(high_, extent(block).second);
  in_strip_.resize(std::max(1, static_cast<int>(std::sqrt(static_cast<double>(blocks_.size())))));
  for (size_t k = 0; k < blocks_.size(); ++k) {
    const auto [from, to] = extent(blocks_[k]);
    for (int s = strip_of(from); s <= strip_of(to); ++s) in_strip_[s].push_back(static_cast<int>(k));
  }
}

template <int dim>
int Overburden<dim>::strip_of(double x) const {
  const int strips = static_cast<int>(in_strip_.size());
  return std::clamp(static_cast<int>((x - low_) / (high_ - low_) * strips), 0, strips - 1);
}

/// The part of the vertical through x that lies in a simplex and above x: barycentric coordinates are linear along it.
template <int dim>
double Overburden<dim>::above(const Vec<dim> &x, double *top) const {
  double weight = 0;
  *top = x[1];
  for (const int k : in_strip_[strip_of(x[0])]) {
    const Block &block = blocks_[k];
    Square<dim> edges;
    for (int a = 0; a < dim; ++a) edges.col(a) = map<dim>(block.corner[a + 1]) - map<dim>(block.corner[0]);
    const Square<dim> inverse = edges.inverse();
    const ColumnVector<dim> at = inverse * (map<dim>(x) - map<dim>(block.corner[0])), slope = inverse.col(1);
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
    if (to > from) weight += block.unit_weight * (to - from), *top = std::max(*top, x[1] + to);
  }
  return weight;
}

template class Overburden<2>;
template class Overburden<3>;

}  // namespace talus
