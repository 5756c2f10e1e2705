/// What is wrong with a problem before it is solved: rigid motions that supports leave to a piece of soil (the null space of its stiffness), and
/// bodies that have one element across.
#include <algorithm>
#include <map>
#include <sstream>

#include "solvers/quasi_static/quasi_static.h"

namespace talus {
namespace {

template <int dim>
constexpr int rigid_modes = dim * (dim + 1) / 2;

/// Velocity of rigid mode m at a place relative to a centre: translations, then rotations.
template <int dim>
Vec<dim> rigid_motion(int m, const Vec<dim> &r) {
  Vec<dim> v{};
  if (m < dim) {
    v[m] = 1;
  } else {
    const int i = dim == 2 ? 0 : m - dim, j = dim == 2 ? 1 : (m - dim + 1) % 3;
    v[i] = -r[j], v[j] = r[i];
  }
  return v;
}

template <int dim>
std::string describe(const ColumnVector<rigid_modes<dim>> &mode) {
  int axis = 0;
  mode.cwiseAbs().maxCoeff(&axis);
  const char names[] = "xyz";
  if (axis < dim) return std::string("along ") + names[axis];
  return dim == 2 ? std::string("by turning") : std::string("by turning about ") + names[(axis - dim + 2) % 3];
}

}  // namespace

template <int dim>
PetscErrorCode QuasiStatic<dim>::find_freedom(std::string *freedom) const {
  constexpr int modes = rigid_modes<dim>;
  PetscFunctionBeginUser;
  // pieces of soil: nodes that cells join, named by the largest global number in them
  std::vector<PetscInt> piece = nodes_.global();
  for (int changed = 1; changed;) {
    changed = 0;
    for (bool again = true; again;) {
      again = false;
      for (const Group &g : groups_) {
        PetscInt largest = -1;
        for (int k = 0; k < g.nodes; ++k) largest = std::max(largest, piece[group_node_[g.first_node + k]]);
        for (int k = 0; k < g.nodes; ++k) {
          PetscInt &mine = piece[group_node_[g.first_node + k]];
          if (mine < largest) mine = largest, again = true, changed = 1;
        }
      }
    }
    PetscCall(nodes_.maximum(piece));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, nodes_.comm()));
  }
  std::vector<PetscInt> mine, names;
  for (int i = 0; i < nodes_.count(); ++i)
    if (nodes_.global()[i] == piece[i] && nodes_.owned[i]) mine.push_back(piece[i]);
  int ranks, count = static_cast<int>(mine.size());
  PetscCallMPI(MPI_Comm_size(nodes_.comm(), &ranks));
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, nodes_.comm()));
  for (int r = 0; r < ranks; ++r) starts[r + 1] = starts[r] + counts[r];
  names.resize(starts[ranks]);
  PetscCallMPI(MPI_Allgatherv(mine.data(), count, MPIU_INT, names.data(), counts.data(), starts.data(), MPIU_INT, nodes_.comm()));
  std::map<PetscInt, size_t> number;
  for (size_t k = 0; k < names.size(); ++k) number[names[k]] = k;

  // centre and size of each piece, then what the supports hold of its rigid modes
  constexpr int width = dim + 2 + modes * modes;
  std::vector<double> sums(names.size() * width, 0);
  const auto add_up = [&]() { return MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, nodes_.comm()); };
  for (int i = 0; i < nodes_.count(); ++i) {
    if (!nodes_.owned[i]) continue;
    double *s = &sums[number.at(piece[i]) * width];
    s[0] += 1;
    for (int d = 0; d < dim; ++d) s[1 + d] += nodes_.position[i][d], s[1 + dim] += nodes_.position[i][d] * nodes_.position[i][d];
  }
  PetscCallMPI(add_up());
  std::vector<Vec<dim>> centre(names.size());
  std::vector<double> radius(names.size());
  for (size_t k = 0; k < names.size(); ++k) {
    double *s = &sums[k * width], square = s[1 + dim] / s[0];
    for (int d = 0; d < dim; ++d) centre[k][d] = s[1 + d] / s[0], square -= centre[k][d] * centre[k][d];
    radius[k] = std::sqrt(std::max(square, 1e-300));
  }
  std::fill(sums.begin(), sums.end(), 0.);
  for (int i = 0; i < nodes_.count(); ++i) {
    const Support<dim> *support = nodes_.owned[i] ? supports_.at(i) : nullptr;
    if (!support) continue;
    const size_t k = number.at(piece[i]);
    Vec<dim> r;
    for (int d = 0; d < dim; ++d) r[d] = (nodes_.position[i][d] - centre[k][d]) / radius[k];
    for (int c = 0; c < support->count; ++c) {
      ColumnVector<modes> row;
      for (int m = 0; m < modes; ++m) {
        const Vec<dim> v = rigid_motion<dim>(m, r);
        row[m] = map<dim>(v).dot(map<dim>(support->direction[c]));
      }
      Eigen::Map<Square<modes>>(&sums[k * width]) += row * row.transpose();
    }
  }
  PetscCallMPI(add_up());
  std::ostringstream text;
  for (size_t k = 0; k < names.size(); ++k) {
    const Eigen::SelfAdjointEigenSolver<Square<modes>> eigen(Eigen::Map<const Square<modes>>(&sums[k * width]));
    if (eigen.eigenvalues()[0] > 1e-8 * std::max(1., eigen.eigenvalues()[modes - 1])) continue;
    text << (text.tellp() > 0 ? "; " : "") << "the piece around (";
    for (int d = 0; d < dim; ++d) text << (d ? ", " : "") << centre[k][d];
    text << ") m can move " << describe<dim>(eigen.eigenvectors().col(0));
  }
  *freedom = text.str();
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::find_thin_bodies(std::vector<char> *thin) const {
  PetscFunctionBeginUser;
  thin->assign(points_.size(), 0);
  for (size_t b = 0; b < points_.size(); ++b) {
    std::vector<PetscInt> touched(nodes_.count(), 0), surface(nodes_.count(), 0);
    for (int c = 0; c < mesh_.cell_count(); ++c) {
      if (!active_[c]) continue;
      const Cell<dim> &cell = mesh_.cells[c];
      for (int k = 0; k <= dim; ++k) {
        const int across = cell.neighbour[k], node = nodes_.at_vertex(cell.node[k]);
        (body_of_[c] == static_cast<int>(b) ? touched : surface)[node] = 1;
        if (across == boundary || (across >= 0 && !active_[across]))
          for (int a = 0; a <= dim; ++a)
            if (a != k) surface[nodes_.at_vertex(cell.node[a])] = 1;
      }
    }
    PetscCall(nodes_.maximum(touched));
    PetscCall(nodes_.maximum(surface));
    int inside = 0;
    for (int i = 0; i < nodes_.count(); ++i) inside |= touched[i] && !surface[i];
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &inside, 1, MPI_INT, MPI_MAX, nodes_.comm()));
    (*thin)[b] = points_[b].present && !inside;
  }
  PetscFunctionReturn(0);
}

template PetscErrorCode QuasiStatic<2>::find_thin_bodies(std::vector<char> *) const;
template PetscErrorCode QuasiStatic<3>::find_thin_bodies(std::vector<char> *) const;
template PetscErrorCode QuasiStatic<2>::find_freedom(std::string *) const;
template PetscErrorCode QuasiStatic<3>::find_freedom(std::string *) const;

}  // namespace talus
