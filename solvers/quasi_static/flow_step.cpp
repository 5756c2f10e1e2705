#include "solvers/quasi_static/flow_step.h"

#include <algorithm>
#include <cmath>

#include "scene/quasi_static_source.h"
#include "solvers/quasi_static/line_search.h"

namespace talus {

/// Calls put(cell, Gauss point, places of the cell, its volume, gradients of the displacement's shape functions).
template <int dim>
template <class Put>
void FlowStep<dim>::each_coupling(Put &&put) const {
  std::array<Vec<dim>, element_nodes<dim>(2)> gradient;
  for (int c = 0; c < soil_->soil().mesh().cell_count(); ++c) {
    if (!flow_.active(c)) continue;
    const auto of_l = barycentric_gradients<dim>(soil_->soil().mesh().cells[c]);
    for (size_t q = 0; q < soil_->soil().rule().point.size(); ++q) {
      shape_gradients<dim>(soil_->soil().nodes().order(), soil_->soil().rule().point[q], of_l, gradient.data());
      put(c, static_cast<int>(q), soil_->soil().rule().point[q],
          soil_->soil().mesh().volume[c] * soil_->soil().rule().weight[q], gradient.data());
    }
  }
}

template <int dim>
PetscErrorCode FlowStep<dim>::setup() {
  PetscFunctionBeginUser;
  const ElementNodes<dim> &nodes = flow_.nodes();
  const MPI_Comm comm = nodes.comm();
  PetscCall(nodes.global_vector(p_));
  PetscCall(nodes.global_vector(water_));
  PetscCall(VecGetLocalSize(p_, &rows_p_));
  owned_.clear();
  for (int i = 0; i < nodes.count(); ++i)
    if (nodes.owned[i]) owned_.push_back(i);
  std::sort(owned_.begin(), owned_.end(), [&](int a, int b) { return nodes.global()[a] < nodes.global()[b]; });
  if (soil_) {
    std::vector<double> storages;
    for (int b = 0; b < static_cast<int>(soil_->soil().points().size()); ++b) storages.push_back(storage(b));
    flow_.drain_in_layers(storages);
    PetscCall(soil_->soil().nodes().global_vector(u_));
    PetscCall(soil_->soil().nodes().global_vector(force_));
    PetscCall(VecGetLocalSize(u_, &rows_u_));
  }
  PetscCall(flow_matrix_.make(comm, rows_p_, rows_p_, 1, [&] { return flow_.tangent(1, true, flow_matrix_); }));
  PetscCall(VecCreateMPI(comm, rows_u_ + rows_p_, PETSC_DETERMINE, x_.create()));
  PetscCall(VecDuplicate(x_, f_.create()));
  if (soil_) {
    const auto rectangle = [&](PetscInt rows, PetscInt columns, SparseMatrix &matrix, bool by_water) {
      const auto fill = [&]() -> PetscErrorCode {
        PetscFunctionBeginUser;
        const double zeros[element_nodes<dim>(2) * dim * (dim + 1)]{};
        PetscInt u[element_nodes<dim>(2) * dim], p[dim + 1];
        const int count = element_nodes<dim>(soil_->soil().nodes().order());
        for (int c = 0; c < soil_->soil().mesh().cell_count(); ++c) {
          if (!flow_.active(c)) continue;
          for (int a = 0; a < count * dim; ++a)
            u[a] = soil_->soil().nodes().global()[soil_->soil().nodes().of_cell(c)[a / dim]] * dim + a % dim;
          for (int b = 0; b <= dim; ++b) p[b] = nodes.global()[nodes.of_cell(c)[b]];
          if (by_water)
            PetscCall(matrix.add(dim + 1, p, count * dim, u, zeros));
          else
            PetscCall(matrix.add(count * dim, u, dim + 1, p, zeros));
        }
        PetscFunctionReturn(0);
      };
      return matrix.make(comm, rows, columns, 1, fill);
    };
    PetscCall(rectangle(rows_u_, rows_p_, press_, false));
    PetscCall(rectangle(rows_p_, rows_u_, squeeze_, true));
    Mat blocks[4] = {soil_->matrix(), press_, squeeze_, flow_matrix_};
    PetscCall(MatCreateNest(comm, 2, nullptr, 2, nullptr, blocks, blocks_.create()));
    PetscCall(MatConvert(blocks_, MATAIJ, MAT_INITIAL_MATRIX, matrix_.create()));
  }
  PetscCall(make_solver());
  PetscFunctionReturn(0);
}

/// Direct, but for seepage beyond a size or on request: GMRES with algebraic multigrid. The matrix of a consolidation
/// is indefinite, and no multigrid of its own is at hand.
template <int dim>
PetscErrorCode FlowStep<dim>::make_solver() {
  constexpr PetscInt largest_direct = dim == 2 ? 400000 : 40000;  // unknowns, as for equilibrium
  PetscInt unknowns;
  KSP ksp;
  PC pc;
  PetscFunctionBeginUser;
  const Mat matrix = soil_ ? static_cast<Mat>(matrix_) : static_cast<Mat>(flow_matrix_);
  PetscCall(SNESCreate(flow_.nodes().comm(), solver_.create()));
  PetscCall(SNESSetOptionsPrefix(solver_, "talus_flow_"));
  PetscCall(SNESSetFunction(solver_, f_, snes_function, this));
  PetscCall(SNESSetJacobian(solver_, matrix, matrix, snes_jacobian, this));
  PetscCall(SNESSetType(solver_, SNESNEWTONLS));
  PetscCall(set_line_search(solver_, soil_ ? SNESLINESEARCHCP : newton_ ? SNESLINESEARCHBT : SNESLINESEARCHBASIC));
  PetscCall(SNESSetTolerances(solver_, 0, settings_.tolerance, 0,
                              newton_ ? settings_.iterations : picard_iterations * settings_.iterations,
                              PETSC_MAX_INT));
  PetscCall(SNESSetConvergenceTest(solver_, snes_converged, this, nullptr));
  PetscCall(SNESGetKSP(solver_, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(VecGetSize(x_, &unknowns));
  if (soil_ || settings_.linear_solver == LinearSolver::direct ||
      (settings_.linear_solver == LinearSolver::automatic && unknowns <= largest_direct)) {
    PetscCall(solve_directly(ksp, matrix, Factorization::lu));
  } else {
    PetscCall(KSPSetType(ksp, KSPGMRES));
    PetscCall(KSPSetTolerances(ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, 1000));
    PetscCall(PCSetType(pc, PCGAMG));
  }
  PetscCall(SNESSetFromOptions(solver_));
  PetscFunctionReturn(0);
}

/// What the volume strain of the trial state makes room for at the nodes [m3].
template <int dim>
PetscErrorCode FlowStep<dim>::volume_strain(std::vector<double> &taken, std::vector<double> &size) const {
  PetscFunctionBeginUser;
  each_coupling([&](int c, int q, const Barycentric<dim> &l, double volume, const Vec<dim> *) {
    const auto &strain = soil_->soil().points()[flow_.body_of(c)].increment[soil_->soil().first_point(c) + q].strain;
    const double room = volume * flow_.saturation(c, l) * (strain[0] + strain[1] + strain[2]);
    for (int a = 0; a <= dim; ++a)
      taken[flow_.nodes().of_cell(c)[a]] += l[a] * room, size[flow_.nodes().of_cell(c)[a]] += l[a] * std::abs(room);
  });
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode FlowStep<dim>::residual(::Vec x, ::Vec f) {
  const double *unknown;
  double *value, *rest;
  PetscFunctionBeginUser;
  PetscCall(VecGetArrayRead(x, &unknown));
  PetscCall(VecGetArray(f, &value));
  PetscCall(VecPlaceArray(p_, unknown + rows_u_));
  PetscCall(flow_.nodes().to_local(p_, flow_.pressure));
  PetscCall(VecResetArray(p_));
  if (soil_) {
    PetscCall(VecPlaceArray(u_, unknown));
    PetscCall(VecPlaceArray(force_, value));
    PetscCall(soil_->residual(u_, force_));
    PetscCall(VecResetArray(u_));
    PetscCall(VecResetArray(force_));
  }
  PetscCall(VecRestoreArrayRead(x, &unknown));
  WaterBalance balance;
  flow_.balance(load_time_, dt_, &balance);
  if (soil_) PetscCall(volume_strain(balance.rest, balance.size));
  PetscCall(flow_.nodes().add_to_global(balance.size, water_));
  PetscCall(VecNorm(water_, NORM_2, &water_moved_));
  if (steady_) PetscCall(flow_.nodes().to_local(water_, size_));
  if (scale_open_) water_scale_ = std::max(water_scale_, water_moved_);
  PetscCall(flow_.nodes().add_to_global(balance.rest, water_));
  PetscCall(flow_.nodes().to_local(water_, rest_));
  PetscCall(VecGetArray(water_, &rest));
  for (PetscInt row = 0; row < rows_p_; ++row)
    value[rows_u_ + row] = flow_.fixed(owned_[row]) ? 0 : rest[row];  // a fixed node starts where it belongs
  PetscCall(VecRestoreArray(water_, &rest));
  PetscCall(VecRestoreArray(f, &value));
  PetscFunctionReturn(0);
}

/// How pressure pushes soil, and how soil squeezes water.
template <int dim>
PetscErrorCode FlowStep<dim>::couple() {
  PetscFunctionBeginUser;
  PetscCall(press_.clear());
  PetscCall(squeeze_.clear());
  const ElementNodes<dim> &soil = soil_->soil().nodes(), &water = flow_.nodes();
  const int count = element_nodes<dim>(soil.order());
  PetscErrorCode error = 0;
  each_coupling([&](int c, int, const Barycentric<dim> &l, double volume, const Vec<dim> *gradient) {
    PetscInt u[element_nodes<dim>(2) * dim], p[dim + 1];
    double push[element_nodes<dim>(2) * dim * (dim + 1)], room[(dim + 1) * element_nodes<dim>(2) * dim];
    const double pressed = -volume * flow_.stress_pressure_slope(c, l), filled = volume * flow_.saturation(c, l);
    for (int b = 0; b <= dim; ++b) p[b] = flow_.fixed(water.of_cell(c)[b]) ? -1 : water.global()[water.of_cell(c)[b]];
    for (int a = 0; a < count; ++a) {
      const int node = soil.of_cell(c)[a];
      const Support<dim> *s = soil_->supports().at(node);
      ColumnVector<dim> g = map<dim>(gradient[a]);
      if (s && s->turned) g = (s->frame * g).eval();
      for (int d = 0; d < dim; ++d) {
        u[a * dim + d] = s && s->held[d] ? -1 : soil.global()[node] * dim + d;
        for (int b = 0; b <= dim; ++b)
          push[(a * dim + d) * (dim + 1) + b] = pressed * l[b] * g[d],
                                           room[(b * count + a) * dim + d] = filled * l[b] * g[d];
      }
    }
    if (!error) error = press_.add(count * dim, u, dim + 1, p, push);
    if (!error) error = squeeze_.add(dim + 1, p, count * dim, u, room);
  });
  PetscCall(error);
  PetscCall(press_.finish());
  PetscCall(squeeze_.finish());
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode FlowStep<dim>::jacobian(Mat matrix) {
  PetscFunctionBeginUser;
  PetscCall(flow_matrix_.clear());
  PetscCall(flow_.tangent(dt_, newton_, flow_matrix_));
  PetscCall(flow_matrix_.finish());
  if (!soil_) PetscFunctionReturn(0);
  PetscCall(soil_->tangent());
  PetscCall(couple());
  PetscCall(MatConvert(blocks_, MATAIJ, MAT_REUSE_MATRIX, &matrix));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode FlowStep<dim>::snes_function(SNES, ::Vec x, ::Vec f, void *step) {
  return static_cast<FlowStep *>(step)->residual(x, f);
}

template <int dim>
PetscErrorCode FlowStep<dim>::snes_jacobian(SNES, ::Vec, Mat, Mat matrix, void *step) {
  return static_cast<FlowStep *>(step)->jacobian(matrix);
}

/// Forces and water must each be balanced to the tolerance, or to a hundred times as much where the search finds
/// nothing better: beside saturation a permeability by van Genuchten and Mualem rises without bound in its slope.
template <int dim>
PetscErrorCode FlowStep<dim>::snes_converged(SNES solver, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                             SNESConvergedReason *reason, void *context) {
  PetscFunctionBeginUser;
  FlowStep &step = *static_cast<FlowStep *>(context);
  ::Vec f;
  const double *value;
  *reason = SNES_CONVERGED_ITERATING;
  if (iteration == 0) {
    step.scale_open_ = false;
    if (step.soil_) step.soil_->close_scale();
  }
  PetscCall(SNESGetFunction(solver, &f, nullptr, nullptr));
  double sums[2]{};
  PetscCall(VecGetArrayRead(f, &value));
  for (PetscInt k = 0; k < step.rows_u_ + step.rows_p_; ++k) sums[k >= step.rows_u_] += value[k] * value[k];
  PetscCall(VecRestoreArrayRead(f, &value));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, step.flow_.nodes().comm()));
  double worst = 0;  // of a node, by its own terms
  if (step.steady_) {
    for (const PetscInt i : step.owned_)
      if (!step.flow_.fixed(static_cast<int>(i)) && step.size_[i] > 0)
        worst = std::max(worst, std::abs(step.rest_[i]) / step.size_[i]);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, step.flow_.nodes().comm()));
  }
  const double tolerance = step.settings_.tolerance, forces = step.soil_ ? step.soil_->force_scale() : 0;
  // water that does not move before the soil does is measured by what the soil moves, once its forces are in balance
  const double water = step.soil_ ? std::max(step.water_scale_, step.water_moved_) : step.water_scale_;
  const auto within = [&](double share) {
    return std::sqrt(sums[0]) <= share * forces && std::sqrt(sums[1]) <= share * water && worst <= share;
  };
  step.balanced_ = within(tolerance), step.nearly_balanced_ = within(stalled * tolerance);
  if (!std::isfinite(norm))
    *reason = SNES_DIVERGED_FNORM_NAN;
  else if (step.balanced_)
    *reason = SNES_CONVERGED_FNORM_RELATIVE;
  PetscFunctionReturn(0);
}

/// Newton's method stalls where nodes near saturation change sides; Picard's (Celia, Bouloutas & Zarba 1990) goes on
/// there.
template <int dim>
PetscErrorCode FlowStep<dim>::solve(double load_time, double travel, double begin, double dt, StepOutcome *outcome) {
  double *value;
  PetscFunctionBeginUser;
  *outcome = {}, load_time_ = load_time, dt_ = dt;
  for (const bool newton : {true, false}) {
    if (newton_ != newton) {
      newton_ = newton;
      PetscCall(make_solver());
    }
    water_scale_ = 0;
    PetscCall(flow_.begin(load_time, travel, begin, begin + dt));
    PetscCall(VecZeroEntries(x_));
    if (soil_) {
      PetscCall(VecGetArray(x_, &value));
      PetscCall(VecPlaceArray(u_, value));
      PetscCall(soil_->prepare(1, load_time, load_time - travel, travel, u_));
      PetscCall(VecResetArray(u_));
      PetscCall(VecRestoreArray(x_, &value));
    }
    PetscCall(seek(outcome));
    if (outcome->converged || soil_) break;
  }
  if (!outcome->converged) PetscCall(make_solver());
  PetscFunctionReturn(0);
}

/// Solves with the faces that are open, and opens and closes them, until none changes.
template <int dim>
PetscErrorCode FlowStep<dim>::seek(StepOutcome *outcome) {
  constexpr int most_changes = 50;  // of the seepage faces
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations;
  double *value;
  PetscFunctionBeginUser;
  for (int change = 0;; ++change) {
    PetscCall(VecGetArray(x_, &value));
    for (PetscInt row = 0; row < rows_p_; ++row) value[rows_u_ + row] = flow_.pressure[owned_[row]];
    PetscCall(VecRestoreArray(x_, &value));
    scale_open_ = true, balanced_ = nearly_balanced_ = false;
    PetscCall(SNESSolve(solver_, nullptr, x_));
    PetscCall(SNESGetConvergedReason(solver_, &reason));
    PetscCall(SNESGetIterationNumber(solver_, &iterations));
    outcome->iterations += static_cast<int>(iterations);
    balanced_ |= nearly_balanced_ && (reason == SNES_DIVERGED_LINE_SEARCH || reason == SNES_DIVERGED_LOCAL_MIN);
    if (!balanced_) break;
    PetscCall(residual(x_, f_));  // the state that counts, not the last that the line search tried
    if (!flow_.update_seepage(rest_)) break;
    if (change == most_changes) {
      balanced_ = false;
      break;
    }
  }
  outcome->converged = balanced_, outcome->singular = reason == SNES_DIVERGED_LINEAR_SOLVE;
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode FlowStep<dim>::commit(bool softening) {
  const double *value;
  PetscFunctionBeginUser;
  if (soil_) {
    PetscCall(VecGetArrayRead(x_, &value));
    PetscCall(VecPlaceArray(u_, value));
    PetscCall(soil_->commit(u_, softening));
    PetscCall(VecResetArray(u_));
    PetscCall(VecRestoreArrayRead(x_, &value));
  }
  flow_.commit(load_time_, dt_, rest_);
  PetscFunctionReturn(0);
}

/// Of water per volume of soil that cannot widen, and pressure [1/Pa].
template <int dim>
double FlowStep<dim>::storage(int body) const {
  return 1 / constrained_modulus(soil_->soil().points()[body].law) + flow_.porosity(body) / flow_.liquid().bulk_modulus;
}

template <int dim>
double FlowStep<dim>::shortest_step() const {
  double shortest = 1e300;
  for (int c = 0; c < soil_->soil().mesh().cell_count(); ++c) {
    if (!flow_.active(c)) continue;
    double square = 0;
    for (const Vec<dim> &g : soil_->soil().mesh().cells[c].gradient)
      square = std::max(square, map<dim>(g).squaredNorm());
    shortest = std::min(shortest, storage(flow_.body_of(c)) / (6 * square * flow_.conductivity(c)));
  }
  MPI_Allreduce(MPI_IN_PLACE, &shortest, 1, MPI_DOUBLE, MPI_MIN, flow_.nodes().comm());
  return shortest;
}

template class FlowStep<2>;
template class FlowStep<3>;

}  // namespace talus
