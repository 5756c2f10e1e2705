#include "meshes/soundness.h"

#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "meshes/simplex.h"

namespace talus {
namespace {

constexpr double touch = 1e-3;         // cells that overlap or part by less, relative to their edges, touch
constexpr double poor_quality = 0.2;   // from here down a cell costs accuracy and shortens the step
constexpr double tiny_edge = 1. / 50;  // of the mean edge

template <int dim>
using Corners = std::array<Vec<dim>, dim + 1>;

template <int dim>
std::string text_of(const Vec<dim> &x) {
  std::ostringstream text;
  text.precision(4);
  for (int d = 0; d < dim; ++d) text << (d ? ", " : "(") << x[d];
  return text.str() + ") m";
}

template <int dim>
std::string place_of(const Simplices<dim> &cells, const Regions &regions, int cell) {
  Vec<dim> centre{};
  for (const Vec<dim> &x : cells.corners(cell)) map<dim>(centre) += map<dim>(x) / (dim + 1);
  const auto &names = regions.names[regions.combination[cell]];
  return text_of<dim>(centre) + (names.empty() ? "" : " in " + names[0]);
}

/// The extents of two cells along an axis overlap by more than `least`.
template <int dim>
bool overlap_along(const ColumnVector<dim> &axis, const Corners<dim> &a, const Corners<dim> &b, double least) {
  const double length = axis.norm();
  if (length == 0) return true;
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  for (int k = 0; k <= dim; ++k)
    for (int side : {0, 1}) {
      const double s = axis.dot(map<dim>((side ? b : a)[k])) / length;
      low[side] = std::min(low[side], s), high[side] = std::max(high[side], s);
    }
  return std::min(high[0], high[1]) - std::max(low[0], low[1]) > least;
}

/// A cell with what is asked of it again for each other cell.
template <int dim>
struct Solid {
  explicit Solid(const Corners<dim> &corners)
      : corner(corners), simplex(corners), longest(longest_edge<dim>(corners)) {}

  Corners<dim> corner;
  Simplex<dim> simplex;
  double longest;

  /// The normal of a side parts this cell from another: their extents along it overlap by no more than `least`. Along
  /// the gradient of a barycentric coordinate this cell reaches from 0 to 1.
  bool parted_by_side(const Corners<dim> &other, double least) const {
    std::array<std::array<double, dim + 1>, dim + 1> n;  // of each corner of the other cell
    for (int k = 0; k <= dim; ++k) {
      const ColumnVector<dim> from_first = map<dim>(other[k]) - map<dim>(corner[0]);
      n[k][0] = 1;
      for (int d = 0; d < dim; ++d) n[k][d + 1] = map<dim>(simplex.gradient[d]).dot(from_first), n[k][0] -= n[k][d + 1];
    }
    ColumnVector<dim> first = ColumnVector<dim>::Zero();
    for (const auto &gradient : simplex.gradient) first -= map<dim>(gradient);
    for (int side = 0; side <= dim; ++side) {
      double low = n[0][side], high = n[0][side];
      for (int k = 1; k <= dim; ++k) low = std::min(low, n[k][side]), high = std::max(high, n[k][side]);
      const double steepness = side ? map<dim>(simplex.gradient[side - 1]).norm() : first.norm();
      if (std::min(1., high) - std::max(0., low) <= least * steepness) return true;
    }
    return false;
  }
};

/// Two simplices overlap where no axis parts them: normals of sides and, in 3D, of pairs of edges.
template <int dim>
bool overlap(const Solid<dim> &one, const Corners<dim> &b) {
  const Corners<dim> &a = one.corner;
  const double least = touch * std::min(one.longest, longest_edge<dim>(b));
  if (one.parted_by_side(b, least) || Solid<dim>(b).parted_by_side(a, least)) return false;
  if constexpr (dim == 3)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j)
        for (int k = 0; k < 4; ++k)
          for (int l = 0; l < k; ++l) {
            const ColumnVector<3> e = map<3>(a[i]) - map<3>(a[j]), f = map<3>(b[k]) - map<3>(b[l]);
            const ColumnVector<3> axis = e.cross(f);
            if (axis.norm() > 1e-9 * e.norm() * f.norm() && !overlap_along<3>(axis, a, b, least)) return false;
          }
  return true;
}

/// Sets that are united pair by pair.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(int i, int j) { parent_[std::max(of(i), of(j))] = std::min(of(i), of(j)); }

 private:
  std::vector<int> parent_;
};

template <int dim>
class Inspector {
 public:
  Inspector(const Simplices<dim> &cells, const CellTree<dim> &tree, const Regions &regions)
      : cells_(cells), regions_(regions), count_(static_cast<int>(cells.node.size())), tree_(tree), parts_(count_) {}

  std::vector<std::string> remarks() {
    seams();
    lonely_parts();
    slivers();
    edges();
    return std::move(remarks_);
  }

 private:
  /// Free sides with a cell right behind them.
  void seams() {
    int sides = 0, first = -1, behind = -1;
    Box<dim> extent;
    extent.low.fill(1e308), extent.high.fill(-1e308);
    for (int c = 0; c < count_; ++c)
      for (int k = 0; k <= dim; ++k) {
        const int next = cells_.neighbour[c][k];
        if (next >= 0) parts_.unite(c, next);
        if (next >= 0) continue;
        const int other = cell_behind(c, k);
        if (other < 0) continue;
        parts_.unite(c, other);
        ++sides;
        for (int i = 0; i <= dim; ++i)
          if (i != k) extent.enclose({cells_.position[cells_.node[c][i]], cells_.position[cells_.node[c][i]]});
        if (first < 0) first = c, behind = other;
      }
    if (first < 0) return;
    remarks_.push_back(
        std::to_string(sides) + " sides of cells from " + text_of<dim>(extent.low) + " to " +
        text_of<dim>(extent.high) + " touch other cells without being joined to them (first at " +
        place_of(cells_, regions_, first) + ", behind it " + place_of(cells_, regions_, behind) +
        "): the soil is cracked there, and no particle can pass. Merge the nodes (Gmsh: Geometry.AutoCoherence, or "
        "\"Coherence Mesh\"), unless a crack is meant.");
  }

  /// The cell that lies behind a free side, or -1.
  int cell_behind(int cell, int side) const {
    const Corners<dim> corner = cells_.corners(cell);
    const Simplex<dim> simplex(corner);
    ColumnVector<dim> inward = ColumnVector<dim>::Zero(), place = ColumnVector<dim>::Zero();
    if (side > 0)
      inward = map<dim>(simplex.gradient[side - 1]);
    else
      for (const auto &gradient : simplex.gradient) inward -= map<dim>(gradient);
    for (int k = 0; k <= dim; ++k)
      if (k != side) place += map<dim>(corner[k]) / dim;
    place -= touch * longest_edge<dim>(corner) * inward.normalized();
    Vec<dim> x;
    map<dim>(x) = place;
    int found = -1;
    tree_.any({x, x}, [&](int other) {
      if (other == cell || !holds(other, place)) return false;
      found = other;
      return true;
    });
    return found;
  }

  bool holds(int cell, const ColumnVector<dim> &place) const {
    const Corners<dim> corner = cells_.corners(cell);
    const Simplex<dim> simplex(corner);
    double rest = 1;
    for (const auto &gradient : simplex.gradient) {
      const double n = map<dim>(gradient).dot(place - map<dim>(corner[0]));
      if (n < 0) return false;
      rest -= n;
    }
    return rest >= 0;
  }

  void lonely_parts() {
    std::map<int, int> size;
    for (int c = 0; c < count_; ++c) ++size[parts_.of(c)];
    if (size.size() < 2) return;
    const auto largest = std::max_element(size.begin(), size.end(), [](const auto &a, const auto &b) {
                           return a.second < b.second;
                         })->first;
    std::ostringstream text;
    text << "The mesh has " << size.size() << " parts that share no side:";
    int told = 0;
    for (const auto &[cell, cells] : size)
      if (cell != largest && told++ < 3)
        text << (told > 1 ? "," : "") << " one of " << cells << (cells == 1 ? " cell" : " cells") << " at "
             << place_of(cells_, regions_, cell);
    text << (told > 3 ? ", ..." : "") << ". Soil does not pass from one to another.";
    remarks_.push_back(text.str());
  }

  void slivers() {
    int poor = 0, worst = -1;
    double least = poor_quality;
    for (int c = 0; c < count_; ++c) {
      const Corners<dim> corner = cells_.corners(c);
      const double quality = shape<dim>(corner, Simplex<dim>(corner).gradient).quality;
      if (quality < poor_quality) ++poor;
      if (quality < least) least = quality, worst = c;
    }
    if (worst < 0) return;
    std::ostringstream text;
    text.precision(2);
    text << poor << (poor == 1 ? " cell has" : " cells have") << " a quality below " << poor_quality
         << ", which reduces the step and the accuracy; the worst has " << least << ", at "
         << place_of(cells_, regions_, worst) << ".";
    remarks_.push_back(text.str());
  }

  void edges() {
    double sum = 0, shortest = 1e300;
    long long count = 0;
    int of = -1;
    for (int c = 0; c < count_; ++c) {
      const Corners<dim> corner = cells_.corners(c);
      for (int a = 0; a <= dim; ++a)
        for (int b = 0; b < a; ++b) {
          const double length = (map<dim>(corner[a]) - map<dim>(corner[b])).norm();
          sum += length, ++count;
          if (length < shortest) shortest = length, of = c;
        }
    }
    if (of < 0 || shortest > tiny_edge * sum / static_cast<double>(count)) return;
    std::ostringstream text;
    text.precision(3);
    text << "The shortest edge measures " << shortest << " m, at " << place_of(cells_, regions_, of)
         << ", and the mean edge " << sum / static_cast<double>(count) << " m: the shortest determines the step.";
    remarks_.push_back(text.str());
  }

  const Simplices<dim> &cells_;
  const Regions &regions_;
  const int count_;
  const CellTree<dim> &tree_;
  Sets parts_;
  std::vector<std::string> remarks_;
};

}  // namespace

template <int dim>
std::pair<int, int> overlapping_cells(const Simplices<dim> &cells, const CellTree<dim> &tree) {
  for (int c = 0; c < static_cast<int>(cells.node.size()); ++c) {
    const auto &around = cells.neighbour[c];
    if (std::find(around.begin(), around.end(), -1) == around.end()) continue;
    const Solid<dim> solid(cells.corners(c));
    int other = -1;
    const bool found = tree.any(box_around<dim>(solid.corner), [&](int candidate) {
      if (candidate == c || std::find(around.begin(), around.end(), candidate) != around.end()) return false;
      other = candidate;
      return overlap<dim>(solid, cells.corners(candidate));
    });
    if (found) return {c, other};
  }
  return {-1, -1};
}

template <int dim>
std::vector<std::string> mesh_remarks(const Simplices<dim> &cells, const CellTree<dim> &tree, const Regions &regions) {
  return Inspector<dim>(cells, tree, regions).remarks();
}

template std::pair<int, int> overlapping_cells(const Simplices<2> &, const CellTree<2> &);
template std::pair<int, int> overlapping_cells(const Simplices<3> &, const CellTree<3> &);
template std::vector<std::string> mesh_remarks(const Simplices<2> &, const CellTree<2> &, const Regions &);
template std::vector<std::string> mesh_remarks(const Simplices<3> &, const CellTree<3> &, const Regions &);

}  // namespace talus
