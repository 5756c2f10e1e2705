/// What is wrong with a problem before it is solved: rigid motions that supports leave to a piece of soil (the null
/// space of its stiffness).
#include <algorithm>
#include <map>
#include <sstream>

#include "solvers/quasi_static/pieces.h"
#include "solvers/quasi_static/quasi_static.h"
#include "solvers/quasi_static/rigid_motions.h"

namespace talus {
namespace {

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
PetscErrorCode QuasiStatic<dim>::find_freedom(double load_time, std::string *freedom) {
  constexpr int modes = rigid_modes<dim>;
  const ElementNodes<dim> &nodes = soil_.nodes();
  PetscFunctionBeginUser;
  // pieces of soil: nodes that cells join, named by the largest global number in them
  std::vector<PetscInt> piece = nodes.global();
  PetscCall(spread_labels<dim>(
      nodes, [&](const auto &visit) { return soil_.each_element(visit); }, piece));
  std::vector<PetscInt> mine;
  for (int i = 0; i < nodes.count(); ++i)
    if (nodes.global()[i] == piece[i] && nodes.owned[i]) mine.push_back(piece[i]);
  std::map<PetscInt, size_t> number;
  PetscCall(number_labels(nodes.comm(), mine, &number));

  // centre and size of each piece, then what the supports hold of its rigid modes
  constexpr int width = dim + 2 + modes * modes;
  std::vector<double> sums(number.size() * width, 0);
  const auto add_up = [&]() {
    return MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, nodes.comm());
  };
  for (int i = 0; i < nodes.count(); ++i) {
    if (!nodes.owned[i]) continue;
    double *s = &sums[number.at(piece[i]) * width];
    s[0] += 1;
    for (int d = 0; d < dim; ++d)
      s[1 + d] += nodes.position[i][d], s[1 + dim] += nodes.position[i][d] * nodes.position[i][d];
  }
  PetscCallMPI(add_up());
  std::vector<Vec<dim>> centre(number.size());
  std::vector<double> radius(number.size());
  for (size_t k = 0; k < number.size(); ++k) {
    double *s = &sums[k * width], square = s[1 + dim] / s[0];
    for (int d = 0; d < dim; ++d) centre[k][d] = s[1 + d] / s[0], square -= centre[k][d] * centre[k][d];
    radius[k] = std::sqrt(std::max(square, 1e-300));
  }
  std::fill(sums.begin(), sums.end(), 0.);
  const auto hold = [&](int i, const Vec<dim> &direction) {
    const size_t k = number.at(piece[i]);
    Vec<dim> r;
    for (int d = 0; d < dim; ++d) r[d] = (nodes.position[i][d] - centre[k][d]) / radius[k];
    ColumnVector<modes> row;
    for (int m = 0; m < modes; ++m) {
      const Vec<dim> v = rigid_motion<dim>(m, r);
      row[m] = map<dim>(v).dot(map<dim>(direction));
    }
    Eigen::Map<Square<modes>>(&sums[k * width]) += row * row.transpose();
  };
  for (int i = 0; i < nodes.count(); ++i)
    if (const Support<dim> *support = nodes.owned[i] ? supports_.at(i) : nullptr)
      for (int c = 0; c < support->count; ++c) hold(i, support->direction[c]);
  bases_.set_strength(load_time);
  bases_.each_hold(hold);
  PetscCallMPI(add_up());
  std::ostringstream text;
  for (size_t k = 0; k < number.size(); ++k) {
    const Eigen::SelfAdjointEigenSolver<Square<modes>> eigen{Eigen::Map<const Square<modes>>(&sums[k * width])};
    if (eigen.eigenvalues()[0] > 1e-8 * std::max(1., eigen.eigenvalues()[modes - 1])) continue;
    text << (text.tellp() > 0 ? "; " : "") << "the piece around (";
    for (int d = 0; d < dim; ++d) text << (d ? ", " : "") << centre[k][d];
    text << ") m can move " << describe<dim>(eigen.eigenvectors().col(0));
  }
  *freedom = text.str();
  PetscFunctionReturn(0);
}

template PetscErrorCode QuasiStatic<2>::find_freedom(double, std::string *);
template PetscErrorCode QuasiStatic<3>::find_freedom(double, std::string *);

}  // namespace talus
