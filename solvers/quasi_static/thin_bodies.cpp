#include "solvers/quasi_static/thin_bodies.h"

#include "meshes/complaints.h"

namespace talus {

template <int dim>
std::vector<char> find_thin_bodies(const BackgroundMesh<dim> &mesh, const std::vector<int> &body_of,
                                   std::size_t bodies) {
  // of each node: bodies there, counted on each rank, the sums of their numbers and of the squares of these, free faces
  constexpr int width = 4;
  struct AtNode {
    double count, number, square, free;
    void add(int body) { count += 1, number += body, square += static_cast<double>(body) * body; }
    bool of_one_body() const { return count > 0 && count * square == number * number; }
  };
  static_assert(sizeof(AtNode) == width * sizeof(double));
  std::vector<AtNode> at(mesh.node_count(), AtNode{});
  std::vector<int> first(mesh.node_count(), -1);
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (body_of[c] < 0) continue;
    const Cell<dim> &cell = mesh.cells[c];
    for (int k = 0; k <= dim; ++k) {
      const int node = cell.node[k], across = cell.neighbour[k];
      if (first[node] < 0) at[node].add(first[node] = body_of[c]);
      if (first[node] != body_of[c]) at[node].add(body_of[c]);
      if (across != boundary && !(across >= 0 && body_of[across] < 0)) continue;
      for (int a = 0; a <= dim; ++a)
        if (a != k) at[cell.node[a]].free += 1;
    }
  }
  Halo halo = mesh.halo;
  require(halo.sum(reinterpret_cast<double *>(at.data()), width));
  std::vector<int> cells(bodies, 0), inside(bodies, 0);
  for (const int body : body_of)
    if (body >= 0) cells[body] = 1;
  for (int i = 0; i < mesh.node_count(); ++i)
    if (first[i] >= 0 && at[i].of_one_body() && at[i].free == 0) inside[first[i]] = 1;
  MPI_Allreduce(MPI_IN_PLACE, cells.data(), static_cast<int>(bodies), MPI_INT, MPI_MAX, mesh.comm());
  MPI_Allreduce(MPI_IN_PLACE, inside.data(), static_cast<int>(bodies), MPI_INT, MPI_MAX, mesh.comm());
  std::vector<char> thin(bodies);
  for (std::size_t b = 0; b < bodies; ++b) thin[b] = cells[b] && !inside[b];
  return thin;
}

template std::vector<char> find_thin_bodies(const BackgroundMesh<2> &, const std::vector<int> &, std::size_t);
template std::vector<char> find_thin_bodies(const BackgroundMesh<3> &, const std::vector<int> &, std::size_t);

}  // namespace talus
