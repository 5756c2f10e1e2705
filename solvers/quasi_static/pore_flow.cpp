#include "solvers/quasi_static/pore_flow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/local_numbers.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/water_source.h"
#include "solvers/quasi_static/faces_inside.h"
#include "solvers/quasi_static/unnamed_faces.h"

namespace talus {
namespace {

constexpr double earth = 9.81;  // [m/s2], for a hydraulic conductivity in a scene without gravity
/// Share of pressures and water contents by which their differences are never said to be smaller: water that does not
/// move at all would be sought to within round-off.
constexpr double hardly = 1e-6;
/// Barycentric coordinates of the Gauss points of a face, as many as it has corners: they lie inside, so that a
/// function that jumps at an edge of the mesh is integrated exactly.
template <int dim>
constexpr double near_gauss = dim == 2 ? 0.78867513459481287 : 2. / 3;
template <int dim>
constexpr double far_gauss = dim == 2 ? 0.21132486540518713 : 1. / 6;

}  // namespace

template <int dim>
std::vector<int> bodies_of_cells(const BackgroundMesh<dim> &mesh, const Scene &scene) {
  std::vector<int> body(mesh.cell_count(), -1);
  for (size_t b = 0; b < scene.body.size(); ++b)
    for (const std::string &region : scene.body[b].region)
      for (int cell : mesh.region(region)) body[cell] = static_cast<int>(b);
  return body;
}

template <int dim>
PoreFlow<dim>::PoreFlow(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Source> &sources,
                        bool suction, const std::vector<Source> &more)
    : mesh_(mesh),
      scene_(scene),
      sources_(sources),
      shared_sources_(sources.size()),
      body_of_(bodies_of_cells(mesh, scene)),
      suction_(suction),
      bishop_(scene.water->stress == PoreStress::bishop),
      liquid_(*scene.water) {
  double square = 0;
  for (int d = 0; d < dim; ++d)
    gravity_[d] = scene.gravity[d], upward_[d] = scene.upward()[d], square += gravity_[d] * gravity_[d];
  for (const BodySource &body : scene.body)
    soils_.emplace_back(body, scene.water->density * (square > 0 ? std::sqrt(square) : earth), scene.water->viscosity);
  mean_permeability_.resize(soils_.size());
  for (int b = 0; b < static_cast<int>(soils_.size()); ++b)
    if (has_curve(b)) mean_permeability_[b].emplace(soils_[b]);
  pressure_of_point_.assign(mesh_.element_plex().number.size(), std::numeric_limits<double>::quiet_NaN());
  sources_.insert(sources_.end(), more.begin(), more.end());
  inflow_.assign(sources_.size() + 1, 0);
}

template <int dim>
double PoreFlow<dim>::unit_weight() const {
  double square = 0;
  for (double g : gravity_) square += g * g;
  return liquid_.density * std::sqrt(square);
}

template <int dim>
void PoreFlow<dim>::serialize(Archive &archive) {
  std::vector<long long> wet, present, numbers;  // points with a pressure, now or before; nodes that are there now
  std::vector<double> pressures;
  for (int i = 0; i < nodes_.count(); ++i) {
    if (!archive.reading()) pressure_of_point_[nodes_.point[i]] = accepted[i];
    present.push_back(nodes_.number[i]);
  }
  for (size_t p = 0; p < pressure_of_point_.size(); ++p) {
    numbers.push_back(mesh_.element_plex().number[p]);
    if (archive.reading() || std::isnan(pressure_of_point_[p])) continue;
    wet.push_back(numbers.back()), pressures.push_back(pressure_of_point_[p]);
  }
  archive.column(archive.rows("wet nodes", Belongs::to_points, wet), "accepted pressure", pressures);
  const LocalNumbers node_of(present), point_of(numbers);
  std::vector<double> trial = pressure, above = above_mean;
  std::vector<char> open = open_;
  const Archive::Rows rows = archive.rows("nodes of flow", Belongs::to_points, present);
  archive.column(rows, "pressure of flow", trial);
  archive.column(rows, "open seepage faces", open);
  archive.column(rows, "pressure above the mean of particles", above);
  archive.sums("inflow", inflow_);
  if (!archive.reading()) return;
  std::fill(pressure_of_point_.begin(), pressure_of_point_.end(), std::numeric_limits<double>::quiet_NaN());
  for (size_t k = 0; k < wet.size(); ++k)  // of a node between ranks this one may have no soil
    if (const int p = point_of.find(wet[k]); p >= 0) pressure_of_point_[p] = pressures[k];
  for (int i = 0; i < nodes_.count(); ++i) accepted[i] = pressure_of_point_[nodes_.point[i]];
  for (size_t k = 0; k < present.size(); ++k)
    if (const int i = node_of.find(present[k]); i >= 0)
      pressure[i] = trial[k], open_[i] = open[k], above_mean[i] = above[k];
}

// ---- cells and boundaries ----

template <int dim>
PetscErrorCode PoreFlow<dim>::activate(const std::vector<char> &active,
                                       const std::function<double(const Vec<dim> &)> &fresh) {
  PetscFunctionBeginUser;
  for (int i = 0; i < nodes_.count(); ++i) pressure_of_point_[nodes_.point[i]] = accepted[i];
  active_ = active;
  PetscCall(nodes_.setup(mesh_, 1, active_, 1));
  accepted.resize(nodes_.count());
  std::vector<PetscInt> wet(nodes_.count(), 0);  // new nodes at a jump from suction to water, as beside a water table
  for (int i = 0; i < nodes_.count(); ++i) {
    accepted[i] = pressure_of_point_[nodes_.point[i]];
    if (!std::isnan(accepted[i])) continue;
    accepted[i] = fresh(nodes_.position[i]);
    wet[i] = accepted[i] < 0 ? -1 : 0;
  }
  for (int c = 0; c < mesh_.cell_count(); ++c)
    for (int a = 0; a <= dim && active_[c]; ++a) {
      const int node = nodes_.of_cell(c)[a];
      if (wet[node] >= 0) continue;
      Vec<dim> inside = nodes_.position[node];
      constexpr double little = 1e-6;  // of the way to the middle of the cell
      for (int b = 0; b <= dim; ++b)
        for (int d = 0; d < dim; ++d)
          inside[d] += little / (dim + 1) * (nodes_.position[nodes_.of_cell(c)[b]][d] - nodes_.position[node][d]);
      if (fresh(inside) >= 0) wet[node] = 1;
    }
  PetscCall(nodes_.maximum(wet));
  for (int i = 0; i < nodes_.count(); ++i)
    if (wet[i] > 0) accepted[i] = 0;
  pressure = accepted;
  above_mean.assign(nodes_.count(), 0);
  body_of_node_.assign(nodes_.count(), 0);
  for (int c = 0; c < mesh_.cell_count(); ++c)
    for (int a = 0; a <= dim && active_[c]; ++a) body_of_node_[nodes_.of_cell(c)[a]] = body_of_[c];

  const std::vector<char> active_across = mesh_.across(active_);  // is there soil across a face of the partition?
  const auto soil_across = [&](int neighbour) {
    if (neighbour == boundary) return false;
    if (neighbour >= 0) return active_[neighbour] != 0;
    return active_across[-2 - neighbour] != 0;
  };

  std::vector<PetscInt> beyond(nodes_.count(), -1), surface(nodes_.count(), 0);
  supplies_.clear(), pressed_faces_.clear(), layers_ = {};
  const int count =
      static_cast<int>(sources_.size()) +
      1;  // order in which boundaries count where several meet at a node: pressures, open water, rain, the atmosphere
  const auto put = [&](const Facet<dim> &facet, int source, int rank, bool supplied) {
    const auto corners = nodes_.of_facet(facet.cell, facet.face);
    if (rank >= 2) pressed_faces_.push_back(facet);
    for (int node : corners) {
      if (!soil_across(mesh_.cells[facet.cell].neighbour[facet.face])) surface[node] = 1;
      if (rank >= 0) beyond[node] = std::max<PetscInt>(beyond[node], rank * count + source + 1);
      if (!supplied) continue;
      Supply supply{node, source, facet.area / dim, dot<dim>(facet.normal, upward_), {}};
      int further = 1;
      for (int nearest : corners) {
        Vec<dim> &place = supply.place[nearest == node ? 0 : further++];
        for (int corner : corners) {
          const double share = corner == nearest ? near_gauss<dim> : far_gauss<dim>;
          for (int d = 0; d < dim; ++d) place[d] += share * nodes_.position[corner][d];
        }
      }
      supplies_.push_back(supply);
    }
  };
  const auto put_source = [&](const Facet<dim> &facet, int s) {
    const Boundary &kind = sources_[s].kind;
    const bool seeps = kind.water == OnWater::seepage;
    put(facet, s,
        kind.water == OnWater::pressure ? 3
        : seeps && kind.open_water      ? 2
        : seeps                         ? 1
                                        : -1,
        seeps || kind.water == OnWater::flux);
  };
  int rain = atmosphere;
  const FacesInside<dim> inside(mesh_, scene_);
  for (int s = 0; s < static_cast<int>(sources_.size()); ++s) {
    const Boundary &kind = sources_[s].kind;
    if (kind.water == OnWater::surface) continue;
    for (const std::string &group : sources_[s].groups) {
      if (kind.fluids_only() && group == free_surface) rain = s;
      if (!mesh_.has_group(group)) continue;
      for (const Facet<dim> &f : mesh_.facets(group)) {
        if (!active_[f.cell] || (soil_across(mesh_.cells[f.cell].neighbour[f.face]) && !inside.holds(f))) continue;
        if (kind.water != OnWater::wall) put_source(f, s);
      }
    }
  }
  for (const Facet<dim> &facet : unnamed_faces(mesh_, active_, sources_))
    if (rain == atmosphere)
      put(facet, atmosphere, suction_ ? 0 : 3, false);
    else
      put_source(facet, rain);
  PetscCall(nodes_.maximum(beyond));
  PetscCall(nodes_.maximum(surface));
  at_surface_.assign(surface.begin(), surface.end());
  pressed_.assign(nodes_.count(), none);
  may_close_.assign(nodes_.count(), 0), fixed_ = open_ = layered_ = may_close_;
  for (int i = 0; i < nodes_.count(); ++i)
    if (beyond[i] >= 0)
      pressed_[i] = static_cast<int>(beyond[i] % count) - 1, may_close_[i] = beyond[i] / count < 3,
      open_[i] = accepted[i] >= 0;
  PetscFunctionReturn(0);
}

template <int dim>
double PoreFlow<dim>::outside(int node, double t) const {
  if (pressed_[node] < 0) return 0;
  return outside(pressed_[node], nodes_.position[node], t);
}

template <int dim>
double PoreFlow<dim>::outside(int source, const Vec<dim> &x, double t) const {
  return sources_[source].kind.outside(x[0], x[1], dim == 3 ? x[dim - 1] : 0, t, {unit_weight(), x[scene_.vertical()]});
}

template <int dim>
void PoreFlow<dim>::drain_in_layers(const std::vector<double> &storage) {
  std::vector<typename DrainedLayers<dim>::Face> faces;
  for (const Facet<dim> &f : pressed_faces_) {
    const int body = body_of_[f.cell];
    faces.push_back({{}, f.area, dim * mesh_.volume[f.cell] / f.area, conductivity(f.cell), 0});
    if (!has_curve(body)) faces.back().storage = storage[body];
    std::ranges::copy(nodes_.of_facet(f.cell, f.face), faces.back().node.begin());
  }
  layers_.setup(nodes_, std::move(faces));
}

template <int dim>
PetscErrorCode PoreFlow<dim>::begin(double t, double travel, double from, double to) {
  PetscFunctionBeginUser;
  pressure = accepted, travel_ = travel;
  beyond_.assign(nodes_.count(), 0);
  PetscCall(layers_.begin(from, to));
  for (int i = 0; i < nodes_.count(); ++i) {
    if (pressed_[i] == none) continue;
    const double p = beyond_[i] = outside(i, t);
    layered_[i] = layers_.at(i) && (!may_close_[i] || p > 0);
    fixed_[i] = !layered_[i] && (!may_close_[i] || p > 0 || open_[i]);  // below open water the pressure is its own
    if (fixed_[i]) pressure[i] = p;
    if (p > 0) open_[i] = 1;  // once the water level has fallen below the node, water seeps out here at first
  }
  PetscFunctionReturn(0);
}

template <int dim>
bool PoreFlow<dim>::update_seepage(const std::vector<double> &rest) {
  int changed = 0;
  double scale = 0;
  for (double p : pressure) scale = std::max(scale, std::abs(p));
  MPI_Allreduce(MPI_IN_PLACE, &scale, 1, MPI_DOUBLE, MPI_MAX, nodes_.comm());
  for (int i = 0; i < nodes_.count(); ++i) {
    if (!may_close_[i] || layered_[i]) continue;
    if (fixed_[i] && pressure[i] == 0 && rest[i] > 0)
      fixed_[i] = open_[i] = 0, changed = 1;  // the node would draw in more than the supply
    else if (!fixed_[i] && pressure[i] > 1e-9 * scale)
      fixed_[i] = open_[i] = 1, pressure[i] = 0, changed = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, nodes_.comm());
  return changed;
}

// ---- storage and flow ----

template <int dim>
double PoreFlow<dim>::saturation_of(int body, double p) const {
  return has_curve(body) && p < 0 ? talus::saturation(soils_[body].retention(), -p) : 1;
}
template <int dim>
double PoreFlow<dim>::saturation_slope_of(int body, double p) const {
  return has_curve(body) && p < 0 ? -talus::saturation_slope(soils_[body].retention(), -p) : 0;
}
/// Gradients of the shape functions 0..dim.
template <int dim>
std::array<Vec<dim>, dim + 1> all_gradients(const Cell<dim> &cell) {
  std::array<Vec<dim>, dim + 1> gradient{};
  for (int k = 0; k < dim; ++k)
    for (int d = 0; d < dim; ++d) gradient[k + 1][d] = cell.gradient[k][d], gradient[0][d] -= cell.gradient[k][d];
  return gradient;
}

template <int dim>
CellPermeability<dim> PoreFlow<dim>::relative_permeability(int c, const std::array<Vec<dim>, dim + 1> &gradient,
                                                           bool with_slope) const {
  const int body = body_of_[c];
  if (!has_curve(body)) return {};
  std::array<double, dim + 1> at;
  for (int a = 0; a <= dim; ++a) at[a] = pressure[nodes_.of_cell(c)[a]];
  return cell_permeability<dim>(soils_[body], *mean_permeability_[body], at, gradient, unit_weight(), with_slope);
}
template <int dim>
double PoreFlow<dim>::content(int body, double p) const {
  return soils_[body].porosity() * saturation_of(body, p) * liquid_.density_at(p) / liquid_.density;
}
template <int dim>
double PoreFlow<dim>::content_slope(int body, double p) const {
  const double rho = liquid_.density_at(p);
  return soils_[body].porosity() *
         (saturation_slope_of(body, p) * rho + saturation_of(body, p) * liquid_.density_slope(rho)) / liquid_.density;
}

template <int dim>
double PoreFlow<dim>::inflow_at(const Supply &supply, double t) const {
  const Boundary &kind = sources_[supply.source].kind;
  double mean = 0;
  for (int g = 0; g < dim; ++g) {
    const Vec<dim> &x = supply.place[g];
    const double z = dim == 3 ? x[dim - 1] : 0;
    const double share = g == 0 ? near_gauss<dim> : far_gauss<dim>;
    for (const double later : {near_gauss<2>, far_gauss<2>}) {  // at two times of the step
      const double then = t - later * travel_;
      mean += share / 2 *
              (kind.water == OnWater::flux ? kind.inflow(x[0], x[1], z, then)
                                           : kind.supply(x[0], x[1], z, then, supply.upward));
    }
  }
  return mean;
}

template <int dim>
void PoreFlow<dim>::balance(double t, double dt, WaterBalance *balance) const {
  balance->rest.assign(nodes_.count(), 0), balance->size = balance->rest;
  const auto add = [&](int node, double value, double size) {
    balance->rest[node] += value, balance->size[node] += size;
  };
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (!active_[c]) continue;
    const int *node = nodes_.of_cell(c), body = body_of_[c];
    Vec<dim> drive{};
    const auto gradient = all_gradients<dim>(mesh_.cells[c]);
    double slope = 0, weight = 0;
    for (int a = 0; a <= dim; ++a)
      for (int d = 0; d < dim; ++d) drive[d] += pressure[node[a]] * gradient[a][d];
    for (int d = 0; d < dim; ++d)
      slope += drive[d] * drive[d], drive[d] -= liquid_.density * gravity_[d], weight += gravity_[d] * gravity_[d];
    const double conducts = dt * mesh_.volume[c] * conductivity(c) * relative_permeability(c, gradient, false).value,
                 pores = mesh_.volume[c] / (dim + 1);
    double length[dim + 1], steepest = 0;
    for (int a = 0; a <= dim; ++a) {
      length[a] = map<dim>(gradient[a]).norm();
      steepest += length[a] * std::abs(pressure[node[a]]);
    }
    const double drives = std::sqrt(slope) + liquid_.density * std::sqrt(weight) + hardly * steepest;
    for (int a = 0; a <= dim; ++a) {
      double flux = 0;
      for (int d = 0; d < dim; ++d) flux += drive[d] * gradient[a][d];
      add(node[a], conducts * flux, conducts * length[a] * drives);
      const double before = content(body, accepted[node[a]]), stored = content(body, pressure[node[a]]) - before;
      add(node[a], pores * stored, pores * (std::abs(stored) + hardly * before));
    }
  }
  for (const Supply &s : supplies_) {
    const double water = dt * s.area * inflow_at(s, t);
    add(s.node, -water, std::abs(water));
  }
  for (int i = 0; i < nodes_.count(); ++i)
    if (layered_[i]) add(i, out_of_layer(i), std::abs(out_of_layer(i)));
}

template <int dim>
PetscErrorCode PoreFlow<dim>::tangent(double dt, bool newton, SparseMatrix &matrix) const {
  PetscFunctionBeginUser;
  double largest = 0;
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (!active_[c]) continue;
    const int *node = nodes_.of_cell(c), body = body_of_[c];
    Vec<dim> drive{};
    const auto gradient = all_gradients<dim>(mesh_.cells[c]);
    const CellPermeability<dim> passes = relative_permeability(c, gradient, newton);
    for (int a = 0; a <= dim; ++a)
      for (int d = 0; d < dim; ++d) drive[d] += pressure[node[a]] * gradient[a][d];
    for (int d = 0; d < dim; ++d) drive[d] -= liquid_.density * gravity_[d];
    const double conducts = dt * mesh_.volume[c] * conductivity(c);
    double entry[(dim + 1) * (dim + 1)];
    PetscInt row[dim + 1];
    for (int a = 0; a <= dim; ++a) {
      row[a] = fixed_[node[a]] ? -1 : nodes_.global()[node[a]];
      double flux = 0;
      for (int d = 0; d < dim; ++d) flux += drive[d] * gradient[a][d];
      for (int b = 0; b <= dim; ++b) {
        double cross = 0;
        for (int d = 0; d < dim; ++d) cross += gradient[a][d] * gradient[b][d];
        entry[a * (dim + 1) + b] = conducts * (passes.value * cross + passes.slope[b] * flux);
      }
      entry[a * (dim + 2)] += mesh_.volume[c] / (dim + 1) * content_slope(body, pressure[node[a]]);
      largest = std::max(largest, std::abs(entry[a * (dim + 2)]));
    }
    PetscCall(matrix.add(dim + 1, row, dim + 1, row, entry));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, nodes_.comm()));
  for (int i = 0; i < nodes_.count(); ++i)
    if (fixed_[i] && nodes_.owned[i])
      PetscCall(matrix.add(1, &nodes_.global()[i], 1, &nodes_.global()[i], &largest));
    else if (const double passes = layered_[i] ? layers_.passes(i) : 0; passes > 0)
      PetscCall(matrix.add(1, &nodes_.global()[i], 1, &nodes_.global()[i], &passes));
  PetscFunctionReturn(0);
}

template <int dim>
void PoreFlow<dim>::commit(double t, double dt, const std::vector<double> &rest) {
  accepted = pressure;
  std::fill(inflow_.begin(), inflow_.end(), 0.);
  for (int i = 0; i < nodes_.count(); ++i) {
    const double water = layered_[i] ? -out_of_layer(i) : fixed_[i] && nodes_.owned[i] ? rest[i] : 0;
    if (water == 0) continue;
    entered_ += liquid_.density * water;
    (pressed_[i] >= 0 ? inflow_[pressed_[i]] : inflow_.back()) += water / dt;
  }
  for (const Supply &s : supplies_) {
    const double water = s.area * inflow_at(s, t);
    inflow_[s.source] += water, entered_ += liquid_.density * water * dt;
  }
}

template <int dim>
double PoreFlow<dim>::take_entered() {
  double sum = std::exchange(entered_, 0);
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, nodes_.comm());
  return sum;
}

template <int dim>
double PoreFlow<dim>::stored() const {
  double sum = 0;
  for (int c = 0; c < mesh_.cell_count(); ++c)
    for (int a = 0; a <= dim && active_[c]; ++a) {
      const int i = nodes_.of_cell(c)[a], body = body_of_[c];
      sum += mesh_.volume[c] / (dim + 1) * std::abs(content(body, pressure[i]) - content(body, accepted[i]));
    }
  return sum;
}

template <int dim>
std::vector<double> PoreFlow<dim>::inflow() const {
  std::vector<double> all(inflow_.begin(), inflow_.begin() + shared_sources_);
  if (!all.empty())
    MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, nodes_.comm());
  return all;
}

template <int dim>
std::vector<std::pair<std::string, double>> PoreFlow<dim>::own_inflow() const {
  std::vector<std::pair<std::string, double>> own;
  for (std::size_t s = shared_sources_; s < sources_.size(); ++s) {
    own.emplace_back(sources_[s].name, inflow_[s]);
    MPI_Allreduce(MPI_IN_PLACE, &own.back().second, 1, MPI_DOUBLE, MPI_SUM, nodes_.comm());
  }
  return own;
}

template <int dim>
double PoreFlow<dim>::unnamed_inflow() const {
  double sum = inflow_.back();
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, nodes_.comm());
  return sum;
}

// ---- pressures and masses for the soil ----

template <int dim>
double PoreFlow<dim>::pressure_at(int cell, const Barycentric<dim> &l) const {
  double p = 0;
  for (int a = 0; a <= dim; ++a) p += l[a] * pressure[nodes_.of_cell(cell)[a]];
  return p;
}
template <int dim>
double PoreFlow<dim>::pressure_on_faces(int cell, const Barycentric<dim> &l) const {
  constexpr double beside = 1e-9;  // of the height of the cell, by round-off
  double p = 0;
  for (int a = 0; a <= dim; ++a) {
    const int node = nodes_.of_cell(cell)[a];
    if (l[a] > beside && !layered_[node] && !fixed_[node]) return pressure_at(cell, l);
    if (l[a] > beside) p += l[a] * (layered_[node] ? beyond_[node] : pressure[node]);
  }
  return p;
}
template <int dim>
double PoreFlow<dim>::saturation(int cell, const Barycentric<dim> &l) const {
  return saturation_of(body_of_[cell], pressure_at(cell, l));
}
template <int dim>
double PoreFlow<dim>::stress_pressure(int cell, const Barycentric<dim> &l) const {
  const double p = pressure_at(cell, l);
  if (!suction_) return p;
  return bishop_ ? saturation_of(body_of_[cell], p) * p : std::max(0., p);
}
template <int dim>
double PoreFlow<dim>::stress_pressure_slope(int cell, const Barycentric<dim> &l) const {
  const double p = pressure_at(cell, l);
  if (!suction_ || p > 0) return 1;
  return bishop_ ? saturation_of(body_of_[cell], p) + saturation_slope_of(body_of_[cell], p) * p : 0;
}
template <int dim>
FlowMeasure PoreFlow<dim>::measure(int node) const {
  const double p = pressure[node];
  return {suction_ ? std::max(0., p) : p, saturation_of(body_of_node_[node], p)};
}
template <int dim>
double PoreFlow<dim>::water_density(int cell, const Barycentric<dim> &l) const {
  const double p = pressure_at(cell, l);
  return soils_[body_of_[cell]].porosity() * saturation_of(body_of_[cell], p) * liquid_.density_at(p);
}

template <int dim>
bool PoreFlow<dim>::has_curve(int body) const {
  return suction_ && scene_.body[body].retention.reader;
}

template std::vector<int> bodies_of_cells(const BackgroundMesh<2> &, const Scene &);
template std::vector<int> bodies_of_cells(const BackgroundMesh<3> &, const Scene &);
template class PoreFlow<2>;
template class PoreFlow<3>;

}  // namespace talus
