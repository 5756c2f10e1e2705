#include "physics/boundary/rigid_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

double cross(const Vec<2> &a, const Vec<2> &b) { return a[0] * b[1] - a[1] * b[0]; }
template <std::size_t dim>
std::array<double, dim> from_to(const std::array<double, dim> &a, std::array<double, dim> b) {
  for (std::size_t d = 0; d < dim; ++d) b[d] -= a[d];
  return b;
}

std::vector<Vec<2>> points(const std::vector<std::vector<double>> &corners) {
  std::vector<Vec<2>> all;
  for (const auto &corner : corners) all.push_back({corner[0], corner[1]});
  return all;
}

/// Do two closed pieces of lines have a point in common?
bool meet(const Vec<2> &a, const Vec<2> &b, const Vec<2> &c, const Vec<2> &d) {
  const auto side = [](const Vec<2> &p, const Vec<2> &q, const Vec<2> &r) {
    return cross(from_to(p, q), from_to(p, r));
  };
  const auto apart = [](const Vec<2> &p, const Vec<2> &q, const Vec<2> &r, const Vec<2> &s, int d) {
    return std::max(p[d], q[d]) < std::min(r[d], s[d]) || std::max(r[d], s[d]) < std::min(p[d], q[d]);
  };
  if (apart(a, b, c, d, 0) || apart(a, b, c, d, 1)) return false;
  return side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0;
}

double signed_area(const std::vector<Vec<2>> &corner) {
  double sum = 0;
  for (std::size_t i = 0; i < corner.size(); ++i) sum += cross(corner[i], corner[(i + 1) % corner.size()]) / 2;
  return sum;
}

}  // namespace

std::string problem_of_polygon(const std::vector<std::vector<double>> &corners) {
  const std::size_t count = corners.size();
  if (count < 3) return "must have at least 3 corners [x, y]";
  for (const auto &corner : corners)
    if (corner.size() != 2) return "must have 2 coordinates in each corner, [x, y]";
  const std::vector<Vec<2>> corner = points(corners);
  const auto at = [&](std::size_t i) { return corner[i % count]; };
  for (std::size_t i = 0; i < count; ++i)
    if (at(i) == at(i + 1))
      return "must not have corner " + std::to_string(i) + " twice: the last corner is joined to the first one";
  for (std::size_t i = 0; i < count; ++i) {
    const Vec<2> before = from_to(at(i), at(i + 1)), after = from_to(at(i + 1), at(i + 2));
    if (cross(before, after) == 0 && dot<2>(before, after) < 0)
      return "must not turn back on itself at corner " + std::to_string((i + 1) % count);
    for (std::size_t k = i + 2; k < count - (i == 0); ++k)
      if (meet(at(i), at(i + 1), at(k), at(k + 1)))
        return "must not cross or touch itself, as its sides from corners " + std::to_string(i) + " and " +
               std::to_string(k) + " do: give the corners in their order";
  }
  return "";
}

template <>
RigidShape<2>::RigidShape(const std::vector<std::vector<double>> &corners) : corner_(points(corners)) {
  if (signed_area(corner_) < 0) std::reverse(corner_.begin(), corner_.end());
  volume_ = signed_area(corner_);
  const std::size_t count = corner_.size();
  const Vec<2> origin = corner_[0];  // near the polygon, so that sums do not lose digits
  double square = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec<2> a = from_to(origin, corner_[i]), b = from_to(origin, corner_[(i + 1) % count]), side = from_to(a, b);
    const double length = std::hypot(side[0], side[1]), twice = cross(a, b);
    normal_.push_back({side[1] / length, -side[0] / length});
    for (int d = 0; d < 2; ++d) centre_[d] += twice * (a[d] + b[d]) / (6 * volume_);
    square += twice * (dot<2>(a, a) + dot<2>(a, b) + dot<2>(b, b)) / (12 * volume_);
  }
  square_radius_ = square - dot<2>(centre_, centre_);
  add_scaled<2>(centre_, 1, origin);
}

template <>
RigidShape<3>::RigidShape(const std::vector<std::vector<double>> &corners) {
  for (const auto &c : corners) corner_.push_back({c[0], c[1], c[2]});
  for (std::size_t k = 0; k < corner_.size(); k += 3) {
    const auto a = map<3>(corner_[k]), b = map<3>(corner_[k + 1]), c = map<3>(corner_[k + 2]);
    const double volume = a.dot(b.cross(c)) / 6;
    map<3>(normal_.emplace_back()) = (b - a).cross(c - a).normalized();
    volume_ += volume, map<3>(centre_) += volume / 4 * (a + b + c);
  }
  map<3>(centre_) /= volume_;
  for (Vec<3> &normal : normal_)
    if (volume_ < 0) normal = {-normal[0], -normal[1], -normal[2]};
  volume_ = std::abs(volume_);
}

/// The point of a side that is nearest to x.
template <>
Vec<2> RigidShape<2>::nearest(std::size_t k, const Vec<2> &x) const {
  const Vec<2> &a = corner_[k], side = from_to(a, corner_[(k + 1) % corner_.size()]);
  Vec<2> point = a;
  add_scaled<2>(point, std::clamp(dot<2>(from_to(a, x), side) / dot<2>(side, side), 0., 1.), side);
  return point;
}

/// That of the plane, or of one of the edges.
template <>
Vec<3> RigidShape<3>::nearest(std::size_t k, const Vec<3> &x) const {
  const auto p = map<3>(x);
  const ColumnVector<3> n = map<3>(normal_[k]);
  Vec<3> best{};
  double least = std::numeric_limits<double>::infinity();
  bool beside = false;
  for (int e = 0; e < 3; ++e) {
    const auto a = map<3>(corner_[3 * k + e]), b = map<3>(corner_[3 * k + (e + 1) % 3]),
               c = map<3>(corner_[3 * k + (e + 2) % 3]);
    const ColumnVector<3> side = b - a, inward = n.cross(side);
    beside = beside || inward.dot(p - a) * inward.dot(c - a) < 0;
    const ColumnVector<3> point = a + std::clamp(side.dot(p - a) / side.squaredNorm(), 0., 1.) * side;
    if ((p - point).squaredNorm() < least) least = (p - point).squaredNorm(), map<3>(best) = point;
  }
  if (!beside) map<3>(best) = p - n.dot(p - map<3>(corner_[3 * k])) * n;
  return best;
}

/// By the sides that a ray from x crosses.
template <>
bool RigidShape<2>::inside(const Vec<2> &x) const {
  bool found = false;
  for (std::size_t i = 0; i < corner_.size(); ++i) {
    const Vec<2> &a = corner_[i], &b = corner_[(i + 1) % corner_.size()];
    if ((a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) found = !found;
  }
  return found;
}

/// By the solid angles of the triangles seen from x (van Oosterom & Strackee 1983, IEEE Trans. Biomed. Eng. 30, 125).
template <>
bool RigidShape<3>::inside(const Vec<3> &x) const {
  double angle = 0;
  for (std::size_t k = 0; k < corner_.size(); k += 3) {
    const ColumnVector<3> a = map<3>(corner_[k]) - map<3>(x), b = map<3>(corner_[k + 1]) - map<3>(x),
                          c = map<3>(corner_[k + 2]) - map<3>(x);
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(angle) > 2 * M_PI;
}

template <int dim>
double RigidShape<dim>::distance(const Vec<dim> &x, Vec<dim> &outward) const {
  double square = std::numeric_limits<double>::infinity();
  Vec<dim> away{};
  for (std::size_t k = 0; k < normal_.size(); ++k) {
    const Vec<dim> off = from_to(nearest(k, x), x);
    if (dot<dim>(off, off) < square) square = dot<dim>(off, off), away = off, outward = normal_[k];
  }
  const double distance = (inside(x) ? -1 : 1) * std::sqrt(square);
  constexpr double near = 1e-9;  // to the surface, where a direction away from it is round-off
  if (square > near * near * std::pow(volume_, 2. / dim))
    for (int d = 0; d < dim; ++d) outward[d] = away[d] / distance;
  return distance;
}

template <int dim>
void RigidShape<dim>::move(const Vec<dim> &by) {
  for (Vec<dim> &corner : corner_) add_scaled<dim>(corner, 1, by);
  add_scaled<dim>(centre_, 1, by);
}

template <int dim>
double RigidShape<dim>::reach() const {
  double most = 0;
  for (const Vec<dim> &corner : corner_) most = std::max(most, dot<dim>(corner, corner));
  return std::sqrt(most);
}

template double RigidShape<2>::distance(const Vec<2> &, Vec<2> &) const;
template double RigidShape<3>::distance(const Vec<3> &, Vec<3> &) const;
template void RigidShape<2>::move(const Vec<2> &);
template void RigidShape<3>::move(const Vec<3> &);
template double RigidShape<2>::reach() const;
template double RigidShape<3>::reach() const;

}  // namespace talus
