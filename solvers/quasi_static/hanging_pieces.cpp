#include "solvers/quasi_static/hanging_pieces.h"

#include <map>
#include <numeric>

#include "base/local_numbers.h"

namespace talus {
namespace {

/// A cell of the soil, as all ranks know it.
template <int dim>
struct Element {
  long long cell;
  std::array<long long, dim + 1> vertex;
  double volume;
  Vec<dim> centre;
  int moving;
};

/// The cells of all ranks in the order of their numbers.
template <int dim>
PetscErrorCode all_elements(const SoilElements<dim> &soil, const CellSet &moving, std::vector<Element<dim>> *all) {
  PetscFunctionBeginUser;
  const BackgroundMesh<dim> &mesh = soil.mesh();
  const ElementNodes<dim> &nodes = soil.nodes();
  std::vector<Element<dim>> mine;
  Barycentric<dim> middle;
  middle.fill(1. / (dim + 1));
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (!soil.active(c)) continue;
    Element<dim> element{mesh.global_cell[c], {}, mesh.volume[c], place_in(mesh, c, middle), moving[c]};
    for (int a = 0; a <= dim; ++a) element.vertex[a] = nodes.number[nodes.of_cell(c)[a]];
    std::sort(element.vertex.begin(), element.vertex.end());
    mine.push_back(element);
  }
  int ranks, bytes = static_cast<int>(mine.size() * sizeof(Element<dim>));
  PetscCallMPI(MPI_Comm_size(nodes.comm(), &ranks));
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  PetscCallMPI(MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, nodes.comm()));
  for (int r = 0; r < ranks; ++r) starts[r + 1] = starts[r] + counts[r];
  all->resize(starts[ranks] / sizeof(Element<dim>));
  PetscCallMPI(
      MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all->data(), counts.data(), starts.data(), MPI_BYTE, nodes.comm()));
  std::sort(all->begin(), all->end(), [](const auto &a, const auto &b) { return a.cell < b.cell; });
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode hanging_pieces(const SoilElements<dim> &soil, const CellSet &moving, CellSet *hanging,
                              LeftOut<dim> *found) {
  std::vector<Element<dim>> all;
  PetscFunctionBeginUser;
  *found = {};
  hanging->assign(moving.size(), 0);
  PetscCall(all_elements(soil, moving, &all));

  // pieces: cells that faces join, named by the first of them
  std::vector<size_t> piece(all.size());
  std::iota(piece.begin(), piece.end(), size_t{0});
  const auto name = [&piece](size_t k) {
    while (piece[k] != k) k = piece[k] = piece[piece[k]];
    return k;
  };
  std::map<std::array<long long, dim>, size_t> of_face;
  for (size_t k = 0; k < all.size(); ++k)
    for (int left_out = 0; left_out <= dim; ++left_out) {
      std::array<long long, dim> face;
      for (int a = 0, n = 0; a <= dim; ++a)
        if (a != left_out) face[n++] = all[k].vertex[a];
      const auto [place, is_new] = of_face.emplace(face, k);
      if (is_new) continue;
      const size_t a = name(place->second), b = name(k);
      piece[std::max(a, b)] = std::min(a, b);
    }

  struct Piece {
    double volume = 0;
    Vec<dim> moment{};
    bool moves = false, touches = false;
  };
  std::map<size_t, Piece> pieces;
  std::map<long long, size_t> piece_at;  // of a vertex, the first
  double whole = 0;
  for (size_t k = 0; k < all.size(); ++k) {
    Piece &p = pieces[name(k)];
    p.volume += all[k].volume, whole += all[k].volume, p.moves = p.moves || all[k].moving;
    for (int d = 0; d < dim; ++d) p.moment[d] += all[k].volume * all[k].centre[d];
    for (const long long vertex : all[k].vertex) {
      const auto [place, is_new] = piece_at.emplace(vertex, name(k));
      if (!is_new && place->second != name(k)) p.touches = pieces[place->second].touches = true;
    }
  }
  for (const auto &[first, p] : pieces) {
    if (!p.moves) continue;
    if (!p.touches) {
      *found = {};
      PetscFunctionReturn(0);
    }
    ++found->pieces, found->volume += p.volume;
    if (p.volume <= found->largest) continue;
    found->largest = p.volume;
    for (int d = 0; d < dim; ++d) found->place[d] = p.moment[d] / p.volume;
  }
  found->share = whole > 0 ? found->volume / whole : 0;
  if (found->share > most_left_out) *found = {};
  if (found->pieces == 0) PetscFunctionReturn(0);
  const LocalNumbers cell_of(soil.mesh().global_cell);
  for (size_t k = 0; k < all.size(); ++k)
    if (const int cell = cell_of.find(all[k].cell); cell >= 0 && pieces.at(name(k)).moves) (*hanging)[cell] = 1;
  PetscFunctionReturn(0);
}

template PetscErrorCode hanging_pieces<2>(const SoilElements<2> &, const CellSet &, CellSet *, LeftOut<2> *);
template PetscErrorCode hanging_pieces<3>(const SoilElements<3> &, const CellSet &, CellSet *, LeftOut<3> *);

}  // namespace talus
