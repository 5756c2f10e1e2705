#include "solvers/quasi_static/moving_soil.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "solvers/quasi_static/pieces.h"

namespace talus {
namespace {

/// Over all ranks, in place.
void reduce(MPI_Comm comm, std::vector<double> &values, MPI_Op operation) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, operation, comm);
}

template <int dim>
EachElement elements_of(const SoilElements<dim> &soil, const CellSet &cells) {
  return [&soil, &cells](const std::function<PetscErrorCode(const int *, int)> &visit) -> PetscErrorCode {
    PetscFunctionBeginUser;
    for (size_t c = 0; c < cells.size(); ++c)
      if (cells[c]) PetscCall(visit(soil.nodes().of_cell(static_cast<int>(c)), dim + 1));
    PetscFunctionReturn(0);
  };
}

/// Mean size of the active cells, as a side of a square or a cube of twice the volume [m]. Collective.
template <int dim>
double cell_size(const SoilElements<dim> &soil) {
  std::vector<double> sums{0, 0};
  for (int c = 0; c < soil.mesh().cell_count(); ++c)
    if (soil.active(c)) sums[0] += soil.mesh().volume[c], sums[1] += 1;
  reduce(soil.nodes().comm(), sums, MPI_SUM);
  return std::pow(2 * sums[0] / sums[1], 1. / dim);
}

/// Difference of the extreme principal strains in the plane of the section.
double shearing_of(const std::array<double, stress_size<2>> &strain) {
  return std::hypot(strain[0] - strain[1], 2 * strain[3]);
}

/// Calls visit(points of a body, place among them) for the Gauss points of the bodies that are there.
template <class Visit>
void each_point(const SoilElements<2> &soil, const Visit &visit) {
  for (const GaussPoints<2> &p : soil.points())
    for (int q = 0; p.present && q < p.count(); ++q) visit(p, q);
}

/// Columns of bins, and the way through them from the first column to the last that costs least: a step costs the mean
/// resistance of its two bins. Returns whether the way enters each bin.
std::vector<char> way_through(const std::vector<double> &resistance, size_t columns, size_t rows) {
  const auto step = [&](size_t a, size_t b) { return (resistance[a] + resistance[b]) / 2; };
  std::vector<double> cost(columns * rows, 0);
  std::vector<size_t> from(columns * rows);  // the bin before; itself where the way begins
  for (size_t k = 0; k < cost.size(); ++k) {
    from[k] = k < rows ? k : k - rows;
    cost[k] = k < rows ? resistance[k] / 2 : cost[k - rows] + step(k - rows, k);
    if (k % rows + 1 < rows) continue;
    const auto learn = [&](size_t bin, size_t beside) {  // up and down the column
      const double other = cost[beside] + step(beside, bin);
      if (other < cost[bin]) cost[bin] = other, from[bin] = beside;
    };
    for (size_t bin = k - rows + 2; bin <= k; ++bin) learn(bin, bin - 1);
    for (size_t bin = k; bin > k - rows + 1; --bin) learn(bin - 1, bin);
  }
  std::vector<char> on_way(cost.size(), 0);
  size_t bin = static_cast<size_t>(std::min_element(cost.end() - static_cast<long>(rows), cost.end()) - cost.begin());
  for (; from[bin] != bin; bin = from[bin]) on_way[bin] = 1;
  on_way[bin] = 1;
  return on_way;
}

/// In each strip of the moving soil, as wide as a cell, the middle of the shear band: of the points in the bins of one
/// line and next to it, weighted with a power of their shear. The largest shear of a strip may lie beside the band,
/// such as at a toe above it: the line is the way through bins that shear much compared with their strip.
std::vector<std::array<double, 2>> slip_surface(const SoilElements<2> &soil, const CellSet &piece, double low,
                                                double high) {
  constexpr double least = 0.1;  // of the shear of a strip: soil that shears less resists alike
  constexpr int sharp = 3;       // the power: a band is wider on one side of where it shears most
  const MPI_Comm comm = soil.nodes().comm();
  const double width = cell_size(soil);
  std::vector<double> range{-1e300, -1e300};  // highest and lowest point, the latter negative
  each_point(soil, [&](const GaussPoints<2> &p, int q) {
    range[0] = std::max(range[0], p.position[q][1]), range[1] = std::max(range[1], -p.position[q][1]);
  });
  reduce(comm, range, MPI_MAX);
  const size_t strips = static_cast<size_t>((high - low) / width) + 1,
               rows = static_cast<size_t>((range[0] + range[1]) / width) + 1, bins = strips * rows;
  // the bin of a point; none beside the piece
  const auto bin_of = [&](const GaussPoints<2> &p, int q) {
    const double place = (p.position[q][0] - low) / width;
    if (place < 0 || place >= static_cast<double>(strips)) return bins;
    return static_cast<size_t>(place) * rows + static_cast<size_t>((p.position[q][1] + range[1]) / width);
  };
  std::vector<double> most(bins + 1, 0), moves(strips + 1, 0);
  each_point(soil, [&](const GaussPoints<2> &p, int q) {
    const size_t k = bin_of(p, q);
    most[k] = std::max(most[k], shearing_of(p.increment[q].strain));
    if (piece[p.cell[q]]) moves[k / rows] = 1;
  });
  reduce(comm, most, MPI_MAX), reduce(comm, moves, MPI_MAX);
  std::vector<double> largest(strips), resistance(bins);
  for (size_t s = 0; s < strips; ++s) largest[s] = *std::max_element(&most[s * rows], &most[s * rows] + rows);
  for (size_t k = 0; k < bins; ++k) resistance[k] = 1 / (least + (most[k] > 0 ? most[k] / largest[k / rows] : 0));
  const std::vector<char> on_way = way_through(resistance, strips, rows);
  std::vector<double> sums(3 * strips, 0);  // of weights, weights times x and y
  each_point(soil, [&](const GaussPoints<2> &p, int q) {
    const size_t k = bin_of(p, q);
    if (k == bins) return;
    const bool below = k % rows > 0 && on_way[k - 1], above = k % rows + 1 < rows && on_way[k + 1];
    if (!on_way[k] && !below && !above) return;
    const double shear = shearing_of(p.increment[q].strain),
                 weight = shear > 0 ? p.volume[q] * std::pow(shear / largest[k / rows], sharp) : 0;
    sums[k / rows * 3] += weight;
    for (int d = 0; d < 2; ++d) sums[k / rows * 3 + 1 + d] += weight * p.position[q][d];
  });
  reduce(comm, sums, MPI_SUM);
  std::vector<std::array<double, 2>> surface;
  for (size_t s = 0; s < strips; ++s)
    if (moves[s] > 0 && sums[3 * s] > 0)
      surface.push_back({sums[3 * s + 1] / sums[3 * s], sums[3 * s + 2] / sums[3 * s]});
  return surface;
}

}  // namespace

CellSet both(const CellSet &a, const CellSet &b) {
  CellSet result(a.size());
  for (size_t c = 0; c < a.size(); ++c) result[c] = a[c] && b[c];
  return result;
}

CellSet either(const CellSet &a, const CellSet &b) {
  CellSet result(a.size());
  for (size_t c = 0; c < a.size(); ++c) result[c] = a[c] || b[c];
  return result;
}

template <int dim>
double volume_of(const SoilElements<dim> &soil, const CellSet &cells) {
  std::vector<double> volume{0};
  for (size_t c = 0; c < cells.size(); ++c)
    if (cells[c]) volume[0] += soil.mesh().volume[c];
  reduce(soil.nodes().comm(), volume, MPI_SUM);
  return volume[0];
}

template <int dim>
PetscErrorCode moving_pieces(const SoilElements<dim> &soil, std::vector<CellSet> *pieces) {
  constexpr double share = 0.1, small = 0.05;
  Barycentric<dim> middle;
  middle.fill(1. / (dim + 1));
  PetscFunctionBeginUser;
  const double moving = share * soil.largest_displacement();
  CellSet all(soil.mesh().cell_count(), 0);
  for (int c = 0; c < soil.mesh().cell_count(); ++c) {
    if (!soil.active(c)) continue;
    const Vec<dim> u = soil.displacement(c, middle);
    all[c] = map<dim>(u).norm() > moving;
  }
  std::vector<PetscInt> label = soil.nodes().global(), mine;
  PetscCall(spread_labels<dim>(soil.nodes(), elements_of(soil, all), label));
  const auto label_of = [&](size_t c) { return label[soil.nodes().of_cell(static_cast<int>(c))[0]]; };
  for (size_t c = 0; c < all.size(); ++c)
    if (all[c]) mine.push_back(label_of(c));
  std::map<PetscInt, size_t> number;
  PetscCall(number_labels(soil.nodes().comm(), mine, &number));
  pieces->assign(number.size(), CellSet(all.size(), 0));
  for (size_t c = 0; c < all.size(); ++c)
    if (all[c]) (*pieces)[number.at(label_of(c))][c] = 1;
  std::vector<std::pair<double, CellSet>> sized;
  for (CellSet &piece : *pieces) sized.emplace_back(volume_of(soil, piece), std::move(piece));
  std::stable_sort(sized.begin(), sized.end(), [](const auto &a, const auto &b) { return a.first > b.first; });
  pieces->clear();
  for (auto &[volume, piece] : sized)
    if (volume >= small * sized[0].first) pieces->push_back(std::move(piece));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode grow_by(const SoilElements<dim> &soil, double distance, CellSet *cells) {
  return grow(soil, std::max(1, static_cast<int>(std::lround(distance / cell_size(soil)))), cells);
}

template <int dim>
PetscErrorCode grow(const SoilElements<dim> &soil, int layers, CellSet *cells) {
  PetscFunctionBeginUser;
  for (int layer = 0; layer < layers; ++layer) {
    std::vector<PetscInt> touched(soil.nodes().count(), 0);
    PetscCall(elements_of(soil, *cells)([&](const int *node, int count) -> PetscErrorCode {
      for (int k = 0; k < count; ++k) touched[node[k]] = 1;
      return 0;
    }));
    PetscCall(soil.nodes().maximum(touched));
    for (size_t c = 0; c < cells->size(); ++c) {
      if (!soil.active(static_cast<int>(c))) continue;
      const int *node = soil.nodes().of_cell(static_cast<int>(c));
      for (int k = 0; k <= dim; ++k) (*cells)[c] |= touched[node[k]] != 0;
    }
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode shear_beside(const SoilElements<dim> &soil, const CellSet &piece, const CellSet &cells, double *share) {
  CellSet edge = piece, near = cells;
  std::vector<double> sums{0, 0};  // near the cells, and all
  PetscFunctionBeginUser;
  PetscCall(grow(soil, 1, &edge));
  PetscCall(grow(soil, 2, &near));
  for (const GaussPoints<dim> &p : soil.points())
    for (int q = 0; p.present && q < p.count(); ++q) {
      if (!edge[p.cell[q]]) continue;
      Stress<dim> strain;
      std::copy_n(p.increment[q].strain.data(), stress_size<dim>, &strain.xx);
      const double sheared = p.volume[q] * Invariants<dim>(strain).q;
      sums[0] += near[p.cell[q]] ? sheared : 0, sums[1] += sheared;
    }
  reduce(soil.nodes().comm(), sums, MPI_SUM);
  *share = sums[1] > 0 ? sums[0] / sums[1] : 0;
  PetscFunctionReturn(0);
}

template <int dim>
void describe_motion(const SoilElements<dim> &soil, const CellSet &piece, Mechanism *mechanism) {
  std::vector<double> ends(2 * dim, -1e300);  // -low, high along each axis
  for (size_t c = 0; c < piece.size(); ++c)
    for (int a = 0; piece[c] && a <= dim; ++a) {
      const Vec<dim> &x = soil.mesh().position[soil.mesh().cells[c].node[a]];
      for (int d = 0; d < dim; ++d) ends[d] = std::max(ends[d], -x[d]), ends[dim + d] = std::max(ends[dim + d], x[d]);
    }
  reduce(soil.nodes().comm(), ends, MPI_MAX);
  for (int d = 0; d < dim; ++d) mechanism->low[d] = -ends[d], mechanism->high[d] = ends[dim + d];
  mechanism->moving_volume = volume_of(soil, piece);
  if constexpr (dim == 2) mechanism->slip_surface = slip_surface(soil, piece, -ends[0], ends[2]);
}

template PetscErrorCode moving_pieces(const SoilElements<2> &, std::vector<CellSet> *);
template PetscErrorCode moving_pieces(const SoilElements<3> &, std::vector<CellSet> *);
template double volume_of(const SoilElements<2> &, const CellSet &);
template double volume_of(const SoilElements<3> &, const CellSet &);
template PetscErrorCode grow(const SoilElements<2> &, int, CellSet *);
template PetscErrorCode grow(const SoilElements<3> &, int, CellSet *);
template PetscErrorCode grow_by(const SoilElements<2> &, double, CellSet *);
template PetscErrorCode grow_by(const SoilElements<3> &, double, CellSet *);
template PetscErrorCode shear_beside(const SoilElements<2> &, const CellSet &, const CellSet &, double *);
template PetscErrorCode shear_beside(const SoilElements<3> &, const CellSet &, const CellSet &, double *);
template void describe_motion(const SoilElements<2> &, const CellSet &, Mechanism *);
template void describe_motion(const SoilElements<3> &, const CellSet &, Mechanism *);

}  // namespace talus
