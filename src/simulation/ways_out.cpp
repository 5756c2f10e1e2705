#include "simulation/ways_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include "output/together.h"

namespace talus {
namespace {

constexpr int unnamed = std::numeric_limits<int>::max();  // the last of all groups

template <int dim>
struct EndFace {
  int cell, face, group;
};

/// The faces of this rank beyond which there is no mesh, each with the first of its groups.
template <int dim>
std::vector<EndFace<dim>> end_faces(const BackgroundMesh<dim> &mesh) {
  std::map<std::pair<int, int>, int> group_of;
  const std::vector<std::string> &names = mesh.group_names();
  for (std::size_t g = 0; g < names.size(); ++g)
    for (const Facet<dim> &facet : mesh.facets(names[g]))
      group_of.insert({{facet.cell, facet.face}, static_cast<int>(g)});
  std::vector<EndFace<dim>> faces;
  for (int c = 0; c < mesh.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k) {
      if (mesh.cells[c].neighbour[k] != boundary) continue;
      const auto found = group_of.find({c, k});
      faces.push_back({c, k, found == group_of.end() ? unnamed : found->second});
    }
  return faces;
}

/// Gradient of the shape function of the node opposite to a face [1/m]: it points into the cell.
template <int dim>
Vec<dim> inward(const Cell<dim> &cell, int face) {
  if (face > 0) return cell.gradient[face - 1];
  Vec<dim> first{};
  for (int a = 0; a < dim; ++a)
    for (int d = 0; d < dim; ++d) first[d] -= cell.gradient[a][d];
  return first;
}

template <std::size_t dim>
double size_of(const std::array<double, dim> &x) {
  return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.));
}

/// Speed at which a velocity leaves a cell through one of its faces [m/s].
template <int dim>
double speed_through(const Cell<dim> &cell, int face, const Vec<dim> &velocity) {
  const Vec<dim> normal = inward(cell, face);
  return -std::inner_product(normal.begin(), normal.end(), velocity.begin(), 0.) / size_of(normal);
}

/// How far a place in or near a cell is from one of its faces [m].
template <int dim>
double distance_from(const Cell<dim> &cell, int face, const Vec<dim> &x) {
  double share[dim + 1];
  share[0] = 1;
  for (int a = 1; a <= dim; ++a) {
    share[a] = 0;
    for (int d = 0; d < dim; ++d) share[a] += cell.gradient[a - 1][d] * (x[d] - cell.origin[d]);
    share[0] -= share[a];
  }
  double distance = 0;
  for (int a = 0; a <= dim; ++a)
    distance = std::max(distance, (a == face ? std::abs(share[a]) : -share[a]) / size_of(inward(cell, a)));
  return distance;
}

/// End faces by the boxes of a level grid that their cells touch.
template <int dim>
class Boxes {
 public:
  explicit Boxes(const BackgroundMesh<dim> &mesh) : mesh_(mesh), faces_(end_faces(mesh)) {
    for (const EndFace<dim> &face : faces_) {
      const auto [low, high] = box_of(face.cell);
      for (int d = 0; d < dim; ++d) size_ = std::max(size_, high[d] - low[d]);
    }
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const auto [low, high] = box_of(faces_[f].cell);
      each_box(low, high, [&](long long key) { in_[key].push_back(static_cast<int>(f)); });
    }
  }

  struct Nearest {
    double distance;  ///< or less than 0: the speed through the face, of several that are next to the place
    int group;
  };
  /// The end face next to a place, in an edge of the mesh that which the velocity leaves through; far away where there
  /// is none near it.
  Nearest nearest(const Vec<dim> &x, const Vec<dim> &velocity) const {
    const double at_once = 1e-6 * size_;
    Nearest best{std::numeric_limits<double>::max(), unnamed};
    each_box(x, x, [&](long long key) {
      const auto found = in_.find(key);
      if (found == in_.end()) return;
      for (const int f : found->second) {
        const Cell<dim> &cell = mesh_.cells[faces_[f].cell];
        double distance = distance_from<dim>(cell, faces_[f].face, x);
        if (distance < at_once) distance = std::min(distance, -speed_through<dim>(cell, faces_[f].face, velocity));
        if (std::pair(distance, faces_[f].group) < std::pair(best.distance, best.group))
          best = {distance, faces_[f].group};
      }
    });
    return best;
  }

 private:
  std::pair<Vec<dim>, Vec<dim>> box_of(int cell) const {
    Vec<dim> low = mesh_.position[mesh_.cells[cell].node[0]], high = low;
    for (const int node : mesh_.cells[cell].node)
      for (int d = 0; d < dim; ++d)
        low[d] = std::min(low[d], mesh_.position[node][d]), high[d] = std::max(high[d], mesh_.position[node][d]);
    return {low, high};
  }
  template <class Visitor>
  void each_box(const Vec<dim> &low, const Vec<dim> &high, Visitor &&visit) const {
    constexpr long long apart = 1 << 20;  // of the numbers of rows of boxes
    long long first[3]{}, last[3]{};
    for (int d = 0; d < dim; ++d)
      first[d] = std::llround(std::floor(low[d] / size_)), last[d] = std::llround(std::floor(high[d] / size_));
    for (long long i = first[0]; i <= last[0]; ++i)
      for (long long j = first[1]; j <= last[1]; ++j)
        for (long long k = first[2]; k <= last[2]; ++k) visit((i * apart + j) * apart + k);
  }

  const BackgroundMesh<dim> &mesh_;
  std::vector<EndFace<dim>> faces_;
  std::unordered_map<long long, std::vector<int>> in_;
  double size_ = 1e-300;  ///< of a box [m]
};

}  // namespace

template <int dim>
std::vector<int> ways_out(const World<dim> &world) {
  std::vector<std::array<Vec<dim>, 2>> mine;
  for (const EscapedParticle<dim> &one : world.escaped.of_this_rank()) mine.push_back({one.position, one.velocity});
  // the mesh may have been divided in another way since, so that the face is on another rank than the particle
  std::vector<std::array<Vec<dim>, 2>> all = gather(world.comm, mine);
  long long count = static_cast<long long>(all.size()), before = 0, here = static_cast<long long>(mine.size());
  MPI_Bcast(&count, 1, MPI_LONG_LONG, 0, world.comm);
  all.resize(static_cast<std::size_t>(count));
  MPI_Bcast(all.data(), static_cast<int>(2 * count * dim), MPI_DOUBLE, 0, world.comm);
  MPI_Exscan(&here, &before, 1, MPI_LONG_LONG, MPI_SUM, world.comm);
  if (rank_in(world.comm) == 0) before = 0;  // of which MPI says nothing
  const Boxes<dim> boxes(world.mesh);
  std::vector<typename Boxes<dim>::Nearest> nearest;
  for (const auto &[x, velocity] : all) nearest.push_back(boxes.nearest(x, velocity));
  MPI_Allreduce(MPI_IN_PLACE, nearest.data(), static_cast<int>(count), MPI_DOUBLE_INT, MPI_MINLOC, world.comm);
  std::vector<int> groups;
  for (long long i = before; i < before + here; ++i)
    groups.push_back(nearest[i].group == unnamed ? -1 : nearest[i].group);
  return groups;
}

template std::vector<int> ways_out(const World<2> &world);
template std::vector<int> ways_out(const World<3> &world);

}  // namespace talus
