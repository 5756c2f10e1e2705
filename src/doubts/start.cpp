// The soil at the start, and its depth.
#include <cmath>
#include <limits>

#include "doubts/doubts.h"
#include "physics/laws/strength_by_place.h"
#include "scene/body_source.h"
#include "scene/scene.h"

namespace talus {
namespace {

/// The faces of one side of the soil, found by their place on the level.
class LevelFaces {
 public:
  LevelFaces(const std::vector<SoilFace> &faces, int dimension, int up, double sign) : up_(up) {
    for (int d = 0; d < dimension; ++d)
      if (d != up) level_.push_back(d);
    for (const SoilFace &face : faces)
      if (sign * face.normal[up] > 1e-6) faces_.push_back(face);
    for (const SoilFace &face : faces_)
      for (int d : level_)
        for (int a = 0; a < dimension; ++a)
          low_[d] = std::min(low_[d], face.corner[a][d]), high_[d] = std::max(high_[d], face.corner[a][d]);
    std::array<int, 3> from{}, to{};
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      for (int d : level_) {
        from[d] = strips, to[d] = 0;
        for (int a = 0; a < dimension; ++a)
          from[d] = std::min(from[d], strip(d, faces_[k].corner[a][d])),
          to[d] = std::max(to[d], strip(d, faces_[k].corner[a][d]));
      }
      const int second = level_.back();
      for (int i = from[level_[0]]; i <= to[level_[0]]; ++i)
        for (int j = from[second]; j <= to[second]; ++j) in_[i * strips + j].push_back(static_cast<int>(k));
    }
  }
  const std::vector<SoilFace> &faces() const { return faces_; }

  /// Elevation of the lowest face at a place; not a number where there is none.
  double lowest(const std::array<double, 3> &x) const {
    double found = std::numeric_limits<double>::quiet_NaN();
    for (int k : in_[strip(level_[0], x[level_[0]]) * strips + strip(level_.back(), x[level_.back()])])
      if (const double z = elevation(faces_[k], x); !std::isnan(z) && !(z >= found)) found = z;
    return found;
  }

 private:
  static constexpr int strips = 128;
  int strip(int d, double x) const {
    return std::clamp(static_cast<int>((x - low_[d]) / (high_[d] - low_[d]) * strips), 0, strips - 1);
  }
  /// Of a face at a place on the level; not a number beside it.
  double elevation(const SoilFace &face, const std::array<double, 3> &x) const {
    constexpr double near = 1e-9;
    const auto &c = face.corner;
    const int i = level_[0], j = level_.back();
    if (level_.size() == 1) {
      const double s = (x[i] - c[0][i]) / (c[1][i] - c[0][i]);
      return s >= -near && s <= 1 + near ? c[0][up_] + s * (c[1][up_] - c[0][up_]) : NAN;
    }
    const double a = c[1][i] - c[0][i], b = c[2][i] - c[0][i], p = c[1][j] - c[0][j], q = c[2][j] - c[0][j];
    const double u = ((x[i] - c[0][i]) * q - (x[j] - c[0][j]) * b) / (a * q - b * p),
                 v = ((x[j] - c[0][j]) * a - (x[i] - c[0][i]) * p) / (a * q - b * p);
    if (!(u >= -near && v >= -near && u + v <= 1 + near)) return NAN;
    return c[0][up_] + u * (c[1][up_] - c[0][up_]) + v * (c[2][up_] - c[0][up_]);
  }

  int up_;
  std::vector<int> level_;  ///< axes
  std::vector<SoilFace> faces_;
  std::array<double, 3> low_{1e300, 1e300, 1e300}, high_{-1e300, -1e300, -1e300};
  std::vector<std::vector<int>> in_ = std::vector<std::vector<int>>(strips * strips);  ///< strips of both axes: faces
};

double greatest_depth(const std::vector<SoilFace> &surface, int dimension, int up) {
  const LevelFaces above(surface, dimension, up, 1), below(surface, dimension, up, -1);
  double greatest = 0;
  for (const SoilFace &face : above.faces()) {
    std::array<double, 3> middle{};
    for (int a = 0; a < dimension; ++a)
      for (int d = 0; d < 3; ++d) middle[d] += face.corner[a][d] / dimension;
    if (const double bottom = below.lowest(middle); middle[up] - bottom > greatest) greatest = middle[up] - bottom;
  }
  return greatest;
}

}  // namespace

Start::Start(const Scene &of, std::vector<BodyReport> there, std::vector<SoilFace> faces)
    : scene(of), bodies(std::move(there)), surface(std::move(faces)), up(of.vertical()) {
  constexpr double far = std::numeric_limits<double>::infinity();
  low.fill(far), high.fill(-far);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (b < scene.body.size()) take_largest(laws.emplace_back(read_law(scene.body[b].law)), bodies[b].strength);
    for (int d = 0; d < 3 && bodies[b].particles > 0; ++d)
      low[d] = std::min(low[d], bodies[b].low[d]), high[d] = std::max(high[d], bodies[b].high[d]);
  }
  depth = greatest_depth(surface, scene.dimension, up);
}

double Start::depth_of(std::size_t body, double greatest) const {
  double ground = 0;
  for (const SoilFace &face : surface)
    if (face.body == static_cast<int>(body)) ground += face.area * std::max(0., face.normal[up]);
  return ground > 0 ? std::min(greatest, 2 * bodies[body].volume / ground) : greatest;
}

}  // namespace talus
