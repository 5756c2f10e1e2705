#include "physics/structures/structures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "meshes/locate.h"
#include "physics/laws/update_stress.h"
#include "physics/structures/placed_points.h"
#include "scene/body_source.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/words.h"

namespace talus {
namespace {

constexpr double bond_over_shear = 10;  // bond stiffness over the shear modulus of the soil, where none is given [-]
constexpr double plate_over_bar = 1e3;  // stiffness of a plate over that of the bar at it

/// Mean size of the cells along a line [m]; 0 where there are none. Collective.
template <int dim>
double cell_size_along(const BackgroundMesh<dim> &mesh, const Vec<dim> &from, const Vec<dim> &to) {
  constexpr int looks = 16;
  double sums[2]{};
  for (int k = 0; k < looks; ++k) {
    Vec<dim> x;
    for (int d = 0; d < dim; ++d) x[d] = from[d] + (k + 0.5) / looks * (to[d] - from[d]);
    if (const int cell = find(mesh, x); cell >= 0) sums[0] += std::pow(mesh.volume[cell], 1. / dim), sums[1] += 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh.comm());
  // edge of an equilateral triangle or a regular tetrahedron of this volume
  return sums[1] > 0 ? (dim == 2 ? 1.52 : 2.04) * sums[0] / sums[1] : 0;
}

template <int dim>
double distance(const Vec<dim> &a, const Vec<dim> &b) {
  return (map<dim>(b) - map<dim>(a)).norm();
}

/// The corners of the line, with the end of the free length among them, and their distance from the head.
template <int dim>
std::vector<std::pair<double, Vec<dim>>> corners_of(const BarKeys &keys) {
  std::vector<std::pair<double, Vec<dim>>> corners;
  for (const std::vector<double> &given : keys.points) {
    Vec<dim> x;
    std::copy_n(given.begin(), dim, x.begin());
    if (corners.empty()) {
      corners.emplace_back(0, x);
      continue;
    }
    const auto [at, last] = corners.back();
    const double length = distance<dim>(last, x), free = keys.free_length - at;
    if (free > 0 && free < length) {
      Vec<dim> end;
      for (int d = 0; d < dim; ++d) end[d] = last[d] + free / length * (x[d] - last[d]);
      corners.emplace_back(keys.free_length, end);
    }
    corners.emplace_back(at + length, x);
  }
  return corners;
}

}  // namespace

template <int dim>
Vec<dim> Bar<dim>::along(int e, const std::vector<Vec<dim>> &places) const {
  Vec<dim> unit;
  map<dim>(unit) = (map<dim>(places[e + 1]) - map<dim>(places[e])).normalized();
  return unit;
}

template <int dim>
Vec<dim> Bar<dim>::along_at(int point, const std::vector<Vec<dim>> &places) const {
  Vec<dim> mean = along(std::max(0, point - 1), places);
  if (point == 0 || point == elements()) return mean;
  const Vec<dim> next = along(point, places);
  if (const ColumnVector<dim> sum = map<dim>(mean) + map<dim>(next); sum.norm() > 1e-6)
    map<dim>(mean) = sum.normalized();
  return mean;
}

template <int dim>
double Bar<dim>::normal_stress(const Vec<dim> &along, const Eigen::Matrix3d &stress, int up) const {
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  for (int d = 0; d < dim; ++d) t[d] = along[d];
  if (!keys.sheet) return (stress.trace() - t.dot(stress * t)) / 2;
  Eigen::Vector3d n = Eigen::Vector3d::Unit(up) - t[up] * t;  // upwards, across the sheet
  if (n.norm() < 1e-6) n = Eigen::Vector3d::Unit((up + 1) % dim);
  n.normalize();
  return n.dot(stress * n);
}

template <int dim>
void Bar<dim>::set_bond(int i, double normal_stress, bool drawn) {
  BondPoint &p = chain.point[i];
  auto [from, to] = bond_span[i];
  if (drawn) {
    from = std::max(from, chain.point.front().slip);
    to = std::max(from, std::min(to, at.back() + chain.point.back().slip));
  }
  const double soil = keys.bond_stiffness > 0 ? keys.bond_stiffness : bond_over_shear * shear_modulus[i];
  const double friction = std::max(0., -normal_stress) * std::tan(keys.bond_friction_angle);
  const double per_length =
      keys.bond_strength > 0 ? keys.bond_strength : keys.perimeter * (keys.bond_adhesion + friction);
  p.limit = in_soil[i] ? share * (to - from) * per_length : 0;
  p.stiffness = share * bonded(i) * soil;
  if (i > 0 || keys.plate_capacity == 0 || !in_soil[0]) return;
  p.limit += share * keys.plate_capacity;
  p.stiffness += plate_over_bar * share * keys.axial_stiffness / chain.element[0].length;
}

template <int dim>
void Bar<dim>::find_absent() {
  for (int e = 0; e < elements(); ++e) chain.element[e].absent = !in_soil[e] || !in_soil[e + 1];
}

template <int dim>
double Bar<dim>::bond_force(int i) const {
  const BondPoint &p = chain.point[i];
  const double plate = i == 0 ? keys.plate_capacity : 0;
  return bonded(i) > 0 && p.limit > 0 ? p.force / share * (1 - share * plate / p.limit) : 0;
}

template <int dim>
double Bar<dim>::utilisation(int element) const {
  const double axial = force(element), limit = axial < 0 ? keys.compressive_capacity : keys.tensile_capacity;
  return axial == 0 ? 0 : std::abs(axial) / limit;
}

template <int dim>
typename Bar<dim>::Report Bar<dim>::report() const {
  Report report;
  if (!present) return report;
  constexpr double nearly = 1 - 1e-6;
  double all = 0;
  report.head = force(0);
  for (int e = 0; e < elements(); ++e) {
    if (std::abs(force(e)) > std::abs(report.largest)) report.largest = force(e);
    report.utilisation = std::max(report.utilisation, utilisation(e));
  }
  for (int i = 0; i < points(); ++i) {
    const BondPoint &p = chain.point[i];
    if (std::abs(p.slip) > std::abs(report.slip)) report.slip = p.slip;
    all += bonded(i);
    const bool bonds = p.limit > 0 || p.slip != 0;  // or did before it was drawn out
    if (bonds && std::abs(p.force) >= nearly * p.limit / chain.divisor) report.slipping += bonded(i);
  }
  if (all > 0) report.slipping /= all;
  return report;
}

template <int dim>
Structures<dim>::Structures(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws)
    : up_(scene.vertical()) {
  for (const StructureSource &source : scene.structure) {
    Bar<dim> &bar = bars_.emplace_back();
    bar.name = source.name, bar.keys = source.bar();
    bar.share = bar.keys.spacing > 0 ? 1 / bar.keys.spacing : 1;
    const auto corners = corners_of<dim>(bar.keys);
    bar.place.push_back(corners[0].second), bar.at.push_back(0), bar.bond_span.push_back({0, 0});
    for (std::size_t k = 1; k < corners.size(); ++k) {
      const auto &[from, start] = corners[k - 1];
      const auto &[to, end] = corners[k];
      const double size = cell_size_along<dim>(mesh, start, end), length = to - from;
      const bool bonds = to > bar.keys.free_length;
      const int parts = bonds && size > 0 ? std::max(1, static_cast<int>(std::ceil(length / size - 1e-6))) : 1;
      for (int part = 1; part <= parts; ++part) {
        Vec<dim> x;
        for (int d = 0; d < dim; ++d) x[d] = start[d] + part * (end[d] - start[d]) / parts;
        bar.place.push_back(x), bar.at.push_back(from + part * length / parts);
        BarElement &one = bar.chain.element.emplace_back();
        one.length = length / parts;
        one.stiffness = bar.share * bar.keys.axial_stiffness / one.length;
        one.tension = bar.share * bar.keys.tensile_capacity;
        one.compression = bar.share * bar.keys.compressive_capacity;
        Vec<dim> along;
        map<dim>(along) = (map<dim>(end) - map<dim>(start)) / length;
        bar.direction.push_back(along);
        bar.bond_span.push_back({bar.at.back(), bar.at.back()});
        if (!bonds) continue;
        bar.bond_span.end()[-2][1] += one.length / 2, bar.bond_span.back()[0] -= one.length / 2;
      }
    }
    bar.chain.point.resize(bar.points());
    bar.in_soil.assign(bar.points(), 0);
    bar.now = bar.part_place = bar.place;
    bar.present = std::ranges::none_of(scene.stage, [&](const Stage &s) { return s.adds(bar.name); });
  }
  find_soil(mesh, scene, laws);
}

template <int dim>
void Structures<dim>::find_soil(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws) {
  std::vector<int> body_of(mesh.cell_count(), -1), cells;
  for (std::size_t b = 0; b < scene.body.size(); ++b)
    for (const std::string &region : scene.body[b].region)
      for (const int cell : mesh.region(region)) body_of[cell] = static_cast<int>(b);
  for (int c = 0; c < mesh.cell_count(); ++c)
    if (body_of[c] >= 0) cells.push_back(c);
  std::vector<Vec<dim>> points;
  for (const Bar<dim> &bar : bars_) points.insert(points.end(), bar.place.begin(), bar.place.end());
  std::vector<double> modulus(points.size(), 0);
  std::vector<char> found;
  for (const PlacedPoint<dim> &one : place_points<dim>(mesh, cells, points, &found))
    modulus[one.point] = shear_modulus(laws[body_of[one.cell]]);
  MPI_Allreduce(MPI_IN_PLACE, modulus.data(), static_cast<int>(modulus.size()), MPI_DOUBLE, MPI_SUM, mesh.comm());
  std::size_t next = 0;
  for (Bar<dim> &bar : bars_)
    for (int i = 0; i < bar.points(); ++i, ++next) {
      if (!found[next]) {
        std::string place;
        for (int d = 0; d < dim; ++d) place += (d ? ", " : "(") + shortest(points[next][d]);
        scene.complain("structure." + bar.name + ".points", "must lie in soil, and " + place + ") m does not");
      }
      bar.shear_modulus.push_back(modulus[next]);
    }
}

template <int dim>
void Structures<dim>::begin_stage(const Stage &stage) {
  for (Bar<dim> &bar : bars_) {
    for (BarElement &one : bar.chain.element) one.held = 0;
    const bool there = begun_ && bar.present, was = bar.present;
    if (stage.removes(bar.name)) bar.present = false;
    if (stage.adds(bar.name)) bar.present = true;
    bar.fresh = bar.present && !there;
    changes_ += bar.present != was;
    if (!bar.fresh) continue;
    for (int e = 0; e < bar.elements() && bar.keys.prestress > 0; ++e)
      if (bar.at[e + 1] <= bar.keys.free_length * (1 + 1e-9))
        bar.chain.element[e].pull = bar.share * bar.keys.prestress, bar.chain.element[e].held = 1;
  }
  begun_ = true;
}

template <int dim>
void Structures<dim>::serialize(Archive &archive) {
  if (any()) archive.serialize("structures", begun_);
  for (Bar<dim> &bar : bars_) {
    std::vector<double> elements, points;
    for (const BarElement &one : bar.chain.element)
      elements.insert(elements.end(), {one.pull, one.yielded, one.held ? 1. : 0., one.torn ? 1. : 0.});
    for (const BondPoint &one : bar.chain.point) points.insert(points.end(), {one.force, one.slip});
    archive.serialize("structure", bar.present, bar.softened, bar.now, bar.part_place, elements, points);
    for (std::size_t e = 0; archive.reading() && e < bar.chain.element.size(); ++e) {
      BarElement &one = bar.chain.element[e];
      const double *stored = &elements.at(4 * e);
      one.pull = stored[0], one.yielded = stored[1], one.held = stored[2] != 0, one.torn = stored[3] != 0;
    }
    for (std::size_t i = 0; archive.reading() && i < bar.chain.point.size(); ++i)
      bar.chain.point[i].force = points.at(2 * i), bar.chain.point[i].slip = points.at(2 * i + 1);
  }
}

template struct Bar<2>;
template struct Bar<3>;
template class Structures<2>;
template class Structures<3>;

}  // namespace talus
