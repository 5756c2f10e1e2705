#include "physics/boundary/node_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "base/gather.h"
#include "meshes/near_parts.h"
#include "physics/boundary/prescribed_directions.h"

namespace talus {
namespace {

// An edge between two facets is a true one where the mean normals of the boundary on its two sides, each over
// `edge_reach` facets, differ by more than this [degrees], and the two facets themselves by more than 0.6 times that.
constexpr double edge_angle = 12, edge_reach = 3;
// Facets around a node and its neighbours that differ by less than this are a plane as it was drawn, which stays as it
// is: the cosine of 0.1 degrees.
const double same_plane = std::cos(0.1 * M_PI / 180);
// Passes of the smoothing of normals along a patch; each averages over the facets at a node.
constexpr int normal_smoothings = 4;

/// A facet as other ranks know it: its nodes by their positions.
template <int dim>
struct Tile {
  int source;
  double area;
  Vec<dim> normal;
  std::array<Vec<dim>, dim> corner;  ///< sorted
  auto key() const { return std::tie(source, corner, normal); }
};

/// Facets of all boundaries, those of this rank and of what decides on its normals, with their neighbours and patches.
template <int dim>
class Tiling {
 public:
  explicit Tiling(std::vector<Tile<dim>> tiles) : tiles_(std::move(tiles)) {
    for (const Tile<dim> &t : tiles_) places_.insert(places_.end(), t.corner.begin(), t.corner.end());
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    find_neighbours();
    find_patches();
    find_weights();
    find_means();
    for (int pass = 0; pass < normal_smoothings; ++pass) smooth();
    merge();
  }

  /// Number of the place in the order of positions; -1: no boundary is there.
  int place(const Vec<dim> &position) const {
    const auto found = std::lower_bound(places_.begin(), places_.end(), position);
    return found != places_.end() && *found == position ? static_cast<int>(found - places_.begin()) : -1;
  }
  struct Patch {
    int source, place;
    double area;
    Vec<dim> normal;
    bool plane = true;
  };
  /// Of all places, ascending.
  const std::vector<Patch> &patches() const { return patches_; }

 private:
  using Edge = std::array<int, dim - 1>;  // places, ascending
  using Column = ColumnVector<dim>;

  std::array<int, dim> places_of(int tile) const {
    std::array<int, dim> places;
    for (int k = 0; k < dim; ++k) places[k] = place(tiles_[tile].corner[k]);
    return places;  // ascending, since the corners are
  }
  Column normal(int tile) const { return map<dim>(tiles_[tile].normal); }
  Column centre(int tile) const {
    Column sum = Column::Zero();
    for (const Vec<dim> &x : tiles_[tile].corner) sum += map<dim>(x);
    return sum / dim;
  }
  double size(int tile) const { return dim == 2 ? tiles_[tile].area : std::sqrt(2 * tiles_[tile].area); }

  void find_neighbours() {
    std::map<std::pair<int, Edge>, std::vector<int>> at_edge;
    for (int t = 0; t < count(); ++t) {
      const std::array<int, dim> places = places_of(t);
      for (int k = 0; k < dim; ++k) {
        Edge edge;
        for (int j = 0, n = 0; j < dim; ++j)
          if (j != k) edge[n++] = places[j];
        at_edge[{tiles_[t].source, edge}].push_back(t);
      }
    }
    neighbours_.resize(count());
    for (const auto &[at, tiles] : at_edge)
      for (const int a : tiles)
        for (const int b : tiles)
          if (a != b && normal(a).dot(normal(b)) > sharpest) neighbours_[a].push_back({b, at.second});
  }

  /// Sum of the area vectors of the boundary on the side of tile `a` of its edge with tile `b`.
  Column side(int a, int b, const Edge &edge) const {
    Column middle = Column::Zero();
    for (const int place : edge) middle += map<dim>(places_[place]) / (dim - 1);
    Column away = centre(a) - middle;
    const Column up = (normal(a) + normal(b)).normalized();
    away -= away.dot(up) * up;
    if constexpr (dim == 3) {
      const Column along = (map<dim>(places_[edge[1]]) - map<dim>(places_[edge[0]])).normalized();
      away -= away.dot(along) * along;
    }
    const double radius = edge_reach * 0.5 * (size(a) + size(b));
    std::vector<int> reached{a};
    Column sum = Column::Zero();
    for (size_t i = 0; i < reached.size(); ++i) {
      sum += tiles_[reached[i]].area * normal(reached[i]);
      for (const auto &[next, unused] : neighbours_[reached[i]]) {
        const Column offset = centre(next) - middle;
        if (offset.norm() < radius && offset.dot(away) > 0 &&
            std::find(reached.begin(), reached.end(), next) == reached.end())
          reached.push_back(next);
      }
    }
    return sum.normalized();
  }
  bool is_true_edge(int a, int b, const Edge &edge) const {
    const double of_tiles = normal(a).dot(normal(b));
    if (of_tiles > same_direction) return false;
    const double of_sides = std::acos(std::clamp(side(a, b, edge).dot(side(b, a, edge)), -1., 1.));
    return of_sides > edge_angle * M_PI / 180 && std::acos(std::clamp(of_tiles, -1., 1.)) > 0.6 * of_sides;
  }

  /// Joins the corners of tiles across edges that are no true ones.
  void find_patches() {
    std::vector<int> joined(count() * dim);  // of a corner: the same or another corner of its patch
    std::iota(joined.begin(), joined.end(), 0);
    const auto root = [&](int i) {
      while (joined[i] != i) i = joined[i] = joined[joined[i]];
      return i;
    };
    for (int a = 0; a < count(); ++a)
      for (const auto &[b, edge] : neighbours_[a]) {
        if (b < a || is_true_edge(a, b, edge)) continue;
        const std::array<int, dim> of_a = places_of(a), of_b = places_of(b);
        for (const int place : edge) {
          const int i = root(a * dim + corner(of_a, place)), j = root(b * dim + corner(of_b, place));
          joined[std::max(i, j)] = std::min(i, j);
        }
      }
    std::vector<std::tuple<int, int, int>> roots;  // place, source, corner
    for (int i = 0; i < count() * dim; ++i)
      if (root(i) == i) roots.emplace_back(places_of(i / dim)[i % dim], tiles_[i / dim].source, i);
    std::sort(roots.begin(), roots.end());
    std::vector<int> patch_of_root(count() * dim);
    for (const auto &[place, source, i] : roots) {
      patch_of_root[i] = static_cast<int>(patches_.size());
      patches_.push_back({source, place, 0, {}});
    }
    patch_.resize(count());
    for (int t = 0; t < count(); ++t)
      for (int k = 0; k < dim; ++k) {
        patch_[t][k] = patch_of_root[root(t * dim + k)];
        patches_[patch_[t][k]].area += tiles_[t].area / dim;
      }
  }
  static int corner(const std::array<int, dim> &places, int place) {
    return static_cast<int>(std::find(places.begin(), places.end(), place) - places.begin());
  }

  /// Facets count by area in the means of their patches. At a rim of a surface more of them may lie ahead of the node
  /// than behind it along the rim, as the diagonals go, and the mean normal would be that of a place beside the node.
  /// There the weights grow or fall along the rim, so that the middle of the facets is abreast of the node.
  void find_weights() {
    weight_.resize(count());
    for (int t = 0; t < count(); ++t) weight_[t].fill(tiles_[t].area);
    if constexpr (dim == 3) {
      std::map<std::pair<int, int>, int> facets_at_edge;  // of a patch to another place
      for (int t = 0; t < count(); ++t)
        for (const int p : patch_[t])
          for (const int place : places_of(t)) facets_at_edge[{p, place}] += place != patches_[p].place;
      std::map<int, std::vector<int>> ends;  // of the edges of a rim at a patch
      for (const auto &[edge, facets] : facets_at_edge)
        if (facets == 1) ends[edge.first].push_back(edge.second);
      struct Balance {
        Column along;
        double sum = 0, square = 0;
      };
      std::map<int, Balance> balance;
      for (const auto &[p, places] : ends) {
        if (places.size() != 2) continue;
        const auto way = [&, at = patches_[p].place](int to) -> Column {
          return (map<dim>(places_[to]) - map<dim>(places_[at])).normalized();
        };
        const Column back = way(places[0]), forth = way(places[1]);
        if (back.dot(forth) < straight_rim) balance[p].along = (forth - back).normalized();
      }
      const auto offset = [&](int t, int p, const Balance &b) -> double {
        return (centre(t) - map<dim>(places_[patches_[p].place])).dot(b.along);
      };
      for (int t = 0; t < count(); ++t)
        for (const int p : patch_[t])
          if (const auto b = balance.find(p); b != balance.end()) {
            const double s = offset(t, p, b->second);
            b->second.sum += tiles_[t].area * s, b->second.square += tiles_[t].area * s * s;
          }
      for (int t = 0; t < count(); ++t)
        for (int k = 0; k < dim; ++k)
          if (const auto b = balance.find(patch_[t][k]); b != balance.end())
            weight_[t][k] *= std::max(0., 1 - b->second.sum / b->second.square * offset(t, patch_[t][k], b->second));
    }
  }

  void find_means() {
    for (int t = 0; t < count(); ++t)
      for (int k = 0; k < dim; ++k) map<dim>(patches_[patch_[t][k]].normal) += weight_[t][k] * normal(t);
    for (Patch &patch : patches_) map<dim>(patch.normal).normalize();
    for (int t = 0; t < count(); ++t)
      for (const int p : patch_[t])
        for (const int q : patch_[t]) {
          const Patch &of_node = patches_[p], &near = patches_[q];
          patches_[p].plane &= map<dim>(of_node.normal).dot(map<dim>(near.normal)) > same_plane &&
                               map<dim>(near.normal).dot(normal(t)) > same_plane;
        }
  }

  /// Every patch on relief takes the mean of the facets at its node, and a facet the mean of its nodes.
  void smooth() {
    std::vector<Column> sum(patches_.size(), Column::Zero());
    for (int t = 0; t < count(); ++t) {
      Column mean = Column::Zero();
      for (const int p : patch_[t]) mean += map<dim>(patches_[p].normal);
      for (int k = 0; k < dim; ++k) sum[patch_[t][k]] += weight_[t][k] * mean;
    }
    for (size_t p = 0; p < patches_.size(); ++p)
      if (!patches_[p].plane) map<dim>(patches_[p].normal) = sum[p].normalized();
  }
  /// Relief beside a true edge may divide one side of it. Patches of a node that an edge does not part are one.
  void merge() {
    std::vector<Patch> merged;
    for (const Patch &patch : patches_) {
      auto same = merged.end();  // patches of a place are neighbours in the list
      for (auto other = merged.end(); other != merged.begin() && std::prev(other)->place == patch.place; --other)
        if (std::prev(other)->source == patch.source &&
            map<dim>(std::prev(other)->normal).dot(map<dim>(patch.normal)) > std::cos(edge_angle * M_PI / 180))
          same = std::prev(other);
      if (same == merged.end()) {
        merged.push_back(patch);
        continue;
      }
      map<dim>(same->normal) =
          (same->area * map<dim>(same->normal) + patch.area * map<dim>(patch.normal)).normalized().eval();
      same->area += patch.area;
    }
    patches_ = std::move(merged);
  }
  int count() const { return static_cast<int>(tiles_.size()); }

  static constexpr double sharpest = 0.5;       // cosine of 60 degrees: a sharper edge is always a true one
  static constexpr double straight_rim = -0.5;  // cosine of 120 degrees: a rim that bends more than by 60 has a corner
  std::vector<Tile<dim>> tiles_;
  std::vector<Vec<dim>> places_;
  std::vector<std::vector<std::pair<int, Edge>>> neighbours_;
  std::vector<Patch> patches_;
  std::vector<std::array<int, dim>> patch_;      // of the corners of a tile
  std::vector<std::array<double, dim>> weight_;  // of a tile in the means of these patches
};

/// How far from a node the facets are that decide on its normal, in the largest edges of facets: six around it by the
/// passes of smoothing, and beyond these the sides of an edge with `edge_reach` and a facet.
constexpr double reach = 12;

/// Ranks whose parts of the mesh come as near as that to the part of this rank; other ranks need none of its facets.
template <int dim>
PetscErrorCode ranks_in_reach(const BackgroundMesh<dim> &mesh, const std::vector<Tile<dim>> &tiles,
                              std::vector<int> &near) {
  int rank;
  double edge = 0;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(mesh.comm(), &rank));
  for (const Tile<dim> &t : tiles)
    for (const Vec<dim> &a : t.corner)
      for (const Vec<dim> &b : t.corner) edge = std::max(edge, (map<dim>(a) - map<dim>(b)).norm());
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &edge, 1, MPI_DOUBLE, MPI_MAX, mesh.comm()));
  const std::vector<Box<dim>> boxes = boxes_of_parts(mesh);
  near.clear();
  for (int r = 0; r < static_cast<int>(boxes.size()); ++r)
    if (r != rank && boxes[r].meets(boxes[rank], reach * edge)) near.push_back(r);
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode find_node_normals(const BackgroundMesh<dim> &mesh, const std::vector<SourceFacets<dim>> &sources,
                                 std::vector<NodeNormal<dim>> &normals) {
  PetscFunctionBeginUser;
  std::vector<Tile<dim>> tiles;
  for (const auto &[source, facets] : sources)
    for (const Facet<dim> &f : facets) {
      if (f.cell >= mesh.cells_in_sheet()) continue;  // all sheets have the same normals
      Tile<dim> tile{source, f.area, f.normal, {}};
      for (int k = 0; k < dim; ++k) tile.corner[k] = mesh.position[f.node[k]];
      std::sort(tile.corner.begin(), tile.corner.end());
      tiles.push_back(tile);
    }
  std::vector<int> near;
  PetscCall(ranks_in_reach(mesh, tiles, near));
  PetscCall(gather_from(mesh.comm(), near, tiles));
  std::sort(tiles.begin(), tiles.end(), [](const Tile<dim> &a, const Tile<dim> &b) { return a.key() < b.key(); });
  const Tiling<dim> tiling(std::move(tiles));
  std::vector<int> node_at(tiling.patches().empty() ? 0 : tiling.patches().back().place + 1, -1);
  const int nodes = mesh.nodes_in_sheet();
  for (int node = 0; node < nodes; ++node)
    if (const int place = tiling.place(mesh.position[node]); place >= 0) node_at[place] = node;
  normals.clear();
  for (const auto &patch : tiling.patches())
    for (int s = 0; node_at[patch.place] >= 0 && s < mesh.sheet_count(); ++s)
      normals.push_back({patch.source, s * nodes + node_at[patch.place], patch.normal, patch.area});
  PetscFunctionReturn(0);
}

template PetscErrorCode find_node_normals<2>(const BackgroundMesh<2> &, const std::vector<SourceFacets<2>> &,
                                             std::vector<NodeNormal<2>> &);
template PetscErrorCode find_node_normals<3>(const BackgroundMesh<3> &, const std::vector<SourceFacets<3>> &,
                                             std::vector<NodeNormal<3>> &);

}  // namespace talus
