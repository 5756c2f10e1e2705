#include "solvers/quasi_static/hanging_pieces.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "solvers/quasi_static/pieces.h"

namespace talus {
namespace {

/// The piece of each cell with soil, by the largest number of its cells; -1: no soil. Faces join cells. Collective.
template <int dim>
PetscErrorCode pieces_by_faces(const SoilElements<dim> &soil, std::vector<PetscInt> *piece) {
  const BackgroundMesh<dim> &mesh = soil.mesh();
  const int count = mesh.cell_count();
  PetscFunctionBeginUser;
  std::vector<int> joined(count);  // another cell of the piece on this rank, the first of them itself
  std::iota(joined.begin(), joined.end(), 0);
  const auto first = [&joined](int c) {
    while (joined[c] != c) c = joined[c] = joined[joined[c]];
    return c;
  };
  for (int c = 0; c < count; ++c)
    for (const int other : mesh.cells[c].neighbour)
      if (other > c && soil.active(c) && soil.active(other)) {
        const int a = first(c), b = first(other);
        joined[std::max(a, b)] = std::min(a, b);
      }
  std::vector<PetscInt> name(count, -1);  // of the first cell
  for (int c = 0; c < count; ++c)
    if (soil.active(c)) name[first(c)] = std::max(name[first(c)], static_cast<PetscInt>(mesh.global_cell[c]));

  piece->assign(count, -1);
  for (int changed = 1; changed;) {
    changed = 0;
    for (int c = 0; c < count; ++c)
      if (soil.active(c)) (*piece)[c] = name[first(c)];
    const std::vector<PetscInt> beyond = mesh.across(*piece);
    for (int c = 0; c < count; ++c)
      for (const int other : mesh.cells[c].neighbour)
        if (other < boundary && soil.active(c) && beyond[-2 - other] > name[first(c)])
          name[first(c)] = beyond[-2 - other], changed = 1;
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, soil.nodes().comm()));
  }
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode hanging_pieces(const SoilElements<dim> &soil, const CellSet &moving, CellSet *hanging,
                              LeftOut<dim> *found) {
  const BackgroundMesh<dim> &mesh = soil.mesh();
  const ElementNodes<dim> &nodes = soil.nodes();
  std::vector<PetscInt> piece, with_moving;
  std::map<PetscInt, size_t> number;  // of the pieces with cells that move
  PetscFunctionBeginUser;
  *found = {};
  hanging->assign(moving.size(), 0);
  PetscCall(pieces_by_faces(soil, &piece));
  for (size_t c = 0; c < moving.size(); ++c)
    if (moving[c] && piece[c] >= 0) with_moving.push_back(piece[c]);
  std::sort(with_moving.begin(), with_moving.end());
  with_moving.erase(std::unique(with_moving.begin(), with_moving.end()), with_moving.end());
  PetscCall(number_labels(nodes.comm(), with_moving, &number));
  const size_t count = number.size();
  const auto number_of = [&number, count](PetscInt name) {
    const auto place = number.find(name);
    return place == number.end() ? count : place->second;
  };

  // a node at which soil has numbers of which not all are equal is one at which pieces touch
  std::vector<PetscInt> most(nodes.count(), -1), least(nodes.count(), -static_cast<PetscInt>(count) - 1);  // negated
  const auto each_vertex = [&](const auto &visit) {
    for (int c = 0; c < mesh.cell_count(); ++c)
      for (int a = 0; piece[c] >= 0 && a <= dim; ++a) visit(number_of(piece[c]), nodes.of_cell(c)[a]);
  };
  each_vertex([&](size_t k, int node) {
    most[node] = std::max(most[node], static_cast<PetscInt>(k));
    least[node] = std::max(least[node], -static_cast<PetscInt>(k));
  });
  PetscCall(nodes.maximum(most));
  PetscCall(nodes.maximum(least));

  constexpr int sums_of_each = dim + 2;                   // volume, its moments, vertices that touch another piece
  std::vector<double> sums(count * sums_of_each + 1, 0);  // the last: volume of all soil
  Barycentric<dim> middle;
  middle.fill(1. / (dim + 1));
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (piece[c] < 0) continue;
    sums.back() += mesh.volume[c];
    const size_t k = number_of(piece[c]);
    if (k == count) continue;
    double *sum = &sums[k * sums_of_each];
    const Vec<dim> centre = place_in(mesh, c, middle);
    sum[0] += mesh.volume[c];
    for (int d = 0; d < dim; ++d) sum[1 + d] += mesh.volume[c] * centre[d];
  }
  each_vertex([&](size_t k, int node) {
    if (k < count && most[node] != -least[node]) ++sums[k * sums_of_each + dim + 1];
  });
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, nodes.comm()));

  for (size_t k = 0; k < count; ++k) {
    const double *sum = &sums[k * sums_of_each];
    if (sum[dim + 1] == 0) {
      *found = {};
      PetscFunctionReturn(0);
    }
    ++found->pieces, found->volume += sum[0];
    if (sum[0] <= found->largest) continue;
    found->largest = sum[0];
    for (int d = 0; d < dim; ++d) found->place[d] = sum[1 + d] / sum[0];
  }
  found->share = sums.back() > 0 ? found->volume / sums.back() : 0;
  if (found->share > most_left_out) *found = {};
  if (found->pieces == 0) PetscFunctionReturn(0);
  for (size_t c = 0; c < piece.size(); ++c) (*hanging)[c] = piece[c] >= 0 && number_of(piece[c]) < count;
  PetscFunctionReturn(0);
}

template PetscErrorCode hanging_pieces<2>(const SoilElements<2> &, const CellSet &, CellSet *, LeftOut<2> *);
template PetscErrorCode hanging_pieces<3>(const SoilElements<3> &, const CellSet &, CellSet *, LeftOut<3> *);

}  // namespace talus
