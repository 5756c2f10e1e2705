#pragma once
/// Writes small Gmsh 2.2 files without Gmsh: the unit square or cube, its inner nodes shifted, cut into triangles or
/// tetrahedra. Regions: lower (y < 1/2), upper. Facets: base (y = 0), top (y = 1), middle (y = 1/2, inside).
#include <petscsys.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace talus::test {

struct BoxMesh {
  int dim, n;
  std::vector<std::array<double, 3>> node;
  std::vector<std::vector<int>> cell, facet;
  std::vector<int> cell_tag, facet_tag;  // 1 lower, 2 upper; 11 base, 12 top, 13 middle

  BoxMesh(int dim_, int n_) : dim(dim_), n(n_) {
    const int layers = dim == 3 ? n : 0;
    for (int k = 0; k <= layers; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
          node.push_back({shifted(i, j, k), shifted_y(j, i, k), dim == 3 ? shifted(k, i, j) : 0});
    for (int k = 0; k < std::max(1, layers); ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) add_block(i, j, k);
  }

  int number(int i, int j, int k) const { return (k * (n + 1) + j) * (n + 1) + i; }

  void write(const std::string &file) const {
    std::ofstream out(file);
    out.precision(17);
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n";
    out << dim << " 1 \"lower\"\n" << dim << " 2 \"upper\"\n";
    out << dim - 1 << " 11 \"base\"\n"
        << dim - 1 << " 12 \"top\"\n"
        << dim - 1 << " 13 \"middle\"\n$EndPhysicalNames\n";
    out << "$Nodes\n" << node.size() << "\n";
    for (std::size_t i = 0; i < node.size(); ++i)
      out << i + 1 << " " << node[i][0] << " " << node[i][1] << " " << node[i][2] << "\n";
    out << "$EndNodes\n$Elements\n" << cell.size() + facet.size() << "\n";
    int id = 0;
    const auto element = [&](int type, int tag, const std::vector<int> &nodes) {
      out << ++id << " " << type << " 2 " << tag << " " << tag;
      for (int i : nodes) out << " " << i + 1;
      out << "\n";
    };
    for (std::size_t f = 0; f < facet.size(); ++f) element(dim == 3 ? 2 : 1, facet_tag[f], facet[f]);
    for (std::size_t c = 0; c < cell.size(); ++c) element(dim == 3 ? 4 : 2, cell_tag[c], cell[c]);
    out << "$EndElements\n";
  }

 private:
  double shift(int i, int a, int b) const { return i == 0 || i == n ? 0 : 0.2 * std::sin(7. * i + 3. * a + 5. * b); }
  double shifted(int i, int a, int b) const { return (i + shift(i, a, b)) / n; }
  double shifted_y(int j, int a, int b) const { return 2 * j == n ? 0.5 : shifted(j, a, b); }

  /// One block: each order of the axes is the path of one simplex from its lowest to its highest corner (Kuhn).
  void add_block(int i, int j, int k) {
    std::vector<int> axis(dim);
    for (int d = 0; d < dim; ++d) axis[d] = d;
    do {
      std::array<int, 3> at{i, j, k};
      std::vector<int> path{number(at[0], at[1], at[2])};
      std::vector<int> height{at[1]};
      for (int d : axis) {
        ++at[d];
        path.push_back(number(at[0], at[1], at[2]));
        height.push_back(at[1]);
      }
      cell.push_back(path);
      cell_tag.push_back(2 * j < n ? 1 : 2);
      add_facet(path, height, 0, 11);
      add_facet(path, height, n, 12);
      if (2 * j < n) add_facet(path, height, n / 2, 13);
    } while (std::next_permutation(axis.begin(), axis.end()));
  }

  void add_facet(const std::vector<int> &path, const std::vector<int> &height, int at, int tag) {
    std::vector<int> nodes;
    for (std::size_t k = 0; k < path.size(); ++k)
      if (height[k] == at) nodes.push_back(path[k]);
    if (static_cast<int>(nodes.size()) < dim) return;
    facet.push_back(nodes);
    facet_tag.push_back(tag);
  }
};

/// A file that rank 0 writes and all ranks may then read; removed at the end.
class SharedFile {
 public:
  explicit SharedFile(const std::function<void(const std::string &)> &write) {
    int rank;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    char name[256] = "";
    if (rank == 0) {
      std::snprintf(name, sizeof name, "%s/talus_test_%d_%d.msh", P_tmpdir, static_cast<int>(getpid()), count_++);
      write(name);
    }
    MPI_Bcast(name, sizeof name, MPI_CHAR, 0, PETSC_COMM_WORLD);
    name_ = name;
  }
  explicit SharedFile(const BoxMesh &mesh) : SharedFile([&](const std::string &file) { mesh.write(file); }) {}
  ~SharedFile() {
    int rank;
    MPI_Barrier(PETSC_COMM_WORLD);
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    if (rank == 0) std::remove(name_.c_str());
  }
  SharedFile(const SharedFile &) = delete;
  SharedFile &operator=(const SharedFile &) = delete;
  const std::string &name() const { return name_; }

 private:
  static inline int count_ = 0;
  std::string name_;
};

inline double sum(double mine) {
  double all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return all;
}

}  // namespace talus::test
