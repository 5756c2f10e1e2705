#include "physics/cell_pressure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

namespace talus {

template <int dim>
CellPressure<dim>::CellPressure(MPI_Comm comm, const std::vector<double> &mine) {
  int ranks, count = static_cast<int>(mine.size());
  MPI_Comm_size(comm, &ranks);
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  cells_.resize(starts[ranks]);
  MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, cells_.data(), counts.data(), starts.data(), MPI_DOUBLE, comm);
  sort_into_bins();
}

template <int dim>
std::string CellPressure<dim>::table() const {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  const char *axis[] = {"x", "y", "z"};
  for (int a = 0; a <= dim; ++a) {
    for (int d = 0; d < dim; ++d) text << axis[d] << a << "_m,";
    text << "pore_pressure" << a << "_Pa" << (a < dim ? "," : "\n");
  }
  for (size_t k = 0; k < cells_.size(); ++k) text << cells_[k] << ((k + 1) % width ? "," : "\n");
  return text.str();
}

template <int dim>
void CellPressure<dim>::sort_into_bins() {
  const int count = static_cast<int>(cells_.size() / width);
  Vec<dim> high;
  low_.fill(1e300), high.fill(-1e300);
  for (size_t k = 0; k < cells_.size(); k += dim + 1)
    for (int d = 0; d < dim; ++d)
      low_[d] = std::min(low_[d], cells_[k + d]), high[d] = std::max(high[d], cells_[k + d]);
  for (int d = 0; d < dim; ++d) {
    bins_[d] = std::max(1, static_cast<int>(std::pow(count, 1. / dim)));
    bin_size_[d] = std::max((high[d] - low_[d]) / bins_[d], 1e-300);
  }
  // counted first, then filled
  first_.assign(std::accumulate(bins_.begin(), bins_.end(), 1, std::multiplies<>()) + 1, 0);
  const auto each_bin = [&](auto &&visit) {
    for (int c = 0; c < count; ++c) {
      std::array<int, dim> from, to, at;
      from.fill(std::numeric_limits<int>::max()), to.fill(0);
      for (int a = 0; a <= dim; ++a)
        for (int d = 0; d < dim; ++d) {
          const int bin = std::clamp(
              static_cast<int>((cells_[static_cast<size_t>(c) * width + a * (dim + 1) + d] - low_[d]) / bin_size_[d]),
              0, bins_[d] - 1);
          from[d] = std::min(from[d], bin), to[d] = std::max(to[d], bin);
        }
      for (at = from;;) {
        int index = 0;
        for (int d = 0; d < dim; ++d) index = index * bins_[d] + at[d];
        visit(index, c);
        int d = 0;
        while (d < dim && ++at[d] > to[d]) at[d] = from[d], ++d;
        if (d == dim) break;
      }
    }
  };
  each_bin([&](int bin, int) { ++first_[bin + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  in_bin_.resize(first_.back());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  each_bin([&](int bin, int c) { in_bin_[next[bin]++] = c; });
}

template <int dim>
double CellPressure<dim>::operator()(const double *x) const {
  constexpr double edge = 1e-9;  // of a barycentric coordinate: round-off on faces
  int bin = 0;
  for (int d = 0; d < dim; ++d) {
    const double at = (x[d] - low_[d]) / bin_size_[d];
    if (!(at >= -edge && at <= bins_[d] + edge)) return std::numeric_limits<double>::quiet_NaN();
    bin = bin * bins_[d] + std::clamp(static_cast<int>(at), 0, bins_[d] - 1);
  }
  for (int k = first_[bin]; k < first_[bin + 1]; ++k) {
    const double *cell = &cells_[static_cast<size_t>(in_bin_[k]) * width];
    Square<dim> edges;
    ColumnVector<dim> from;
    for (int d = 0; d < dim; ++d) {
      from[d] = x[d] - cell[d];
      for (int a = 0; a < dim; ++a) edges(d, a) = cell[(a + 1) * (dim + 1) + d] - cell[d];
    }
    const ColumnVector<dim> l = edges.inverse() * from;
    if (l.minCoeff() < -edge || l.sum() > 1 + edge) continue;
    double p = (1 - l.sum()) * cell[dim];
    for (int a = 0; a < dim; ++a) p += l[a] * cell[(a + 1) * (dim + 1) + dim];
    return p;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

template class CellPressure<2>;
template class CellPressure<3>;

}  // namespace talus
