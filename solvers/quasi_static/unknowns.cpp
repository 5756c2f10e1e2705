#include "solvers/quasi_static/unknowns.h"

#include <algorithm>

#include "solvers/quasi_static/rigid_motions.h"

namespace talus {

template <int dim>
PetscErrorCode Unknowns<dim>::setup() {
  PetscFunctionBeginUser;
  const ElementNodes<dim> &nodes = soil_.nodes();
  PetscCall(nodes.global_vector(scratch_));
  owned_.clear(), supported_.clear();
  for (int i = 0; i < nodes.count(); ++i)
    if (nodes.owned[i]) owned_.push_back(i);
  std::sort(owned_.begin(), owned_.end(), [&](int a, int b) { return nodes.global()[a] < nodes.global()[b]; });
  for (PetscInt row = 0; row < static_cast<PetscInt>(owned_.size()); ++row)
    if (supports_.at(owned_[row])) supported_.push_back(row);
  motion_.assign(owned_.size() * dim, 0);
  long long mine = static_cast<long long>(owned_.size()) * dim;
  PetscCallMPI(MPI_Allreduce(&mine, &count_, 1, MPI_LONG_LONG, MPI_SUM, nodes.comm()));
  PetscFunctionReturn(0);
}

// ---- vectors ----

template <int dim>
void Unknowns<dim>::turn(double *global, bool clear) const {
  for (PetscInt row : supported_) {
    const Support<dim> &s = *supports_.at(owned_[row]);
    Eigen::Map<ColumnVector<dim>> v(global + row * dim);
    if (s.turned) v = (s.frame * v).eval();
    for (int d = 0; d < dim && clear; ++d)
      if (s.held[d]) v[d] = 0;
  }
}

template <int dim>
PetscErrorCode Unknowns<dim>::turn(::Vec global, bool clear) const {
  double *value;
  PetscFunctionBeginUser;
  PetscCall(VecGetArray(global, &value));
  turn(value, clear);
  PetscCall(VecRestoreArray(global, &value));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Unknowns<dim>::displacement_of(::Vec x, bool with_motion, std::vector<double> &u) const {
  double *value;
  PetscFunctionBeginUser;
  PetscCall(VecCopy(x, scratch_));
  PetscCall(VecGetArray(scratch_, &value));
  for (PetscInt row : supported_) {
    const Support<dim> &s = *supports_.at(owned_[row]);
    Eigen::Map<ColumnVector<dim>> v(value + row * dim);
    for (int d = 0; d < dim; ++d)
      if (s.held[d]) v[d] = with_motion ? motion_[row * dim + d] : 0;
    if (s.turned) v = (s.frame.transpose() * v).eval();
  }
  PetscCall(VecRestoreArray(scratch_, &value));
  PetscCall(soil_.nodes().to_local(scratch_, u));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Unknowns<dim>::find_motion(double time, double dt, std::vector<double> &motion, bool *moves) const {
  PetscFunctionBeginUser;
  const ElementNodes<dim> &nodes = soil_.nodes();
  int moved = 0;
  motion.assign(static_cast<size_t>(nodes.count()) * dim, 0);
  for (int i = 0; i < nodes.count(); ++i)
    if (supports_.at(i)) {
      const Vec<dim> g = supports_.increment(i, nodes.position[i], time, time + dt);
      std::copy(g.begin(), g.end(), &motion[i * dim]);
      for (double component : g) moved |= component != 0;
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &moved, 1, MPI_INT, MPI_MAX, nodes.comm()));
  *moves = moved;
  PetscFunctionReturn(0);
}

template <int dim>
void Unknowns<dim>::set_motion(const std::vector<double> &motion) {
  std::fill(motion_.begin(), motion_.end(), 0.);
  for (size_t row = 0; row < owned_.size() && !motion.empty(); ++row)
    std::copy_n(&motion[owned_[row] * dim], dim, &motion_[row * dim]);
}

// ---- matrices ----

template <int dim>
PetscErrorCode Unknowns<dim>::make_matrix(SparseMatrix &matrix, const std::function<PetscErrorCode()> &add_more) const {
  PetscFunctionBeginUser;
  const PetscInt rows = static_cast<PetscInt>(owned_.size()) * dim;
  std::vector<PetscInt> row;
  std::vector<double> zeros;
  const auto fill = [&]() -> PetscErrorCode {
    PetscFunctionBeginUser;
    PetscCall(soil_.each_element([&](const int *node, int count) -> PetscErrorCode {
      PetscFunctionBeginUser;
      rows_of(node, count, row);
      zeros.resize(row.size() * row.size(), 0);
      PetscCall(matrix.add(count * dim, row.data(), count * dim, row.data(), zeros.data()));
      PetscFunctionReturn(0);
    }));
    PetscCall(add_more());
    PetscFunctionReturn(0);
  };
  PetscCall(matrix.make(soil_.nodes().comm(), rows, rows, dim, fill));
  PetscFunctionReturn(0);
}

template <int dim>
void Unknowns<dim>::rows_of(const int *node, int count, std::vector<PetscInt> &row) const {
  row.resize(static_cast<size_t>(count) * dim);
  for (int k = 0; k < count * dim; ++k) row[k] = soil_.nodes().global()[node[k / dim]] * dim + k % dim;
}

template <int dim>
PetscErrorCode Unknowns<dim>::add(SparseMatrix &matrix, const int *node, int count,
                                  typename SoilElements<dim>::Stiffness &element, const std::vector<double> *motion,
                                  std::vector<double> *lift) const {
  PetscFunctionBeginUser;
  std::vector<PetscInt> row;
  rows_of(node, count, row);
  for (int a = 0; a < count; ++a) {
    const Support<dim> *s = supports_.at(node[a]);
    if (!s || !s->turned) continue;
    element.middleRows(a * dim, dim) = (s->frame * element.middleRows(a * dim, dim)).eval();
    element.middleCols(a * dim, dim) = (element.middleCols(a * dim, dim) * s->frame.transpose()).eval();
  }
  for (int a = 0; a < count; ++a)
    if (const Support<dim> *s = supports_.at(node[a]))
      for (int d = 0; d < dim; ++d)
        if (s->held[d]) {
          if (lift)
            for (int b = 0; b < count; ++b)
              for (int e = 0; e < dim; ++e)
                (*lift)[node[b] * dim + e] += element(b * dim + e, a * dim + d) * (*motion)[node[a] * dim + d];
          element.row(a * dim + d).setZero(), element.col(a * dim + d).setZero();
        }
  PetscCall(matrix.add(count * dim, row.data(), count * dim, row.data(), element.data()));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Unknowns<dim>::finish(SparseMatrix &matrix, double diagonal) const {
  PetscFunctionBeginUser;
  PetscInt first;
  PetscCall(MatGetOwnershipRange(matrix, &first, nullptr));
  for (PetscInt row : supported_)
    for (int d = 0; d < dim; ++d)
      if (const PetscInt k = first + row * dim + d; supports_.at(owned_[row])->held[d])
        PetscCall(matrix.add(1, &k, 1, &k, &diagonal));
  PetscCall(matrix.finish());
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Unknowns<dim>::tell_rigid_motions(Mat matrix) const {
  constexpr int modes = rigid_modes<dim>;
  std::array<::Vec, modes> mode;
  MatNullSpace space;
  PetscFunctionBeginUser;
  for (int m = 0; m < modes; ++m) {
    double *value;
    PetscCall(VecDuplicate(scratch_, &mode[m]));
    PetscCall(VecGetArray(mode[m], &value));
    for (size_t row = 0; row < owned_.size(); ++row) {
      const Vec<dim> v = rigid_motion<dim>(m, soil_.nodes().position[owned_[row]]);
      std::copy(v.begin(), v.end(), value + row * dim);
    }
    turn(value, true);
    PetscCall(VecRestoreArray(mode[m], &value));
    for (int k = 0; k < m; ++k) {
      double dot;
      PetscCall(VecDot(mode[m], mode[k], &dot));
      PetscCall(VecAXPY(mode[m], -dot, mode[k]));
    }
    PetscCall(VecNormalize(mode[m], nullptr));
  }
  PetscCall(MatNullSpaceCreate(soil_.nodes().comm(), PETSC_FALSE, modes, mode.data(), &space));
  PetscCall(MatSetNearNullSpace(matrix, space));
  PetscCall(MatNullSpaceDestroy(&space));
  for (::Vec &m : mode) PetscCall(VecDestroy(&m));
  PetscFunctionReturn(0);
}

template class Unknowns<2>;
template class Unknowns<3>;

}  // namespace talus
