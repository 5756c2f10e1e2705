#pragma once
/// Writes small Gmsh files without Gmsh: the unit square or cube, its inner nodes shifted, cut into triangles or
/// tetrahedra. Regions: lower (y < 1/2), upper. Facets: base (y = 0), top (y = 1), middle (y = 1/2, inside).
#include <petscsys.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
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

  /// Parts the upper half from the lower one: it gets nodes of its own, moved by (dx, dy).
  void part_upper_half(double dx, double dy) {
    std::map<int, int> own;
    for (std::size_t c = 0; c < cell.size(); ++c)
      for (int &i : cell[c]) {
        if (cell_tag[c] != 2) continue;
        const auto [at, is_new] = own.try_emplace(i, static_cast<int>(node.size()));
        if (is_new) node.push_back({node[i][0] + dx, node[i][1] + dy, node[i][2]});
        i = at->second;
      }
    for (std::size_t f = 0; f < facet.size(); ++f)
      for (int &i : facet[f])
        if (facet_tag[f] == 12) i = own.at(i);
  }

  /// One of the forms in which Gmsh saves a mesh.
  struct Form {
    bool is_new = false;  ///< format 4.1, else 2.2
    bool binary = false;
  };
  void write(const std::string &file) const { write(file, Form{}); }
  void write(const std::string &file, const Form &form) const {
    std::ofstream out(file, std::ios::binary);
    out << content(form);
  }
  std::string content(const Form &form) const {
    Writer out(form.binary);
    out.line(form.is_new ? "$MeshFormat\n4.1 " : "$MeshFormat\n2.2 ", form.binary, " 8");
    if (form.binary) out.integer(1), out.line("");
    out.line("$EndMeshFormat\n$PhysicalNames\n5");
    for (const auto &[tag, name] : std::map<int, const char *>{{1, "lower"}, {2, "upper"}})
      out.line(dim, " ", tag, " \"", name, "\"");
    for (const auto &[tag, name] : std::map<int, const char *>{{11, "base"}, {12, "top"}, {13, "middle"}})
      out.line(dim - 1, " ", tag, " \"", name, "\"");
    out.line("$EndPhysicalNames");
    form.is_new ? write_new(out) : write_old(out);
    return out.text();
  }

 private:
  /// Numbers as text or as they lie in memory.
  class Writer {
   public:
    explicit Writer(bool binary) : binary_(binary) { out_.precision(17); }
    std::string text() const { return out_.str(); }
    template <class... Part>
    void line(const Part &...part) {
      (out_ << ... << part) << "\n";
    }
    void integer(int value) { put(value); }
    void size(std::size_t value) { put(value); }
    void real(double value) { put(value); }
    bool is_binary() const { return binary_; }
    void end_of_line() {
      if (!binary_) out_ << "\n";
    }

   private:
    template <class T>
    void put(T value) {
      if (binary_)
        out_.write(reinterpret_cast<const char *>(&value), sizeof value);
      else
        out_ << value << " ";
    }
    bool binary_;
    std::ostringstream out_;
  };

  void write_old(Writer &out) const {
    out.line("$Nodes\n", node.size());
    for (std::size_t i = 0; i < node.size(); ++i) {
      out.integer(static_cast<int>(i) + 1);
      for (double x : node[i]) out.real(x);
      out.end_of_line();
    }
    out.line("$EndNodes\n$Elements\n", cell.size() + facet.size());
    int id = 0;
    const auto element = [&](int type, int tag, const std::vector<int> &nodes) {
      if (out.is_binary())
        for (int head : {type, 1, 2, ++id}) out.integer(head);
      else
        for (int head : {++id, type, 2}) out.integer(head);
      out.integer(tag), out.integer(tag);
      for (int i : nodes) out.integer(i + 1);
      out.end_of_line();
    };
    for (std::size_t f = 0; f < facet.size(); ++f) element(dim == 3 ? 2 : 1, facet_tag[f], facet[f]);
    for (std::size_t c = 0; c < cell.size(); ++c) element(dim == 3 ? 4 : 2, cell_tag[c], cell[c]);
    out.line("$EndElements");
  }

  /// Each group is an entity of the same number.
  void write_new(Writer &out) const {
    out.line("$Entities");
    for (int d = 0; d < 4; ++d) out.size(d == dim ? 2 : d == dim - 1 ? 3 : 0);
    out.end_of_line();
    const auto entity = [&](int tag) {
      out.integer(tag);
      for (int k = 0; k < 6; ++k) out.real(k / 3);
      out.size(1), out.integer(tag), out.size(0), out.end_of_line();
    };
    for (int tag : {11, 12, 13, 1, 2}) entity(tag);
    out.line("$EndEntities\n$Nodes");
    for (std::size_t n : {std::size_t{1}, node.size(), std::size_t{1}, node.size()}) out.size(n);
    out.end_of_line();
    for (int n : {dim, 1, 0}) out.integer(n);
    out.size(node.size()), out.end_of_line();
    for (std::size_t i = 0; i < node.size(); ++i) out.size(i + 1), out.end_of_line();
    for (const auto &x : node) {
      for (double value : x) out.real(value);
      out.end_of_line();
    }
    out.line("$EndNodes\n$Elements");
    const auto facet_ends = ends_of_blocks(facet_tag), cell_ends = ends_of_blocks(cell_tag);
    const std::size_t all = facet.size() + cell.size();
    for (std::size_t n : {facet_ends.size() + cell_ends.size(), all, std::size_t{1}, all}) out.size(n);
    out.end_of_line();
    std::size_t number = 0;
    const auto blocks = [&](int d, const auto &elements, const auto &tags, const auto &ends) {
      std::size_t begin = 0;
      for (std::size_t end : ends) {
        for (int n : {d, tags[begin], d == 1 ? 1 : d == 2 ? 2 : 4}) out.integer(n);
        out.size(end - begin), out.end_of_line();
        for (; begin < end; ++begin) {
          out.size(++number);
          for (int i : elements[begin]) out.size(i + 1);
          out.end_of_line();
        }
      }
    };
    blocks(dim - 1, facet, facet_tag, facet_ends);
    blocks(dim, cell, cell_tag, cell_ends);
    out.line("$EndElements");
  }

  /// Where runs of equal tags end.
  static std::vector<std::size_t> ends_of_blocks(const std::vector<int> &tags) {
    std::vector<std::size_t> ends;
    for (std::size_t i = 1; i <= tags.size(); ++i)
      if (i == tags.size() || tags[i] != tags[i - 1]) ends.push_back(i);
    return ends;
  }

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
