#include "physics/pores/implicit_pressure.h"

#include <algorithm>
#include <cmath>

#include "base/room.h"
#include "physics/kinematics.h"
#include "physics/pores/storage.h"

namespace talus {

template <int dim>
ImplicitPressure<dim>::ImplicitPressure(bool acts, bool suction, bool patches, const BackgroundMesh<dim> &mesh)
    : acts(acts), open(acts && suction, patches, mesh) {
  if (!acts) return;
  const size_t nodes = mesh.node_count(), cells = mesh.cell_count(), points = nodes + (suction ? cells : 0);
  matrices.make_room_for(mesh);
  for (Array *field : {&solid, &apart, &supported, &porosity, &gap_solid, &gap_apart, &of_mesh_node_})
    make_room(*field, nodes);
  for (Array *field : {&volume, &particle_volume, &acting, &change, &before, &held, &strain, &stiffness,
                       &mixture_change, &correction_, &wanted_, &image_, &diagonal_, &counts_})
    make_room(*field, points);
  make_room(sums_, 2 * points);
  if (suction) {
    make_room(mixture_, points), make_room(drying, cells);
    for (auto *field : {&mixture_push, &grains_, &flux_}) make_room(*field, nodes);
    skew_gradients.make_room_for(points);
  } else {
    gradients.make_room_for(points);
  }
  for (Array *field : {&modulus, &unbounded}) make_room(*field, cells);
  for (auto *field : {&after_drag, &mapped}) make_room(*field, 2 * nodes);
  make_room(push, nodes), make_room(velocity_, nodes), make_room(mapped_, nodes);
  make_room(numbers_, nodes);
  walls.reserve(nodes), damped.reserve(nodes), gap_corners.reserve((dim + 1) * cells);
}

namespace {

double square(double x) { return x * x; }

template <int dim>
double along(Quad v, const Vec<dim> &n) {
  double sum = 0;
  for (int d = 0; d < dim; ++d) sum += v[d] * n[d];
  return sum;
}

template <int dim>
Quad times(double scale, const Vec<dim> &n) {
  return quad(scale) * load<dim>(n.data());
}

/// ln det (I + g).
template <int dim>
double volume_strain(const std::array<Vec<dim>, dim> &g) {
  double x;
  if constexpr (dim == 2)
    x = g[0][0] + g[1][1] + (g[0][0] * g[1][1] - g[0][1] * g[1][0]);
  else {
    const auto minor = [&](int i, int j) { return g[i][i] * g[j][j] - g[i][j] * g[j][i]; };
    x = g[0][0] + g[1][1] + g[2][2] + minor(0, 1) + minor(1, 2) + minor(2, 0) + g[0][0] * minor(1, 2) -
        g[0][1] * (g[1][0] * g[2][2] - g[1][2] * g[2][0]) + g[0][2] * (g[1][0] * g[2][1] - g[1][1] * g[2][0]);
  }
  return std::abs(x) < 1e-3 ? log1p_series(x) : std::log1p(x);
}

}  // namespace

template <int dim>
void ImplicitPressure<dim>::number_nodes(const FilledGrid<dim> &grid) {
  numbered_ = grid.node_count();
  std::copy_n(grid.mesh_node.begin(), numbered_, numbers_.begin());
}

template <int dim>
void ImplicitPressure<dim>::begin_part(const FilledGrid<dim> &grid) {
  matrices.begin(grid);
  for (int i = 0; i < numbered_; ++i) of_mesh_node_[numbers_[i]] = before[i];
  for (int i = 0; i < grid.node_count(); ++i) before[i] = of_mesh_node_[grid.mesh_node[i]];
  for (int i = 0; i < numbered_; ++i) of_mesh_node_[numbers_[i]] = 0;
  number_nodes(grid);
}

/// Sums of functions of a node over the nodes of all ranks. Collective.
template <int dim>
template <class... Terms>
std::array<double, sizeof...(Terms)> ImplicitPressure<dim>::sum(const StepStart<dim> &at, Terms &&...term) const {
  std::array<double, sizeof...(Terms)> all{};
  const int count = points(at);
  for (int i = 0; i < count; ++i) {
    size_t k = 0;
    ((all[k++] += counts_[i] * term(i)), ...);
  }
  MPI_Allreduce(MPI_IN_PLACE, all.data(), all.size(), MPI_DOUBLE, MPI_SUM, at.grid.mesh().comm());
  return all;
}

template <int dim>
PetscErrorCode ImplicitPressure<dim>::begin(const StepStart<dim> &at) {
  PetscFunctionBeginUser;
  const int nodes = at.grid.node_count();
  for (int i = 0; i < nodes; ++i) counts_[i] = at.grid.mesh().counted[at.grid.mesh_node[i]];
  if (open.acts) {
    PetscCall(open.begin(at));
    std::fill_n(counts_.begin() + nodes, at.grid.cell_count(), 0.);
    std::fill_n(before.begin() + nodes, at.grid.cell_count(), 0.);
    for (const int c : open.list) counts_[nodes + c] = 1;
  }
  matrices.integrate(at.shape, integrated(at), gap_corners);
  std::fill_n(held.begin(), points(at), 0.), first_ = 0;
  iterations_ = 0, starts_ = true;
  PetscCall(find_squeezed(at, acting.data()));
  PetscFunctionReturn(0);
}

/// Mean pressure of the cells of a node once its strain `held` has squeezed their pores, and its slope, into
/// `stiffness`; below cavitation it falls with a little of it. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_squeezed(const StepStart<dim> &at, double *pressure) {
  PetscFunctionBeginUser;
  constexpr double vapour = 1e3;  // [Pa]: stiffness of pores that cavitate
  const int nodes = at.grid.node_count();
  std::fill_n(sums_.begin(), 2 * nodes, 0.);
  for (int c = 0; c < at.grid.cell_count() && open.acts; ++c) {
    const auto pressure_at = [&](double strain) { return drying[c].at(*liquid, unbounded[c] - modulus[c] * strain); };
    if (open.open[c]) {
      const auto own = pressure_at(held[nodes + c]);
      pressure[nodes + c] = own.value, stiffness[nodes + c] = modulus[c] * own.slope;
      continue;
    }
    pressure[nodes + c] = 0, stiffness[nodes + c] = 1;
    for (int i : at.shape[c].node) {
      const auto own = pressure_at(held[i]);
      const double part = at.weight[c] / (dim + 1);
      sums_[2 * i] += part * (own.value - cavitation_pressure), sums_[2 * i + 1] += part * modulus[c] * own.slope;
    }
  }
  for (int c = 0; c < at.grid.cell_count() && !open.acts; ++c) {
    const double part = at.weight[c] / (dim + 1), liquid = part * modulus[c], gas = part * vapour,
                 full = (unbounded[c] - cavitation_pressure) / modulus[c];
    for (int i : at.shape[c].node) {
      const double rest = full - held[i], slope = rest > 0 ? liquid : gas;
      sums_[2 * i] += rest * slope, sums_[2 * i + 1] += slope;
    }
  }
  PetscCall(at.grid.sum(sums_.data(), 2));
  for (int i = 0; i < nodes; ++i) {
    const bool none = open.acts && volume[i] == 0;  // all cells around are open
    pressure[i] = none ? 0 : cavitation_pressure + sums_[2 * i] / volume[i];
    stiffness[i] = none ? 1 : sums_[2 * i + 1] / volume[i];
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_strain(const StepStart<dim> &at, const Vec<dim> *u) {
  PetscFunctionBeginUser;
  const int nodes = at.grid.node_count(), all = points(at);
  double *own = sums_.data(), *apart = own + all;
  const double *weight = integrated(at);
  std::fill_n(own, nodes, 0.);
  for (int c = 0; c < at.grid.cell_count(); ++c) {
    const Shape<dim> &shape = at.shape[c];
    std::array<Vec<dim>, dim> g{};
    for (int k = 0; k < dim; ++k)
      for (int i = 0; i < dim; ++i)
        add_scaled<dim>(g[i], u[shape.node[k + 1]][i] - u[shape.node[0]][i], shape.gradient[k]);
    const double of_cell = volume_strain<dim>(g), part = weight[c] / (dim + 1) * of_cell;
    for (int i : shape.node) own[i] += part;
    if (open.acts) own[nodes + c] = of_cell;
  }
  PetscCall(at.grid.sum(own, 1));
  if (open.acts) open.take_means_over_patches(at, own + nodes);
  for (int i = 0; i < nodes; ++i)
    mapped_[i].apart = quad(at.grid.mass[i]) * (load<dim>(u[nodes + i].data()) - load<dim>(u[i].data()));
  PetscCall(find_flux_divergence(at, apart));
  for (int i = 0; i < all; ++i) strain[i] = volume[i] > 0 ? own[i] / volume[i] + apart[i] / particle_volume[i] : 0;
  PetscFunctionReturn(0);
}

template <int dim>
void ImplicitPressure<dim>::end() {
  ++done.steps, done.iterations += iterations_, done.most_iterations = std::max(done.most_iterations, iterations_);
  done.unsolved += lacking_ > 0, done.worst = std::max(done.worst, lacking_);
}

/// Momenta, into `mapped_`, of the particles that have the velocities `velocity_` of nodes. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::map_velocities(FilledGrid<dim> &grid) {
  PetscFunctionBeginUser;
  matrices.momentum(velocity_.data(), mapped_.data());
  PetscCall(grid.sum(reinterpret_cast<double *>(mapped_.data()), 8));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ImplicitPressure<dim>::to_particles_and_back(FilledGrid<dim> &grid, const Vec<dim> *in, Vec<dim> *out) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  for (int i = 0; i < nodes; ++i) velocity_[i] = {load<dim>(in[i].data()), load<dim>(in[nodes + i].data())};
  PetscCall(map_velocities(grid));
  for (int i = 0; i < nodes; ++i) {
    const Quad scale = quad(1 / grid.mass[i]);
    store<dim>(out[i].data(), scale * mapped_[i].solid), store<dim>(out[nodes + i].data(), scale * mapped_[i].apart);
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_push(const StepStart<dim> &at, const double *pressure,
                                                const double *mixture) {
  PetscFunctionBeginUser;
  matrices.push(pressure, push.data());
  if (open.acts) {
    const int nodes = at.grid.node_count();
    matrices.push(mixture, mixture_push.data());
    PetscCall(
        open.add_push(at, pressure, pressure + nodes, mixture + nodes, gap_corners, push.data(), mixture_push.data()));
    PetscCall(at.grid.sum(reinterpret_cast<double *>(mixture_push.data()), 4));
    for (int i = 0; i < nodes; ++i) mixture_push[i][at_gap] = 0;
  }
  PetscCall(at.grid.sum(reinterpret_cast<double *>(push.data()), 4));
  PetscFunctionReturn(0);
}

template <int dim>
void ImplicitPressure<dim>::stop_at_walls(std::vector<NodalPair> &velocity) const {
  for (const Wall &wall : walls)
    for (int k = 0; k < wall.along.count; ++k) {
      const Vec<dim> &n = wall.along.direction[k];
      velocity[wall.node].apart -= times<dim>(along<dim>(velocity[wall.node].apart, n), n);
    }
}

/// Momenta of nodes after S, into `mapped_`, from the impulse of pressures x. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_velocities(const StepStart<dim> &at, const double *x) {
  PetscFunctionBeginUser;
  const int nodes = at.grid.node_count();
  for (int k = 0; k < points(at) && open.acts; ++k) mixture_[k] = borne(at, k) * x[k];
  PetscCall(find_push(at, x, mixture_.data()));
  for (int i = 0; i < nodes; ++i) {
    const Quad all = on_mixture(i);
    velocity_[i] = {quad(solid[i]) * all, quad(apart[i]) * all};
    Quad less{};  // force on the mixture less that on the liquid, had it no share
    if (open.acts) less = all - push[i], less[at_gap] = 0;
    if (push[i][at_gap] != 0) {
      const Quad area = times<dim>(push[i][at_gap], gap[i]);
      less += area, push[i] -= area;
    } else if (!open.acts) {
      continue;
    }
    velocity_[i].solid += quad(gap_solid[i]) * less, velocity_[i].apart += quad(gap_apart[i]) * less;
  }
  for (const Wall &wall : walls)  // liquid that a wall stops shares its momentum with the grains, (4.6a)
    for (int k = 0; k < wall.along.count; ++k) {
      const Vec<dim> &n = wall.along.direction[k];
      velocity_[wall.node].solid += times<dim>(wall.share * along<dim>(velocity_[wall.node].apart, n), n);
    }
  for (const Damped &p : damped) {
    Vec<dim> before, left;
    talus::store<dim>(before.data(), velocity_[p.node].solid);
    map<dim>(left) = p.rest * map<dim>(before);
    const Quad change = load<dim>(left.data()) - load<dim>(before.data());
    velocity_[p.node].solid += change, velocity_[p.node].apart -= quad(p.free) * change;
  }
  for (const auto &p : at.supports.active())  // where a support holds the skeleton, drag acts against what is at rest
    for (int k = 0; k < p.condition->count; ++k) {
      const Vec<dim> &n = p.condition->direction[k];
      auto &[grains, liquid] = velocity_[p.node];
      grains -= times<dim>(along<dim>(grains, n), n);
      liquid += times<dim>(supported[p.node] * along<dim>(push[p.node], n) - along<dim>(liquid, n), n);
    }
  stop_at_walls(velocity_);
  PetscCall(map_velocities(at.grid));
  for (const Damped &p : damped) {  // whose velocities are not mapped
    const Quad kept = quad(at.grid.mass[p.node]) * velocity_[p.node].solid;
    mapped_[p.node].apart += mapped_[p.node].solid - kept, mapped_[p.node].solid = kept;
  }
  for (const auto &p : at.supports.active())
    for (int k = 0; k < p.condition->count; ++k) {
      const Vec<dim> &n = p.condition->direction[k];
      const Quad held = times<dim>(along<dim>(mapped_[p.node].solid, n), n);
      mapped_[p.node].solid -= held, mapped_[p.node].apart += held;
    }
  stop_at_walls(mapped_);
  PetscFunctionReturn(0);
}

/// Integral of the divergence of the fluxes by the momenta `mapped_`.apart, of which gaps take their part. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_flux_divergence(const StepStart<dim> &at, double *y) {
  PetscFunctionBeginUser;
  for (int i = 0; i < at.grid.node_count(); ++i) {
    push[i] = quad(porosity[i] / at.grid.mass[i]) * mapped_[i].apart;
    push[i][at_gap] = -along<dim>(push[i], gap[i]);
  }
  matrices.divergence(push.data(), y);
  if (open.acts) PetscCall(open.find_outflow(at, push.data(), gap_corners, y + at.grid.node_count(), y));
  PetscCall(at.grid.sum(y, 1));
  PetscFunctionReturn(0);
}

/// y = A x for pressures x at the nodes [Pa], theory of pores (8.5): the volume that the pores of the nodes lack after
/// the strain by their forces in a step [m3]. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::apply(const StepStart<dim> &at, const double *x, double *y) {
  PetscFunctionBeginUser;
  const int nodes = at.grid.node_count();
  PetscCall(find_velocities(at, x));
  for (int i = 0; i < nodes; ++i) {
    const double scale = 1 / at.grid.mass[i];
    Quad flux = quad(scale * porosity[i]) * mapped_[i].apart;
    push[i] = quad(scale) * mapped_[i].solid + flux;
    if (open.acts) grains_[i] = quad(scale) * mapped_[i].solid;
    push[i][at_gap] = flux[at_gap] = -along<dim>(flux, gap[i]);
    if (open.acts) flux_[i] = flux;
  }
  matrices.divergence(push.data(), y);
  if (open.acts) {
    double *strained = sums_.data();
    PetscCall(open.find_outflow(at, flux_.data(), gap_corners, y + nodes, y));
    open.find_strain(at, grains_.data(), strained);
    for (const int c : open.list) y[nodes + c] += strained[c];
  }
  PetscCall(at.grid.sum(y, 1));
  for (int i = 0; i < points(at); ++i)
    y[i] = volume[i] > 0 ? volume[i] / stiffness[i] * x[i] + square(at.step) * y[i] : 0;
  PetscFunctionReturn(0);
}

/// Adds the strain by pressures x to `strain`: as A has it, but fluxes strain the volume of the particles. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::add_strain_by(const StepStart<dim> &at, const double *x) {
  PetscFunctionBeginUser;
  const int nodes = at.grid.node_count(), all = points(at);
  double *own = sums_.data(), *flux = own + all;
  PetscCall(find_velocities(at, x));
  for (int i = 0; i < nodes; ++i) push[i] = quad(1 / at.grid.mass[i]) * mapped_[i].solid, push[i][at_gap] = 0;
  matrices.divergence(push.data(), own);
  if (open.acts) open.find_strain(at, push.data(), own + nodes);
  PetscCall(at.grid.sum(own, 1));
  PetscCall(find_flux_divergence(at, flux));
  for (int i = 0; i < all; ++i)
    if (volume[i] > 0) strain[i] += square(at.step) * (own[i] / volume[i] + flux[i] / particle_volume[i]);
  PetscFunctionReturn(0);
}

/// The diagonal of A without S. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::find_diagonal(const StepStart<dim> &at) {
  PetscFunctionBeginUser;
  const int nodes = at.grid.node_count();
  double *mobility = sums_.data();
  for (int i = 0; i < nodes; ++i) mobility[i] = square(at.step) * (solid[i] + porosity[i] * apart[i]);
  matrices.diagonal(mobility, diagonal_.data());
  PetscCall(at.grid.sum(diagonal_.data(), 1));
  for (const int c : open.list) {
    double sum = 0;
    Vec<dim> first{};
    for (int k = dim; k >= 0; --k) {
      if (k)
        for (int d = 0; d < dim; ++d) first[d] -= at.shape[c].gradient[k - 1][d];
      const Vec<dim> &g = k ? at.shape[c].gradient[k - 1] : first;
      sum += mobility[at.shape[c].node[k]] * dot<dim>(g, g);
    }
    diagonal_[nodes + c] = square(at.weight[c]) * sum;
  }
  for (int i = 0; i < points(at); ++i) diagonal_[i] = volume[i] > 0 ? diagonal_[i] + volume[i] / stiffness[i] : 1;
  PetscFunctionReturn(0);
}

/// Finds the strain `held` that has the pressure `acting`, and the stiffness there, by Newton's method, which ends soon
/// where cells begin or cease to cavitate: their pressure is piecewise linear. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::fit_held(const StepStart<dim> &at, double allowed) {
  PetscFunctionBeginUser;
  constexpr int most_turns = 6;
  double *pressure = wanted_.data();
  for (int turn = 0; turn < most_turns; ++turn) {
    PetscCall(find_squeezed(at, pressure));
    const auto [apart] = sum(at, [&](int i) { return volume[i] * square(pressure[i] - acting[i]); });
    if (apart <= 1e-4 * allowed) break;
    for (int i = 0; i < points(at); ++i) held[i] += (pressure[i] - acting[i]) / stiffness[i];
  }
  PetscFunctionReturn(0);
}

/// Pressure goes on changing much as before: takes what a share of the last change mends from `lacking`. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::start_as_before(const StepStart<dim> &at, double *lacking, double *share) {
  PetscFunctionBeginUser;
  PetscCall(apply(at, before.data(), image_.data()));
  const auto [along, curvature] = sum(
      at, [&](int i) { return before[i] * lacking[i]; }, [&](int i) { return before[i] * image_[i]; });
  *share = curvature > 0 ? along / curvature : 0;  // with which the rest has no part along `before`
  for (int i = 0; i < points(at); ++i) lacking[i] -= *share * image_[i];
  PetscFunctionReturn(0);
}

/// Where pores become full or cease to be, stiffness changes by orders of magnitude, and a correction of the pressure
/// leads far beyond: its strain leads less far then, and the smaller of both changes counts. Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::limit_correction(const StepStart<dim> &at) {
  PetscFunctionBeginUser;
  const int all = points(at);
  for (int i = 0; i < all; ++i) held[i] -= correction_[i] / stiffness[i];
  PetscCall(find_squeezed(at, wanted_.data()));
  for (int i = 0; i < all; ++i) {
    const double by_strain = wanted_[i] - acting[i];
    if (std::abs(by_strain) < std::abs(correction_[i])) correction_[i] = by_strain;
  }
  PetscFunctionReturn(0);
}

/// One step of Newton's method: changes `acting` by the solution of A x = volume (held - strain). Collective.
template <int dim>
PetscErrorCode ImplicitPressure<dim>::correct(const StepStart<dim> &at, double enough) {
  PetscFunctionBeginUser;
  constexpr int most_iterations = 500;
  const int all = points(at);
  double *lacking = wanted_.data(), *size = sums_.data() + all;
  PetscCall(find_diagonal(at));
  for (int i = 0; i < all; ++i) lacking[i] = volume[i] * (held[i] - strain[i]);
  for (int i = 0; i < all; ++i) size[i] = volume[i] > 0 ? square(stiffness[i]) / volume[i] : 0;
  double share = 0;
  if (starts_) PetscCall(start_as_before(at, lacking, &share));
  const auto with = [&](auto &method) {
    PetscCall(method.solve(
        all, diagonal_.data(), size, lacking, correction_.data(), most_iterations, enough,
        [&](const double *x, double *y) { return apply(at, x, y); },
        [&](auto &&...term) { return sum(at, std::forward<decltype(term)>(term)...); }));
    iterations_ += method.products() + starts_;
    return PetscErrorCode(0);
  };
  PetscCall(open.acts ? with(skew_gradients) : with(gradients));
  for (int i = 0; i < all && starts_; ++i) correction_[i] += share * before[i];
  starts_ = false;
  PetscCall(limit_correction(at));
  PetscCall(add_strain_by(at, correction_.data()));
  for (int i = 0; i < all; ++i) change[i] += correction_[i], acting[i] += correction_[i];
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode ImplicitPressure<dim>::solve(const StepStart<dim> &at, bool *changed) {
  PetscFunctionBeginUser;
  constexpr double tolerance = 1e-2;  // of the pressure that acts
  constexpr double reduction = 0.1;   // of what is lacking at first: water at rest comes to rest
  constexpr double least = 1e-12;     // of the stiffness of the water
  constexpr int most_rounds = 12;
  const int all = points(at);
  std::fill_n(change.begin(), all, 0.);
  for (int k = 0; k < all && open.acts; ++k) mixture_change[k] = -borne(at, k) * acting[k];
  const double earlier = starts_ ? 0 : 1;  // solves in the step
  *changed = false;
  for (int round = 0;; ++round) {
    const auto [lacks, acts, floor] = sum(
        at, [&](int i) { return volume[i] * square((held[i] - strain[i]) * stiffness[i]); },
        [&](int i) { return volume[i] * square(acting[i]); },
        [&](int i) { return volume[i] * square(least * stiffness[i]); });
    if (first_ == 0) first_ = lacks;
    const double allowed = std::max(floor, std::min(square(tolerance) * acts, square(reduction) * first_));
    lacking_ = lacks <= allowed ? 0 : std::sqrt(lacks / acts);
    if (lacks <= allowed || round == most_rounds) break;
    PetscCall(correct(at, std::max(0.1 * allowed, 1e-4 * lacks)));
    PetscCall(fit_held(at, allowed));
    *changed = true;
  }
  for (int i = 0; i < at.grid.node_count(); ++i) before[i] = earlier * before[i] + change[i];
  for (int k = 0; k < all && open.acts; ++k) mixture_change[k] += borne(at, k) * acting[k];
  PetscFunctionReturn(0);
}

template struct ImplicitPressure<2>;
template struct ImplicitPressure<3>;

}  // namespace talus
