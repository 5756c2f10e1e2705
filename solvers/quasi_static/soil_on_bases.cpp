// Equilibrium where Newton's iterations fail, of soil on bases with friction above all, docs/theory/finite_elements.md
// sections 2.1 and 3.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "scene/quasi_static_source.h"
#include "scene/scene.h"
#include "solvers/quasi_static/quasi_static.h"

namespace talus {

/// Where slip turns back within a step, the next step leads back, and both repeat without end: of a step that goes
/// against the `last` one, which then becomes `direction`, the share is taken after which slip has turned by a right
/// angle somewhere. All of other steps is taken.
template <int dim>
PetscErrorCode QuasiStatic<dim>::share_of_step(::Vec direction, ::Vec last, double *share) {
  constexpr double against = -0.5;  // cosine
  constexpr double least = 1. / 16, of_no_turn = 0.5;
  double now, before, along;
  PetscFunctionBeginUser;
  *share = 1;
  PetscCall(VecNorm(direction, NORM_2, &now));
  PetscCall(VecNorm(last, NORM_2, &before));
  PetscCall(VecDot(direction, last, &along));
  PetscCall(VecCopy(direction, last));
  if (!(along < against * now * before)) PetscFunctionReturn(0);
  std::vector<double> u;
  PetscCall(unknowns_.displacement_of(direction, false, u));
  for (double &way : u) way = -way;
  double turn = bases_.until_turn(u);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &turn, 1, MPI_DOUBLE, MPI_MIN, soil_.nodes().comm()));
  *share = turn < 1 ? std::max(turn, least) : of_no_turn;
  PetscFunctionReturn(0);
}

/// Newton's iterations with full steps, against a prop of elastic stiffness that works on the step of an iteration
/// only: where contact opens, nothing else may hold a corner of the soil. The prop becomes softer as the forces out of
/// balance become smaller, and stiffer where they become larger than those at the start.
template <int dim>
PetscErrorCode QuasiStatic<dim>::relax(int *iterations, double *unbalanced, Way *way) {
  constexpr double first_prop = 0.1, stiffest = 1e6;  // of the elastic stiffness
  constexpr double largest_growth = 4;  // of the force out of balance over that at the start: contact that opens
  constexpr double lasting = 0.75;      // share of the push on the prop that is left where soil moves
  Vector direction, last, trial;
  double norm, after, first_norm, step, share;
  bool solved;
  PetscFunctionBeginUser;
  const int most = 2 * scene_.quasi_static->iterations;
  *way = Way::lost;
  PetscCall(VecDuplicate(x_, direction.create()));
  PetscCall(VecDuplicate(x_, last.create()));
  PetscCall(VecDuplicate(x_, trial.create()));
  PetscCall(VecZeroEntries(last));
  PetscCall(residual(x_, f_));
  scale_open_ = false;
  PetscCall(VecNorm(f_, NORM_2, &norm));
  double size = 0;  // of an element
  for (const GaussPoints<dim> &p : soil_.points())
    for (int q = 0; q < p.count(); ++q)
      if (soil_.active(p.cell[q])) size = std::max(size, p.size[q]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_MAX, soil_.nodes().comm()));
  first_norm = share_ > 0 ? std::max(norm, force_scale_) : norm;
  double prop = first_prop, ratio = 1;
  struct Mark {  ///< an iterate to which later ones are compared
    double push, prop;
  } mark{0, 0};
  for (int k = 0;; ++k) {
    *iterations = k, *unbalanced = force_scale_ > 0 ? norm / force_scale_ : norm;
    balanced_ = norm <= scene_.quasi_static->tolerance * force_scale_;
    if (iterated && force_scale_ > 0) iterated(k, *unbalanced);
    if (balanced_) *way = Way::balanced;
    if (balanced_ || k == most || !std::isfinite(norm)) break;
    if (stop_asked && stop_asked()) {
      stopped_ = true;
      break;
    }
    PetscCall(stiffness(1, prop));
    PetscCall(solve_linear(f_, direction, &solved));
    if (solved) {
      PetscCall(share_of_step(direction, last, &share));
      PetscCall(VecWAXPY(trial, -share, direction, x_));
      PetscCall(residual(trial, f_));
      PetscCall(VecNorm(f_, NORM_2, &after));
    }
    if (!solved || !(after <= largest_growth * first_norm)) {
      if (prop >= stiffest) break;
      prop *= 10, mark = {0, 0};
      PetscCall(residual(x_, f_));
      continue;
    }
    PetscCall(VecNorm(direction, NORM_INFINITY, &step));
    const double before = std::exchange(ratio, after / norm);
    PetscCall(VecCopy(trial, x_));
    norm = after;

    // what moves goes ten times as far against a prop ten times softer, which it pushes as much; the force out of
    // balance tells less, since it has what yields to and fro in soil that moves
    double moved;
    PetscCall(VecNorm(x_, NORM_INFINITY, &moved));
    const double push = prop * step;
    if (!(push > lasting * mark.push && push < mark.push / lasting)) mark = {push, prop};
    if (prop < 0.101 * mark.prop && moved > size) {
      *way = Way::moving, *iterations = k + 1, *unbalanced = norm / force_scale_;
      break;
    }
    const bool stalls = ratio > 0.9 && ratio < 1.1 && before > 0.9 && before < 1.1;
    prop *= stalls ? 0.1 : std::clamp(ratio, 0.1, 1.);
  }
  moving_.clear(), moving_where_.clear();
  if (*way == Way::balanced || stopped_ || !std::isfinite(norm)) PetscFunctionReturn(0);
  PetscCall(find_moving(direction, *way == Way::lost ? "moved most" : "move without end"));
  PetscFunctionReturn(0);
}

/// Cells with a node that moves by more than a hundredth of the largest step, and a sentence on `how` they do.
template <int dim>
PetscErrorCode QuasiStatic<dim>::find_moving(::Vec direction, const char *how) {
  std::vector<double> u;
  double largest = 0;
  PetscFunctionBeginUser;
  PetscCall(unknowns_.displacement_of(direction, false, u));
  const BackgroundMesh<dim> &mesh = soil_.mesh();
  const ElementNodes<dim> &nodes = soil_.nodes();
  for (const double value : u) largest = std::max(largest, std::abs(value));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, nodes.comm()));
  std::vector<char> moves(nodes.count(), 0);
  for (int i = 0; i < nodes.count(); ++i)
    for (int d = 0; d < dim; ++d) moves[i] = moves[i] || std::abs(u[i * dim + d]) > 0.01 * largest;
  moving_.assign(mesh.cell_count(), 0);
  std::array<double, dim + 5> sums{};  // volume of what moves and of all, areas of bases, and place
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (!soil_.active(c)) continue;
    const int *node = nodes.of_cell(c);
    moving_[c] = std::any_of(node, node + element_nodes<dim>(nodes.order()), [&](int i) { return moves[i]; });
    sums[1] += mesh.volume[c];
    if (!moving_[c]) continue;
    Barycentric<dim> middle;
    middle.fill(1. / (dim + 1));
    const Vec<dim> x = place_in(mesh, c, middle);
    sums[0] += mesh.volume[c];
    for (int d = 0; d < dim; ++d) sums[5 + d] += mesh.volume[c] * x[d];
  }
  const std::array<double, 3> areas = bases_.areas(moves);
  std::copy(areas.begin(), areas.end(), sums.begin() + 2);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums.data(), dim + 5, MPI_DOUBLE, MPI_SUM, nodes.comm()));
  std::ostringstream text;
  text.precision(3);
  text << sums[0] << (dim == 3 ? " m3" : " m2") << " of soil (" << 100 * sums[0] / sums[1] << " % of it) " << how
       << " around (";
  text.precision(6);
  for (int d = 0; d < dim; ++d) text << (d ? ", " : "") << sums[5 + d] / sums[0];
  text << ") m";
  text.precision(2);
  if (bases_.any() && sums[2] == 0)
    text << ", away from all bases";
  else if (bases_.any())
    text << ", with the base under them open over " << 100 * sums[3] / sums[2] << " % of its area and slipping over "
         << 100 * sums[4] / sums[2] << " %";
  moving_where_ = text.str();
  PetscFunctionReturn(0);
}

/// Before any load is borne, pieces of the mesh that hang and that no base holds leave the problem.
template <int dim>
PetscErrorCode QuasiStatic<dim>::leave_out_hanging(bool *found) {
  CellSet hanging;
  LeftOut<dim> more;
  PetscFunctionBeginUser;
  *found = false;
  if (share_ != 0 || !bases_.any()) PetscFunctionReturn(0);
  PetscCall(hanging_pieces(soil_, moving_, &hanging, &more));
  if (more.pieces == 0 || left_out_.share + more.share > most_left_out) PetscFunctionReturn(0);
  *found = true;
  if (more.largest > left_out_.largest) left_out_.largest = more.largest, left_out_.place = more.place;
  left_out_.pieces += more.pieces, left_out_.volume += more.volume, left_out_.share += more.share;
  soil_.leave_out(soil_.left_out().empty() ? hanging : either(soil_.left_out(), hanging));
  PetscCall(activate_again());
  PetscCall(begin_path(load_time_));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode QuasiStatic<dim>::advance_on_bases(double share, double load_time, double time, double dt,
                                                  StepOutcome *outcome) {
  constexpr int most_searches = 20;
  PetscFunctionBeginUser;
  for (int k = 0; k < most_searches; ++k) {
    int iterations;
    Way way;
    PetscCall(prepare(share, load_time, time, dt, x_));
    PetscCall(relax(&iterations, &outcome->residual, &way));
    outcome->iterations += iterations;
    PetscCall(VecNorm(x_, NORM_INFINITY, &outcome->largest));
    outcome->moving = way == Way::moving ? moving_where_ : "";
    if (way == Way::moving) {
      bool found;
      PetscCall(make_solver());
      PetscCall(leave_out_hanging(&found));
      if (found) continue;
    }
    break;
  }
  PetscFunctionReturn(0);
}

template PetscErrorCode QuasiStatic<2>::advance_on_bases(double, double, double, double, StepOutcome *);
template PetscErrorCode QuasiStatic<3>::advance_on_bases(double, double, double, double, StepOutcome *);

}  // namespace talus
