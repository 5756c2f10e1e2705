#include "solvers/quasi_static/quasi_static.h"

#include <algorithm>
#include <cmath>
#include <numeric>


namespace talus {
namespace {

/// Gradients of all barycentric coordinates of a cell.
template <int dim>
std::array<Vec<dim>, dim + 1> barycentric_gradients(const Cell<dim> &cell) {
  std::array<Vec<dim>, dim + 1> g{};
  for (int k = 0; k < dim; ++k)
    for (int d = 0; d < dim; ++d) g[k + 1][d] = cell.gradient[k][d], g[0][d] -= cell.gradient[k][d];
  return g;
}

template <int dim>
Vec<dim> place_in(const BackgroundMesh<dim> &mesh, int cell, const Barycentric<dim> &l) {
  Vec<dim> x{};
  for (int a = 0; a <= dim; ++a)
    for (int d = 0; d < dim; ++d) x[d] += l[a] * mesh.position[mesh.cells[cell].node[a]][d];
  return x;
}

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

/// Strain per nodal displacement (engineering = 1) or its work conjugate (engineering = 2, off-diagonal stress acts twice), with the
/// mean gradient in the volumetric part where there is one.
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

}  // namespace

template <int dim>
QuasiStatic<dim>::QuasiStatic(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws,
                              const std::vector<Source> &sources, SoilData<dim> data)
    : mesh_(mesh), scene_(scene), sources_(sources), data_(std::move(data)),
      order_(scene.quasi_static.elements == Elements::quadratic ? 2 : 1),
      patches_(scene.quasi_static.elements == Elements::patches), rule_(stress_quadrature<dim>(order_)),
      load_rule_(load_quadrature<dim>()), facet_rule_(load_quadrature<dim - 1>()) {
  for (const Law &law : laws) points_.emplace_back().law = law, suction_matters_ = suction_matters_ || reads_suction(law);
  place_points();
}

// ---- what there is ----

template <int dim>
void QuasiStatic<dim>::place_points() {
  body_of_ = bodies_of_cells(mesh_, scene_), first_point_.assign(mesh_.cell_count(), -1);
  // cells of a patch follow one another, so that its points do
  std::vector<int> order(mesh_.cell_count());
  std::iota(order.begin(), order.end(), 0);
  if (patches_) std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return mesh_.patch[a] < mesh_.patch[b]; });
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
  PetscInt begin, end = 0;
  (void)DMPlexGetChart(mesh_.plex(), &begin, &end);
  displacement_of_point_.assign(static_cast<size_t>(end) * dim, 0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::activate(const std::vector<char> &present) {
  PetscFunctionBeginUser;
  active_.assign(mesh_.cell_count(), 0);
  for (int c = 0; c < mesh_.cell_count(); ++c) active_[c] = body_of_[c] >= 0 && present[body_of_[c]];
  for (size_t b = 0; b < points_.size(); ++b) points_[b].present = present[b];
  for (int i = 0; i < nodes_.count(); ++i)
    std::copy_n(&displacement_[i * dim], dim, &displacement_of_point_[nodes_.point[i] * dim]);
  PetscCall(nodes_.setup(mesh_, order_, active_));
  PetscCall(supports_.setup(mesh_, nodes_, active_, sources_));
  displacement_.resize(static_cast<size_t>(nodes_.count()) * dim);
  for (int i = 0; i < nodes_.count(); ++i)
    std::copy_n(&displacement_of_point_[nodes_.point[i] * dim], dim, &displacement_[i * dim]);
  make_groups(active_);

  loads_.clear();
  for (size_t s = 0; s < sources_.size(); ++s) {
    const bool water = std::holds_alternative<Head>(sources_[s].kind);
    if (!std::holds_alternative<Traction>(sources_[s].kind) && !water) continue;
    for (const std::string &group : sources_[s].groups)
      for (const Facet<dim> &facet : mesh_.has_group(group) ? mesh_.facets(group) : std::vector<Facet<dim>>{}) {
        if (!active_[facet.cell]) continue;
        const int across = mesh_.cells[facet.cell].neighbour[facet.face];
        loads_.push_back({facet, static_cast<int>(s), across >= 0 && active_[across] ? 0.5 : 1., nodes_.of_facet(facet.cell, facet.face)});
      }
  }
  for (auto *v : {&x_, &f_, &out_of_balance_, &target_, &internal_, &scratch_}) PetscCall(nodes_.global_vector(*v));
  owned_.clear(), owned_supported_.clear();
  for (int i = 0; i < nodes_.count(); ++i)
    if (nodes_.owned[i]) owned_.push_back(i);
  std::sort(owned_.begin(), owned_.end(), [&](int a, int b) { return nodes_.global()[a] < nodes_.global()[b]; });
  for (PetscInt row = 0; row < static_cast<PetscInt>(owned_.size()); ++row)
    if (supports_.at(owned_[row])) owned_supported_.push_back(row);
  motion_.assign(owned_.size() * dim, 0);
  long long mine = static_cast<long long>(owned_.size()) * dim;
  PetscCallMPI(MPI_Allreduce(&mine, &unknowns_, 1, MPI_LONG_LONG, MPI_SUM, nodes_.comm()));
  PetscCall(make_matrix());
  PetscCall(make_solver());
  PetscFunctionReturn(0);
}

template <int dim>
void QuasiStatic<dim>::make_groups(const std::vector<char> &active) {
  groups_.clear(), group_node_.clear(), gradient_.clear();
  const int per_cell = element_nodes<dim>(order_), per_rule = points_per_cell();
  for (size_t b = 0; b < points_.size(); ++b) {
    const GaussPoints<dim> &p = points_[b];
    for (int first = 0; first < p.count();) {
      int last = first + per_rule;
      if (patches_)
        while (last < p.count() && mesh_.patch[p.cell[last]] == mesh_.patch[p.cell[first]]) last += per_rule;
      if (active[p.cell[first]]) {
        Group g{static_cast<int>(b), first, last - first, static_cast<int>(group_node_.size()), 0, gradient_.size(), 0};
        for (int q = first; q < last; q += per_rule) {
          const int *node = nodes_.of_cell(p.cell[q]);
          for (int a = 0; a < per_cell; ++a)
            if (std::find(group_node_.begin() + g.first_node, group_node_.end(), node[a]) == group_node_.end()) group_node_.push_back(node[a]);
        }
        g.nodes = static_cast<int>(group_node_.size()) - g.first_node;
        gradient_.resize(gradient_.size() + static_cast<size_t>(g.points + (patches_ ? 1 : 0)) * g.nodes, Vec<dim>{});
        g.mean_gradient = g.first_gradient + static_cast<size_t>(g.points) * g.nodes;
        double volume = 0;
        std::vector<Vec<dim>> shape(per_cell);
        for (int q = first; q < last; ++q) {
          const int *node = nodes_.of_cell(p.cell[q]);
          shape_gradients<dim>(order_, rule_.point[(q - first) % per_rule], barycentric_gradients(mesh_.cells[p.cell[q]]), shape.data());
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

// ---- linear algebra ----

template <int dim>
PetscErrorCode QuasiStatic<dim>::make_matrix() {
  Matrix pattern;
  PetscFunctionBeginUser;
  const PetscInt rows = static_cast<PetscInt>(owned_.size()) * dim;
  const auto shape = [&](Mat m, MatType type) -> PetscErrorCode {
    PetscFunctionBeginUser;
    PetscCall(MatSetSizes(m, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
    PetscCall(MatSetBlockSize(m, dim));
    PetscCall(MatSetType(m, type));
    PetscFunctionReturn(0);
  };
  PetscCall(MatCreate(nodes_.comm(), pattern.create()));
  PetscCall(shape(pattern, MATPREALLOCATOR));
  PetscCall(MatSetUp(pattern));
  std::vector<PetscInt> block;
  std::vector<double> zeros;
  for (const Group &g : groups_) {
    block.resize(g.nodes), zeros.resize(static_cast<size_t>(g.nodes) * g.nodes * dim * dim, 0);
    for (int a = 0; a < g.nodes; ++a) block[a] = nodes_.global()[group_node_[g.first_node + a]];
    PetscCall(MatSetValuesBlocked(pattern, g.nodes, block.data(), g.nodes, block.data(), zeros.data(), INSERT_VALUES));
  }
  PetscCall(MatAssemblyBegin(pattern, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(pattern, MAT_FINAL_ASSEMBLY));
  PetscCall(MatCreate(nodes_.comm(), matrix_.create()));
  PetscCall(shape(matrix_, MATAIJ));
  PetscCall(MatPreallocatorPreallocate(pattern, PETSC_TRUE, matrix_));
  PetscFunctionReturn(0);
}

/// Direct up to a size at which its fill is still cheap, else GMRES with algebraic multigrid; PETSc's options change all of it.
template <int dim>
PetscErrorCode QuasiStatic<dim>::make_solver() {
  KSP ksp;
  PC pc;
  Mat factor;
  SNESLineSearch search;
  constexpr long long largest_direct = dim == 2 ? 400000 : 40000;  // unknowns
  const QuasiStaticSource &settings = scene_.quasi_static;
  PetscFunctionBeginUser;
  direct_ = settings.linear_solver == LinearSolver::direct || (settings.linear_solver == LinearSolver::automatic && unknowns_ <= largest_direct);
  PetscCall(SNESCreate(nodes_.comm(), solver_.create()));
  PetscCall(SNESSetOptionsPrefix(solver_, "talus_"));
  PetscCall(SNESSetFunction(solver_, f_, snes_function, this));
  PetscCall(SNESSetJacobian(solver_, matrix_, matrix_, snes_jacobian, this));
  PetscCall(SNESSetType(solver_, SNESNEWTONLS));
  PetscCall(SNESGetLineSearch(solver_, &search));
  PetscCall(SNESLineSearchSetType(search, SNESLINESEARCHCP));
  PetscCall(SNESSetTolerances(solver_, 0, settings.tolerance, 0, settings.iterations, PETSC_MAX_INT));
  PetscCall(SNESSetConvergenceTest(solver_, snes_converged, this, nullptr));
  PetscCall(SNESGetKSP(solver_, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  if (direct_) {
    PetscCall(KSPSetType(ksp, KSPPREONLY));
    PetscCall(PCSetType(pc, PCLU));
    PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
    PetscCall(KSPSetOperators(ksp, matrix_, matrix_));
    PetscCall(PCFactorSetUpMatSolverType(pc));
    PetscCall(PCFactorGetMatrix(pc, &factor));
    PetscCall(MatMumpsSetIcntl(factor, 14, 100));  // room for pivots, in per cent: tangents at failure ask for many
  } else {
    PetscCall(KSPSetType(ksp, KSPFGMRES));
    PetscCall(KSPGMRESSetRestart(ksp, 100));
    PetscCall(KSPSetTolerances(ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, 1000));
    PetscCall(PCSetType(pc, PCGAMG));
    PetscCall(near_null_space());
  }
  PetscCall(SNESSetFromOptions(solver_));
  PetscFunctionReturn(0);
}

/// Rigid motions, for multigrid: in the nodes' own frames, zero where motion is prescribed.
template <int dim>
PetscErrorCode QuasiStatic<dim>::near_null_space() {
  constexpr int modes = dim * (dim + 1) / 2;
  std::array<::Vec, modes> mode;
  MatNullSpace space;
  PetscFunctionBeginUser;
  for (int m = 0; m < modes; ++m) {
    double *value;
    PetscCall(VecDuplicate(x_, &mode[m]));
    PetscCall(VecGetArray(mode[m], &value));
    for (size_t row = 0; row < owned_.size(); ++row) {
      const Vec<dim> &x = nodes_.position[owned_[row]];
      for (int d = 0; d < dim; ++d) value[row * dim + d] = m == d;
      if (m >= dim) {
        const int i = dim == 2 ? 0 : (m - dim), j = dim == 2 ? 1 : (m - dim + 1) % 3;
        value[row * dim + i] = -x[j], value[row * dim + j] = x[i];
      }
    }
    impose(value, true);
    PetscCall(VecRestoreArray(mode[m], &value));
    for (int k = 0; k < m; ++k) {
      double dot;
      PetscCall(VecDot(mode[m], mode[k], &dot));
      PetscCall(VecAXPY(mode[m], -dot, mode[k]));
    }
    PetscCall(VecNormalize(mode[m], nullptr));
  }
  PetscCall(MatNullSpaceCreate(nodes_.comm(), PETSC_FALSE, modes, mode.data(), &space));
  PetscCall(MatSetNearNullSpace(matrix_, space));
  PetscCall(MatNullSpaceDestroy(&space));
  for (::Vec &m : mode) PetscCall(VecDestroy(&m));
  PetscFunctionReturn(0);
}

/// Turns owned nodes' vectors into their frames; with `clear`, prescribed components become zero.
template <int dim>
void QuasiStatic<dim>::impose(double *global, bool clear) const {
  for (PetscInt row : owned_supported_) {
    const Support<dim> &s = *supports_.at(owned_[row]);
    Eigen::Map<ColumnVector<dim>> v(global + row * dim);
    if (s.turned) v = (s.frame * v).eval();
    for (int d = 0; d < dim && clear; ++d)
      if (s.held[d]) v[d] = 0;
  }
}

/// Displacement of local nodes from the unknowns, with the prescribed motion of the step if wanted.
template <int dim>
PetscErrorCode QuasiStatic<dim>::displacement_of(::Vec x, bool with_motion, std::vector<double> &u) const {
  double *value;
  PetscFunctionBeginUser;
  PetscCall(VecCopy(x, scratch_));
  PetscCall(VecGetArray(scratch_, &value));
  for (PetscInt row : owned_supported_) {
    const Support<dim> &s = *supports_.at(owned_[row]);
    Eigen::Map<ColumnVector<dim>> v(value + row * dim);
    for (int d = 0; d < dim; ++d)
      if (s.held[d]) v[d] = with_motion ? motion_[row * dim + d] : 0;
    if (s.turned) v = (s.frame.transpose() * v).eval();
  }
  PetscCall(VecRestoreArray(scratch_, &value));
  PetscCall(nodes_.to_local(scratch_, u));
  PetscFunctionReturn(0);
}

// ---- forces ----

template <int dim>
void QuasiStatic<dim>::strain_increments(const std::vector<double> &u) {
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
}

template <int dim>
void QuasiStatic<dim>::update_stresses() {
  for (GaussPoints<dim> &p : points_)
    if (p.present) update_stress<dim>(p.law, p.trial());
}

template <int dim>
double QuasiStatic<dim>::pore_pressure(const Vec<dim> &x, double t) const {
  const double p = data_.pressure(x, t);
  return suction_matters_ ? std::max(0., p) : p;
}

/// Suction at the Gauss points, linear between the vertices.
template <int dim>
void QuasiStatic<dim>::find_suction(double t) {
  if (!suction_matters_) return;
  for (GaussPoints<dim> &p : points_) {
    if (!p.present || !reads_suction(p.law)) continue;
    p.suction.assign(p.count(), 0);
    for (int q = 0; q < p.count() && data_.flow; ++q) p.suction[q] = std::max(0., -data_.flow->pressure_at(p.cell[q], rule_.point[q % points_per_cell()]));
    for (int q = 0; q < p.count() && data_.pressure; ++q)
      for (int a = 0; a <= dim; ++a)
        p.suction[q] += rule_.point[q % points_per_cell()][a] * std::max(0., -data_.pressure(mesh_.position[mesh_.cells[p.cell[q]].node[a]], t));
  }
}

template <int dim>
void QuasiStatic<dim>::internal_force(std::vector<double> &force, bool trial) const {
  force.assign(static_cast<size_t>(nodes_.count()) * dim, 0);
  for (const Group &g : groups_) {
    const GaussPoints<dim> &p = points_[g.body];
    const int *node = &group_node_[g.first_node];
    double mean_work = 0;  // of the mean stress
    for (int q = 0; q < g.points; ++q) {
      const double *s = &(trial ? p.trial_stress : p.stress)[static_cast<size_t>(g.first_point + q) * components];
      const double pores = data_.flow ? data_.flow->stress_pressure(p.cell[g.first_point + q], rule_.point[q % points_per_cell()]) : 0;
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
void QuasiStatic<dim>::external_force(double t, std::vector<double> &force) const {
  force.assign(static_cast<size_t>(nodes_.count()) * dim, 0);
  const int per_cell = element_nodes<dim>(order_);
  std::vector<double> shape(per_cell);
  std::vector<Vec<dim>> gradient(per_cell);
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (!active_[c]) continue;
    const BodySource &source = scene_.body[body_of_[c]];
    const int *node = nodes_.of_cell(c);
    const auto add = [&](int a, double scale, const Vec<dim> &v) {
      for (int d = 0; d < dim; ++d) force[node[a] * dim + d] += scale * v[d];
    };
    Vec<dim> gravity;
    std::copy_n(scene_.gravity.begin(), dim, gravity.begin());
    std::array<double, dim + 1> pressure{};  // at the vertices, linear between them as in the motion of particles
    Vec<dim> slope{};
    const auto of_l = barycentric_gradients(mesh_.cells[c]);
    if (data_.pressure)
      for (int a = 0; a <= dim; ++a) {
        pressure[a] = pore_pressure(mesh_.position[mesh_.cells[c].node[a]], t);
        for (int d = 0; d < dim; ++d) slope[d] += pressure[a] * of_l[a][d];
      }
    for (size_t q = 0; q < rule_.point.size(); ++q) {
      const double volume = mesh_.volume[c] * rule_.weight[q];
      double density = data_.density(source, place_in(mesh_, c, rule_.point[q]), t);
      if (data_.flow) density += data_.flow->water_density(c, rule_.point[q]);
      shape_functions<dim>(order_, rule_.point[q], shape.data());
      if (data_.pressure && !data_.open_water_load) shape_gradients<dim>(order_, rule_.point[q], of_l, gradient.data());
      double here = 0;
      for (int a = 0; a <= dim; ++a) here += rule_.point[q][a] * pressure[a];
      for (int a = 0; a < per_cell; ++a) {
        add(a, density * volume * shape[a], gravity);
        if (!data_.pressure) continue;
        data_.open_water_load ? add(a, -volume * shape[a], slope) : add(a, volume * here, gradient[a]);
      }
    }
    if (source.body_acceleration.empty()) continue;
    for (size_t q = 0; q < load_rule_.point.size(); ++q) {
      const Vec<dim> x = place_in(mesh_, c, load_rule_.point[q]);
      Vec<dim> b;
      for (int d = 0; d < dim; ++d) b[d] = source.body_acceleration[d](x[0], x[1], dim == 3 ? x[dim - 1] : 0, t);
      shape_functions<dim>(order_, load_rule_.point[q], shape.data());
      const double density = data_.density(source, x, t) + (data_.flow ? data_.flow->water_density(c, load_rule_.point[q]) : 0);
      const double mass = mesh_.volume[c] * load_rule_.weight[q] * density;
      for (int a = 0; a < per_cell; ++a) add(a, mass * shape[a], b);
    }
  }
  for (const LoadedFacet &load : loads_)
    for (size_t q = 0; q < facet_rule_.point.size(); ++q) {
      Vec<dim> x{};
      for (int a = 0; a < dim; ++a)
        for (int d = 0; d < dim; ++d) x[d] += facet_rule_.point[q][a] * nodes_.position[load.node[a]][d];
      shape_functions<dim - 1>(order_, facet_rule_.point[q], shape.data());
      const Vec<dim> traction = traction_of(load, x, t);
      const double area = load.share * load.facet.area * facet_rule_.weight[q];
      for (size_t a = 0; a < load.node.size(); ++a)
        for (int d = 0; d < dim; ++d) force[load.node[a] * dim + d] += area * shape[a] * traction[d];
    }
}

/// Of a load, or of open water [Pa].
template <int dim>
Vec<dim> QuasiStatic<dim>::traction_of(const LoadedFacet &load, const Vec<dim> &x, double t) const {
  const Boundary &kind = sources_[load.source].kind;
  if (const auto *given = std::get_if<Traction>(&kind)) return given->template load<dim>(load.facet.normal, x, t);
  Vec<dim> traction = load.facet.normal;
  for (double &component : traction) component *= -std::get<Head>(kind).outside(x[0], x[1], 0, t, data_.flow->unit_weight());
  return traction;
}

// ---- Newton ----

template <int dim>
PetscErrorCode QuasiStatic<dim>::residual(::Vec x, ::Vec f) {
  std::vector<double> u, force;
  double *value, size;
  const double *unknown;
  PetscFunctionBeginUser;
  PetscCall(displacement_of(x, true, u));
  strain_increments(u);
  update_stresses();
  internal_force(force, true);
  PetscCall(nodes_.add_to_global(force, f));
  PetscCall(VecNorm(f, NORM_2, &size));
  if (scale_open_) force_scale_ = std::max(force_scale_, size);
  PetscCall(VecGetArray(f, &value));
  impose(value, true);
  PetscCall(VecRestoreArray(f, &value));
  PetscCall(VecAXPY(f, -1, target_));
  PetscCall(VecGetArray(f, &value));
  PetscCall(VecGetArrayRead(x, &unknown));
  for (PetscInt row : owned_supported_)
    for (int d = 0; d < dim; ++d)
      if (supports_.at(owned_[row])->held[d]) value[row * dim + d] = stiffness_scale_ * unknown[row * dim + d];
  PetscCall(VecRestoreArrayRead(x, &unknown));
  PetscCall(VecRestoreArray(f, &value));
  PetscFunctionReturn(0);
}

/// Assembles the tangent at the trial state. `lift` receives what `motion` (local nodes, in their frames) does to the free rows.
template <int dim>
PetscErrorCode QuasiStatic<dim>::stiffness(Mat matrix, const std::vector<double> *motion, std::vector<double> *lift) {
  PetscFunctionBeginUser;
  PetscCall(MatZeroEntries(matrix));
  if (lift) lift->assign(static_cast<size_t>(nodes_.count()) * dim, 0);
  using Tangent = Eigen::Matrix<double, components, components, Eigen::RowMajor>;
  std::vector<std::vector<double>> tangent(points_.size());
  for (size_t b = 0; b < points_.size(); ++b) {
    GaussPoints<dim> &p = points_[b];
    if (!p.present) continue;
    tangent[b].resize(static_cast<size_t>(p.count()) * components * components);
    update_stress_with_tangent<dim>(p.law, p.trial(), tangent[b].data());
  }
  std::vector<PetscInt> block;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> element;
  std::vector<Operator<dim>> left, right;
  for (const Group &g : groups_) {
    const GaussPoints<dim> &p = points_[g.body];
    const int *node = &group_node_[g.first_node];
    element.setZero(g.nodes * dim, g.nodes * dim);
    left.resize(g.nodes), right.resize(g.nodes), block.resize(g.nodes);
    for (int q = 0; q < g.points; ++q) {
      const Vec<dim> *shape = &gradient_[g.first_gradient + static_cast<size_t>(q) * g.nodes];
      const Eigen::Map<const Tangent> c(&tangent[g.body][static_cast<size_t>(g.first_point + q) * components * components]);
      for (int k = 0; k < g.nodes; ++k) {
        const Vec<dim> *mean = patches_ ? &gradient_[g.mean_gradient + k] : nullptr;
        left[k] = p.volume[g.first_point + q] * strain_operator<dim>(shape[k], mean, 2);
        right[k] = c * strain_operator<dim>(shape[k], mean, 1);
      }
      for (int a = 0; a < g.nodes; ++a)
        for (int b = 0; b < g.nodes; ++b) element.template block<dim, dim>(a * dim, b * dim) += left[a].transpose() * right[b];
    }
    for (int a = 0; a < g.nodes; ++a) {
      block[a] = nodes_.global()[node[a]];
      const Support<dim> *s = supports_.at(node[a]);
      if (!s) continue;
      if (s->turned) {
        element.middleRows(a * dim, dim) = (s->frame * element.middleRows(a * dim, dim)).eval();
        element.middleCols(a * dim, dim) = (element.middleCols(a * dim, dim) * s->frame.transpose()).eval();
      }
    }
    for (int a = 0; a < g.nodes; ++a)
      if (const Support<dim> *s = supports_.at(node[a]))
        for (int d = 0; d < dim; ++d)
          if (s->held[d]) {
            if (lift)
              for (int b = 0; b < g.nodes; ++b)
                for (int e = 0; e < dim; ++e)
                  (*lift)[node[b] * dim + e] += element(b * dim + e, a * dim + d) * (*motion)[node[a] * dim + d];
            element.row(a * dim + d).setZero(), element.col(a * dim + d).setZero();
          }
    PetscCall(MatSetValuesBlocked(matrix, g.nodes, block.data(), g.nodes, block.data(), element.data(), ADD_VALUES));
  }
  for (PetscInt row : owned_supported_)
    for (int d = 0; d < dim; ++d)
      if (supports_.at(owned_[row])->held[d]) {
        const PetscInt k = nodes_.global()[owned_[row]] * dim + d;
        PetscCall(MatSetValue(matrix, k, k, stiffness_scale_, ADD_VALUES));
      }
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::snes_function(SNES, ::Vec x, ::Vec f, void *problem) {
  return static_cast<QuasiStatic *>(problem)->residual(x, f);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::snes_jacobian(SNES, ::Vec, Mat, Mat matrix, void *problem) {
  return static_cast<QuasiStatic *>(problem)->stiffness(matrix, nullptr, nullptr);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::snes_converged(SNES solver, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                                SNESConvergedReason *reason, void *context) {
  PetscFunctionBeginUser;
  QuasiStatic &problem = *static_cast<QuasiStatic *>(context);
  *reason = SNES_CONVERGED_ITERATING;
  if (iteration == 0) problem.scale_open_ = false;  // an iterate that goes astray must not widen what counts as small
  if (!std::isfinite(norm)) *reason = SNES_DIVERGED_FNORM_NAN;
  else if (norm <= problem.scene_.quasi_static.tolerance * problem.force_scale_) *reason = SNES_CONVERGED_FNORM_RELATIVE;
  else if (problem.blow_up > 0 && iteration > 0) {
    ::Vec x;
    double largest;
    PetscCall(SNESGetSolution(solver, &x));
    PetscCall(VecNorm(x, NORM_INFINITY, &largest));
    if (largest > problem.blow_up) problem.blown_up_ = true, *reason = SNES_DIVERGED_DTOL;
  }
  PetscFunctionReturn(0);
}

// ---- paths ----

template <int dim>
PetscErrorCode QuasiStatic<dim>::begin_path(double load_time) {
  std::vector<double> internal, external;
  double *value;
  PetscFunctionBeginUser;
  internal_force(internal, false);
  external_force(load_time, external);
  for (size_t i = 0; i < external.size(); ++i) external[i] -= internal[i];
  PetscCall(nodes_.add_to_global(external, out_of_balance_));
  PetscCall(VecGetArray(out_of_balance_, &value));
  impose(value, true);
  PetscCall(VecRestoreArray(out_of_balance_, &value));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::prepare(double share, double load_time, double time, double dt, ::Vec x) {
  std::vector<double> external;
  double *value;
  KSP ksp;
  PetscFunctionBeginUser;
  blown_up_ = false, scale_open_ = true;
  find_suction(load_time);
  external_force(load_time, external);
  PetscCall(nodes_.add_to_global(external, target_));
  PetscCall(VecNorm(target_, NORM_2, &force_scale_));
  PetscCall(VecGetArray(target_, &value));
  impose(value, true);
  PetscCall(VecRestoreArray(target_, &value));
  PetscCall(VecAXPY(target_, -(1 - share), out_of_balance_));

  stiffness_scale_ = 0;
  for (const GaussPoints<dim> &p : points_) stiffness_scale_ = std::max(stiffness_scale_, constrained_modulus(p.law));
  PetscCall(VecZeroEntries(x));
  std::fill(motion_.begin(), motion_.end(), 0.);
  if (!supports_.moves()) PetscFunctionReturn(0);
  int moved = 0;
  std::vector<double> motion(static_cast<size_t>(nodes_.count()) * dim, 0), lift;
  for (int i = 0; i < nodes_.count(); ++i)
    if (supports_.at(i)) {
      const Vec<dim> g = supports_.increment(i, nodes_.position[i], time, time + dt);
      std::copy(g.begin(), g.end(), &motion[i * dim]);
      for (double component : g) moved |= component != 0;
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &moved, 1, MPI_INT, MPI_MAX, nodes_.comm()));
  if (!moved) PetscFunctionReturn(0);
  // the linear answer to the motion is where Newton starts: plates alone would strain their own cells only
  PetscCall(SNESGetKSP(solver_, &ksp));
  PetscCall(residual(x, f_));
  PetscCall(stiffness(matrix_, &motion, &lift));
  PetscCall(nodes_.add_to_global(lift, internal_));
  PetscCall(VecGetArray(internal_, &value));
  for (PetscInt row : owned_supported_)
    for (int d = 0; d < dim; ++d)
      if (supports_.at(owned_[row])->held[d]) value[row * dim + d] = 0;
  PetscCall(VecRestoreArray(internal_, &value));
  PetscCall(VecAYPX(internal_, -1, f_));
  PetscCall(VecAXPY(internal_, -2, f_));  // -(f + lift)
  PetscCall(KSPSetOperators(ksp, matrix_, matrix_));
  PetscCall(KSPSolve(ksp, internal_, x));
  KSPConvergedReason linear;
  PetscCall(KSPGetConvergedReason(ksp, &linear));
  if (linear < 0) PetscCall(VecZeroEntries(x));
  for (size_t row = 0; row < owned_.size(); ++row) std::copy_n(&motion[owned_[row] * dim], dim, &motion_[row * dim]);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::advance(double share, double load_time, double time, double dt, bool softening, StepOutcome *outcome) {
  SNESConvergedReason reason;
  PetscInt iterations;
  PetscFunctionBeginUser;
  *outcome = {};
  PetscCall(prepare(share, load_time, time, dt, x_));
  PetscCall(SNESSolve(solver_, nullptr, x_));
  PetscCall(SNESGetConvergedReason(solver_, &reason));
  PetscCall(SNESGetIterationNumber(solver_, &iterations));
  PetscCall(SNESGetFunctionNorm(solver_, &outcome->residual));
  PetscCall(VecNorm(x_, NORM_INFINITY, &outcome->largest));
  outcome->iterations = static_cast<int>(iterations);
  outcome->residual /= force_scale_ > 0 ? force_scale_ : 1;
  outcome->converged = reason > 0, outcome->blown_up = blown_up_, outcome->singular = reason == SNES_DIVERGED_LINEAR_SOLVE;
  if (outcome->converged) PetscCall(commit(x_, softening));
  else PetscCall(make_solver());  // neither MUMPS nor the line search recovers from numbers that ran away
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::commit(::Vec x, bool softening) {
  std::vector<double> u;
  PetscFunctionBeginUser;
  PetscCall(displacement_of(x, true, u));
  strain_increments(u);
  update_stresses();
  for (size_t i = 0; i < u.size(); ++i) displacement_[i] += u[i];
  for (GaussPoints<dim> &p : points_) {
    if (!p.present) continue;
    std::copy(p.trial_stress.begin(), p.trial_stress.end(), p.stress.begin());
    if (softening) std::copy(p.trial_history.begin(), p.trial_history.end(), p.history.begin());
    for (int q = 0; q < p.count(); ++q)
      for (int k = 0; k < components; ++k) p.total_strain[q * components + k] += p.increment[q].strain[k];
  }
  PetscFunctionReturn(0);
}

template <int dim>
void QuasiStatic<dim>::reset_displacement() {
  std::fill(displacement_.begin(), displacement_.end(), 0.);
  std::fill(displacement_of_point_.begin(), displacement_of_point_.end(), 0.);
  for (GaussPoints<dim> &p : points_) {
    std::fill(p.history.begin(), p.history.end(), 0.);
    std::fill(p.total_strain.begin(), p.total_strain.end(), 0.);
  }
}

template <int dim>
void QuasiStatic<dim>::admit() {
  for (GaussPoints<dim> &p : points_)
    admit_stress<dim>(p.law, {p.count(), p.stress.data(), p.history.data(), p.stress.data(), p.history.data(), p.number.data(),
                              p.increment.data(), p.size.data(), p.trial().suction});
}

// ---- what it found ----

template <int dim>
Vec<dim> QuasiStatic<dim>::displacement(int cell, const Barycentric<dim> &place) const {
  std::array<double, element_nodes<dim>(2)> shape;
  shape_functions<dim>(order_, place, shape.data());
  Vec<dim> u{};
  for (int a = 0; a < element_nodes<dim>(order_); ++a)
    for (int d = 0; d < dim; ++d) u[d] += shape[a] * displacement_[nodes_.of_cell(cell)[a] * dim + d];
  return u;
}

template <int dim>
double QuasiStatic<dim>::largest_displacement() const {
  double largest = 0;
  for (int i = 0; i < nodes_.count(); ++i) largest = std::max(largest, Eigen::Map<const ColumnVector<dim>>(&displacement_[i * dim]).norm());
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, nodes_.comm());
  return largest;
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::boundary_forces(double load_time, std::vector<Vec<dim>> &force, std::vector<Vec<dim>> &face) const {
  std::vector<double> reaction, external;
  PetscFunctionBeginUser;
  internal_force(reaction, false);
  external_force(load_time, external);
  for (size_t i = 0; i < reaction.size(); ++i) reaction[i] -= external[i];
  PetscCall(nodes_.sum(reaction));
  force.assign(sources_.size(), Vec<dim>{}), face = force;
  std::vector<double> area(sources_.size(), 0);
  for (int i = 0; i < nodes_.count(); ++i) {
    const Support<dim> *s = nodes_.owned[i] ? supports_.at(i) : nullptr;
    for (int k = 0; s && k < s->count; ++k) {
      double along = 0;
      for (int d = 0; d < dim; ++d) along += reaction[i * dim + d] * s->direction[k][d];
      for (int d = 0; d < dim; ++d) force[s->source[k]][d] += along * s->direction[k][d];
    }
  }
  std::array<double, element_nodes<dim>(2)> shape;
  for (const LoadedFacet &load : loads_)
    for (size_t q = 0; q < facet_rule_.point.size(); ++q) {
      shape_functions<dim - 1>(order_, facet_rule_.point[q], shape.data());
      const double weight = load.share * load.facet.area * facet_rule_.weight[q];
      area[load.source] += weight;
      for (size_t a = 0; a < load.node.size(); ++a)
        for (int d = 0; d < dim; ++d) face[load.source][d] += weight * shape[a] * displacement_[load.node[a] * dim + d];
    }
  const int count = static_cast<int>(sources_.size());
  if (count) {
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force[0].data(), count * dim, MPI_DOUBLE, MPI_SUM, nodes_.comm()));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, face[0].data(), count * dim, MPI_DOUBLE, MPI_SUM, nodes_.comm()));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, area.data(), count, MPI_DOUBLE, MPI_SUM, nodes_.comm()));
  }
  for (int s = 0; s < count; ++s)
    for (double &component : face[s]) component = area[s] > 0 ? component / area[s] : 0;
  PetscFunctionReturn(0);
}

template class QuasiStatic<2>;
template class QuasiStatic<3>;

}  // namespace talus
