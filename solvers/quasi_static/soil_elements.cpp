#include "solvers/quasi_static/soil_elements.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "base/local_numbers.h"
#include "physics/laws/strength_by_place.h"
#include "scene/body_source.h"
#include "scene/quasi_static_source.h"
#include "scene/scene.h"

namespace talus {
namespace {

/// Stored components as pairs of axes.
template <int dim>
constexpr std::array<std::pair<int, int>, stress_size<dim>> component_axes() {
  if constexpr (dim == 2)
    return {{{0, 0}, {1, 1}, {2, 2}, {0, 1}}};
  else
    return {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};
}

/// Strain of displacement gradient g, stored as stress is; `volume` is added to the trace.
template <int dim>
void strain_of(const Square<dim> &g, double extra, std::array<double, stress_size<dim>> &strain) {
  for (int k = 0; k < stress_size<dim>; ++k) {
    const auto [i, j] = component_axes<dim>()[k];
    strain[k] = (i < dim && j < dim ? (g(i, j) + g(j, i)) / 2 : 0) + (i == j ? extra / 3 : 0);
  }
}

template <int dim>
using Operator = Eigen::Matrix<double, stress_size<dim>, dim>;

/// Strain per nodal displacement (engineering = 1) or its work conjugate (engineering = 2, off-diagonal stress acts
/// twice), with the mean gradient in the volumetric part where there is one.
template <int dim>
Operator<dim> strain_operator(const Vec<dim> &g, const Vec<dim> *mean, double engineering) {
  Operator<dim> b = Operator<dim>::Zero();
  for (int k = 0; k < stress_size<dim>; ++k) {
    const auto [i, j] = component_axes<dim>()[k];
    if (i == j) {
      if (i < dim) b(k, i) += g[i];
      if (mean)
        for (int d = 0; d < dim; ++d) b(k, d) += ((*mean)[d] - g[d]) / 3;
    } else {
      b(k, i) += engineering / 2 * g[j], b(k, j) += engineering / 2 * g[i];
    }
  }
  return b;
}

/// d stress / d strain of isotropic elasticity, components as update_stress_with_tangent has them.
template <int dim>
Eigen::Matrix<double, stress_size<dim>, stress_size<dim>, Eigen::RowMajor> elastic_tangent(double bulk, double shear) {
  Eigen::Matrix<double, stress_size<dim>, stress_size<dim>, Eigen::RowMajor> c;
  c.setIdentity(), c *= 2 * shear;
  c.template topLeftCorner<3, 3>().array() += bulk - 2 * shear / 3;
  return c;
}

}  // namespace

template <int dim>
SoilElements<dim>::SoilElements(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws,
                                const SoilData<dim> &data)
    : mesh_(mesh),
      data_(data),
      order_(data.elements == Elements::quadratic ? 2 : 1),
      patches_(data.elements == Elements::patches),
      rule_(stress_quadrature<dim>(order_)),
      body_of_(bodies_of_cells(mesh, scene)) {
  for (const Law &law : laws)
    points_.emplace_back().law = law, suction_matters_ = suction_matters_ || reads_suction(law);
  place_points();
  for (size_t b = 0; b < laws.size(); ++b) {
    GaussPoints<dim> &p = points_[b];
    const StrengthByPlace strength(scene.body[b].law, p.law);
    if (consolidates(p.law)) p.cohesion_share.assign(p.count(), 1), p.friction_share.assign(p.count(), 1);
    for (int q = 0; strength.given() && !consolidates(p.law) && q < p.count(); ++q) {
      const Vec<dim> &x = p.position[q];
      const auto shares = strength.shares(p.law, x[0], x[1], dim == 3 ? x[dim - 1] : 0);
      p.cohesion_share.push_back(shares.cohesion), p.friction_share.push_back(shares.friction);
    }
  }
}

template <int dim>
void SoilElements<dim>::place_points() {
  first_point_.assign(mesh_.cell_count(), -1);
  // cells of a patch follow one another, so that its points do
  std::vector<int> order(mesh_.cell_count());
  std::iota(order.begin(), order.end(), 0);
  if (patches_)
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return mesh_.patch[a] < mesh_.patch[b]; });
  for (int cell : order) {
    if (body_of_[cell] < 0) continue;
    GaussPoints<dim> &p = points_[body_of_[cell]];
    first_point_[cell] = p.count();
    for (size_t q = 0; q < rule_.point.size(); ++q) {
      p.number.push_back(p.count());
      p.cell.push_back(cell);
      p.volume.push_back(mesh_.volume[cell] * rule_.weight[q]);
      p.position.push_back(place_in(mesh_, cell, rule_.point[q]));
      p.size.push_back(element_size<dim>(mesh_.volume[cell]));
    }
  }
  for (GaussPoints<dim> &p : points_) {
    p.stress.assign(p.count() * components, 0), p.history.assign(p.count() * history_size(p.law), 0);
    p.trial_stress = p.stress, p.trial_history = p.history, p.total_strain = p.stress;
    p.increment.resize(p.count());
    for (Increment<dim> &increment : p.increment) {
      increment.strain.fill(0), increment.rotation.fill(0);
      for (int d = 0; d < dim; ++d) increment.rotation[dim == 2 ? 0 : d * (dim + 1)] = 1;
    }
  }
  displacement_of_point_.assign(mesh_.element_plex().number.size() * dim, 0);
  taken_of_point_ = displacement_of_point_;
}

template <int dim>
PetscErrorCode SoilElements<dim>::activate(const std::vector<char> &present) {
  PetscFunctionBeginUser;
  active_.assign(mesh_.cell_count(), 0);
  for (int c = 0; c < mesh_.cell_count(); ++c)
    active_[c] = body_of_[c] >= 0 && present[body_of_[c]] && (left_out_.empty() || !left_out_[c]);
  for (size_t b = 0; b < points_.size(); ++b) points_[b].present = present[b];
  for (GaussPoints<dim> &p : points_)
    for (int q = 0; q < p.count(); ++q)
      if (!active_[p.cell[q]]) p.increment[q].strain.fill(0);
  for (int i = 0; i < nodes_.count(); ++i)
    std::copy_n(&displacement_[i * dim], dim, &displacement_of_point_[nodes_.point[i] * dim]),
        std::copy_n(&taken_[i * dim], dim, &taken_of_point_[nodes_.point[i] * dim]);
  PetscCall(nodes_.setup(mesh_, order_, active_));
  displacement_.resize(static_cast<size_t>(nodes_.count()) * dim), taken_.resize(displacement_.size());
  for (int i = 0; i < nodes_.count(); ++i)
    std::copy_n(&displacement_of_point_[nodes_.point[i] * dim], dim, &displacement_[i * dim]),
        std::copy_n(&taken_of_point_[nodes_.point[i] * dim], dim, &taken_[i * dim]);
  make_groups();
  PetscFunctionReturn(0);
}

template <int dim>
void SoilElements<dim>::make_groups() {
  groups_.clear(), group_node_.clear(), gradient_.clear();
  const int per_cell = element_nodes<dim>(order_), per_rule = points_per_cell();
  for (size_t b = 0; b < points_.size(); ++b) {
    const GaussPoints<dim> &p = points_[b];
    for (int first = 0; first < p.count();) {
      int last = first + per_rule;
      if (patches_)
        while (last < p.count() && mesh_.patch[p.cell[last]] == mesh_.patch[p.cell[first]] &&
               active_[p.cell[last]] == active_[p.cell[first]])
          last += per_rule;
      if (active_[p.cell[first]]) {
        Group g{static_cast<int>(b), first, last - first, static_cast<int>(group_node_.size()), 0, gradient_.size(), 0};
        for (int q = first; q < last; q += per_rule) {
          const int *node = nodes_.of_cell(p.cell[q]);
          for (int a = 0; a < per_cell; ++a)
            if (std::find(group_node_.begin() + g.first_node, group_node_.end(), node[a]) == group_node_.end())
              group_node_.push_back(node[a]);
        }
        g.nodes = static_cast<int>(group_node_.size()) - g.first_node;
        gradient_.resize(gradient_.size() + static_cast<size_t>(g.points + (patches_ ? 1 : 0)) * g.nodes, Vec<dim>{});
        g.mean_gradient = g.first_gradient + static_cast<size_t>(g.points) * g.nodes;
        double volume = 0;
        std::vector<Vec<dim>> shape(per_cell);
        for (int q = first; q < last; ++q) {
          const int *node = nodes_.of_cell(p.cell[q]);
          shape_gradients<dim>(order_, rule_.point[(q - first) % per_rule],
                               barycentric_gradients<dim>(mesh_.cells[p.cell[q]]), shape.data());
          for (int a = 0; a < per_cell; ++a) {
            const auto found = std::find(group_node_.begin() + g.first_node, group_node_.end(), node[a]);
            const size_t k = found - (group_node_.begin() + g.first_node);
            gradient_[g.first_gradient + static_cast<size_t>(q - first) * g.nodes + k] = shape[a];
            if (patches_)
              for (int d = 0; d < dim; ++d) gradient_[g.mean_gradient + k][d] += p.volume[q] * shape[a][d];
          }
          volume += p.volume[q];
        }
        if (patches_)
          for (int k = 0; k < g.nodes; ++k)
            for (int d = 0; d < dim; ++d) gradient_[g.mean_gradient + k][d] /= volume;
        groups_.push_back(g);
      }
      first = last;
    }
  }
}

// ---- from displacement to forces ----

template <int dim>
void SoilElements<dim>::deform(const std::vector<double> &u) {
  for (const Group &g : groups_) {
    const int *node = &group_node_[g.first_node];
    double mean = 0;
    if (patches_)
      for (int k = 0; k < g.nodes; ++k)
        for (int d = 0; d < dim; ++d) mean += gradient_[g.mean_gradient + k][d] * u[node[k] * dim + d];
    for (int q = 0; q < g.points; ++q) {
      Square<dim> grad = Square<dim>::Zero();
      const Vec<dim> *shape = &gradient_[g.first_gradient + static_cast<size_t>(q) * g.nodes];
      for (int k = 0; k < g.nodes; ++k)
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j) grad(i, j) += u[node[k] * dim + i] * shape[k][j];
      strain_of<dim>(grad, patches_ ? mean - grad.trace() : 0, points_[g.body].increment[g.first_point + q].strain);
    }
  }
  for (GaussPoints<dim> &p : points_)
    if (p.present) update_stress<dim>(p.law, p.trial());
}

/// Linear between the vertices.
template <int dim>
void SoilElements<dim>::find_suction(double t) {
  if (!suction_matters_) return;
  for (int b = 0; b < static_cast<int>(points_.size()); ++b) {
    GaussPoints<dim> &p = points_[b];
    if (!p.present || !reads_suction(p.law)) continue;
    p.suction.assign(p.count(), 0);
    for (int q = 0; q < p.count() && data_.flow; ++q)
      p.suction[q] = std::max(0., -data_.flow->pressure_at(p.cell[q], rule_.point[q % points_per_cell()]));
    for (int q = 0; q < p.count() && data_.pressure; ++q)
      for (int a = 0; a <= dim; ++a)
        p.suction[q] += rule_.point[q % points_per_cell()][a] *
                        std::max(0., -data_.pressure(mesh_.position[mesh_.cells[p.cell[q]].node[a]], t, b));
  }
}

template <int dim>
void SoilElements<dim>::internal_force(std::vector<double> &force, bool trial) const {
  force.assign(static_cast<size_t>(nodes_.count()) * dim, 0);
  for (const Group &g : groups_) {
    const GaussPoints<dim> &p = points_[g.body];
    const int *node = &group_node_[g.first_node];
    double mean_work = 0;  // of the mean stress
    for (int q = 0; q < g.points; ++q) {
      const double *s = &(trial ? p.trial_stress : p.stress)[static_cast<size_t>(g.first_point + q) * components];
      const double pores =
          data_.flow ? data_.flow->stress_pressure(p.cell[g.first_point + q], rule_.point[q % points_per_cell()]) : 0;
      const double volume = p.volume[g.first_point + q], mean = patches_ ? (s[0] + s[1] + s[2]) / 3 - pores : 0;
      Square<dim> stress = Square<dim>::Zero();
      for (int k = 0; k < components; ++k) {
        const auto [i, j] = component_axes<dim>()[k];
        if (i < dim && j < dim) stress(i, j) = stress(j, i) = s[k];
      }
      stress.diagonal().array() -= mean + pores;
      mean_work += volume * mean;
      const Vec<dim> *shape = &gradient_[g.first_gradient + static_cast<size_t>(q) * g.nodes];
      for (int k = 0; k < g.nodes; ++k)
        Eigen::Map<ColumnVector<dim>>(&force[node[k] * dim]) += volume * (stress * map<dim>(shape[k]));
    }
    if (patches_)
      for (int k = 0; k < g.nodes; ++k)
        Eigen::Map<ColumnVector<dim>>(&force[node[k] * dim]) += mean_work * map<dim>(gradient_[g.mean_gradient + k]);
  }
}

template <int dim>
PetscErrorCode SoilElements<dim>::each_stiffness(
    double plastic, double elastic, const std::function<PetscErrorCode(const int *, int, Stiffness &)> &put) {
  PetscFunctionBeginUser;
  using Tangent = Eigen::Matrix<double, components, components, Eigen::RowMajor>;
  std::vector<std::vector<double>> tangent(points_.size());
  for (size_t b = 0; b < points_.size(); ++b) {
    GaussPoints<dim> &p = points_[b];
    if (!p.present) continue;
    tangent[b].resize(static_cast<size_t>(p.count()) * components * components);
    update_stress_with_tangent<dim>(p.law, p.trial(), tangent[b].data());
    if (plastic == 1 && elastic == 0) continue;
    const Tangent unyielding = elastic * elastic_tangent<dim>(bulk_modulus(p.law), shear_modulus(p.law));
    for (int q = 0; q < p.count(); ++q) {
      Eigen::Map<Tangent> c(&tangent[b][static_cast<size_t>(q) * components * components]);
      c = plastic * c + unyielding;
    }
  }
  Stiffness element;
  std::vector<Operator<dim>> left, right;
  for (const Group &g : groups_) {
    const GaussPoints<dim> &p = points_[g.body];
    element.setZero(g.nodes * dim, g.nodes * dim);
    left.resize(g.nodes), right.resize(g.nodes);
    for (int q = 0; q < g.points; ++q) {
      const Vec<dim> *shape = &gradient_[g.first_gradient + static_cast<size_t>(q) * g.nodes];
      const Eigen::Map<const Tangent> c(
          &tangent[g.body][static_cast<size_t>(g.first_point + q) * components * components]);
      for (int k = 0; k < g.nodes; ++k) {
        const Vec<dim> *mean = patches_ ? &gradient_[g.mean_gradient + k] : nullptr;
        left[k] = p.volume[g.first_point + q] * strain_operator<dim>(shape[k], mean, 2);
        right[k] = c * strain_operator<dim>(shape[k], mean, 1);
      }
      for (int a = 0; a < g.nodes; ++a)
        for (int b = 0; b < g.nodes; ++b)
          element.template block<dim, dim>(a * dim, b * dim) += left[a].transpose() * right[b];
    }
    PetscCall(put(&group_node_[g.first_node], g.nodes, element));
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode SoilElements<dim>::each_element(const std::function<PetscErrorCode(const int *, int)> &visit) const {
  PetscFunctionBeginUser;
  for (const Group &g : groups_) PetscCall(visit(&group_node_[g.first_node], g.nodes));
  PetscFunctionReturn(0);
}

template <int dim>
double SoilElements<dim>::stress_work() const {
  double work = 0;
  for (const GaussPoints<dim> &p : points_)
    for (int q = 0; p.present && q < p.count(); ++q)
      for (int k = 0; k < components; ++k) {
        const auto [i, j] = component_axes<dim>()[k];
        const double mean = (p.stress[q * components + k] + p.trial_stress[q * components + k]) / 2;
        work += p.volume[q] * (i == j ? 1 : 2) * mean * p.increment[q].strain[k];
      }
  return work;
}

template <int dim>
double SoilElements<dim>::strain_energy() const {
  double energy = 0;
  for (const GaussPoints<dim> &p : points_)
    for (int q = 0; p.present && q < p.count(); ++q)
      energy += p.volume[q] * stored_energy<dim>(p.law, &p.stress[q * components]);
  return energy;
}

// ---- states ----

template <int dim>
void SoilElements<dim>::accept(const std::vector<double> &u, bool softening) {
  for (size_t i = 0; i < u.size(); ++i) displacement_[i] += u[i];
  for (GaussPoints<dim> &p : points_) {
    if (!p.present) continue;
    std::copy(p.trial_stress.begin(), p.trial_stress.end(), p.stress.begin());
    const auto fields = history_fields(p.law);
    if (softening)
      std::copy(p.trial_history.begin(), p.trial_history.end(), p.history.begin());
    else
      for (size_t k = 0; k < fields.size(); ++k)
        for (size_t q = k; q < p.history.size() && fields[k].of_stress; q += fields.size())
          p.history[q] = p.trial_history[q];
    for (int q = 0; q < p.count(); ++q)
      for (int k = 0; k < components; ++k) p.total_strain[q * components + k] += p.increment[q].strain[k];
  }
}

template <int dim>
void SoilElements<dim>::reset_displacement() {
  std::fill(displacement_.begin(), displacement_.end(), 0.);
  std::fill(displacement_of_point_.begin(), displacement_of_point_.end(), 0.);
  taken_ = displacement_, taken_of_point_ = displacement_of_point_, restarted_ = true;
  for (GaussPoints<dim> &p : points_) {
    const auto fields = history_fields(p.law);
    for (size_t k = 0; k < fields.size(); ++k)
      for (size_t q = k; q < p.history.size() && !fields[k].kept; q += fields.size()) p.history[q] = 0;
    std::fill(p.total_strain.begin(), p.total_strain.end(), 0.);
  }
}

template <int dim>
void SoilElements<dim>::serialize(Archive &archive) {
  constexpr size_t width = dim * sizeof(double);
  const int points = static_cast<int>(displacement_of_point_.size()) / dim;
  std::vector<long long> moved, numbers;  // points with a node, now or before
  std::vector<double> displacement;
  for (int i = 0; i < nodes_.count() && !archive.reading(); ++i)
    std::copy_n(&displacement_[i * dim], dim, &displacement_of_point_[nodes_.point[i] * dim]);
  for (int p = 0; p < points; ++p) {
    const double *u = &displacement_of_point_[p * dim];
    numbers.push_back(mesh_.element_plex().number[p]);
    if (std::all_of(u, u + dim, [](double x) { return x == 0; })) continue;
    moved.push_back(numbers.back()), displacement.insert(displacement.end(), u, u + dim);
  }
  if (archive.reading()) moved.clear(), displacement.clear();
  archive.column(archive.rows("moved nodes", Belongs::to_points, moved), "nodal displacement", displacement, dim);
  if (archive.reading()) {
    const LocalNumbers point_of(numbers);
    std::fill(displacement_of_point_.begin(), displacement_of_point_.end(), 0.);
    for (size_t k = 0; k < moved.size(); ++k)  // of a node between ranks this one may have no soil
      if (const int p = point_of.find(moved[k]); p >= 0)
        std::memcpy(&displacement_of_point_[p * dim], &displacement[k * dim], width);
    for (int i = 0; i < nodes_.count(); ++i)
      std::copy_n(&displacement_of_point_[nodes_.point[i] * dim], dim, &displacement_[i * dim]);
    taken_ = displacement_, taken_of_point_ = displacement_of_point_;  // a checkpoint comes after the hand-over
  }
  for (GaussPoints<dim> &p : points_) serialize_points(archive, p);
}

/// Those of a body, as rows of their cells: the points of a cell in their order.
template <int dim>
void SoilElements<dim>::serialize_points(Archive &archive, GaussPoints<dim> &p) {
  const size_t per_cell = points_per_cell(), memory = history_size(p.law);
  std::vector<long long> cells;
  for (size_t q = 0; q < p.cell.size(); q += per_cell) cells.push_back(mesh_.global_cell[p.cell[q]]);
  const Archive::Rows rows = archive.rows("cells of Gauss points", Belongs::to_cells, cells);
  std::vector<int> first;  // point of each row's cell
  if (archive.reading()) {
    const LocalNumbers cell_of(mesh_.global_cell);
    for (const long long cell : cells) first.push_back(first_point_[cell_of(cell)]);
  }
  const auto column = [&](const char *name, std::vector<double> &values, size_t width) {
    std::vector<double> stored;
    if (!archive.reading()) stored = values;
    archive.column(rows, name, stored, width * per_cell);
    for (size_t k = 0; k < first.size() && width; ++k)
      std::copy_n(&stored[k * width * per_cell], width * per_cell, &values[first[k] * width]);
  };
  column("stress of Gauss points", p.stress, components);
  column("history of Gauss points", p.history, memory);
  column("strain of Gauss points", p.total_strain, components);
  if (!consolidates(p.law)) return;
  column("share of cohesion of Gauss points", p.cohesion_share, 1);
  column("share of friction of Gauss points", p.friction_share, 1);
}

template <int dim>
void SoilElements<dim>::admit() {
  for (GaussPoints<dim> &p : points_) {
    StressPoints<dim> present = p.trial();
    present.stress_out = p.stress.data(), present.history_out = p.history.data();
    admit_stress<dim>(p.law, present);
  }
}

template <int dim>
Vec<dim> SoilElements<dim>::displacement(int cell, const Barycentric<dim> &place) const {
  return interpolate(displacement_, cell, place);
}

template <int dim>
Vec<dim> SoilElements<dim>::further_displacement(int cell, const Barycentric<dim> &place) const {
  Vec<dim> u = interpolate(displacement_, cell, place);
  add_scaled<dim>(u, -1, interpolate(taken_, cell, place));
  return u;
}

template <int dim>
Vec<dim> SoilElements<dim>::interpolate(const std::vector<double> &nodal, int cell,
                                        const Barycentric<dim> &place) const {
  std::array<double, element_nodes<dim>(2)> shape;
  Vec<dim> u{};
  if (!active_[cell]) return u;
  shape_functions<dim>(order_, place, shape.data());
  for (int a = 0; a < element_nodes<dim>(order_); ++a)
    for (int d = 0; d < dim; ++d) u[d] += shape[a] * nodal[nodes_.of_cell(cell)[a] * dim + d];
  return u;
}

template <int dim>
void SoilElements<dim>::add_displacement(const std::vector<double> &more) {
  std::vector<char> done(nodes_.count(), 0);
  const auto add = [&](int node, int a, int b) {
    if (std::exchange(done[node], 1)) return;
    for (int d = 0; d < dim; ++d) {
      const double half_way = (more[a * dim + d] + more[b * dim + d]) / 2;
      displacement_[node * dim + d] += half_way, taken_[node * dim + d] += half_way;
    }
  };
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (!active_[c]) continue;
    const int *node = nodes_.of_cell(c);
    for (int a = 0; a <= dim; ++a) add(node[a], node[a], node[a]);
    for (int e = 0; order_ > 1 && e < static_cast<int>(simplex_edges<dim>.size()); ++e)
      add(node[dim + 1 + e], node[simplex_edges<dim>[e].first], node[simplex_edges<dim>[e].second]);
  }
}

template <int dim>
double SoilElements<dim>::largest_displacement() const {
  double largest = 0;
  for (int i = 0; i < nodes_.count(); ++i)
    largest = std::max(largest, Eigen::Map<const ColumnVector<dim>>(&displacement_[i * dim]).norm());
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, nodes_.comm());
  return largest;
}

template class SoilElements<2>;
template class SoilElements<3>;

}  // namespace talus
