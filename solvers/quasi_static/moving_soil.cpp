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

std::vector<std::array<double, 2>> slip_surface(const SoilElements<2> &soil, const CellSet &piece, double low,
                                                double high) {
  const MPI_Comm comm = soil.nodes().comm();
  const double width = cell_size(soil);
  const size_t strips = static_cast<size_t>((high - low) / width) + 1;
  // the strip of a point; none beside the piece
  const auto strip_of = [&](const GaussPoints<2> &p, int q) {
    const double place = (p.position[q][0] - low) / width;
    return place < 0 || place >= static_cast<double>(strips) ? strips : static_cast<size_t>(place);
  };
  std::vector<double> most(strips + 1, 0), moves(strips + 1, 0), height(strips + 1, -1e300), place = height;
  each_point(soil, [&](const GaussPoints<2> &p, int q) {
    const size_t s = strip_of(p, q);
    most[s] = std::max(most[s], shearing_of(p.increment[q].strain));
    if (piece[p.cell[q]]) moves[s] = 1;
  });
  reduce(comm, most, MPI_MAX), reduce(comm, moves, MPI_MAX);
  each_point(soil, [&](const GaussPoints<2> &p, int q) {
    const size_t s = strip_of(p, q);
    if (shearing_of(p.increment[q].strain) == most[s]) place[s] = p.position[q][0], height[s] = p.position[q][1];
  });
  reduce(comm, place, MPI_MAX), reduce(comm, height, MPI_MAX);
  std::vector<std::array<double, 2>> surface;
  for (size_t s = 0; s < strips; ++s)
    if (moves[s] > 0) surface.push_back({place[s], height[s]});
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
