#include "solvers/quasi_static/structures_in_soil.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/rounded.h"
#include "physics/structures/placed_points.h"

namespace talus {
/// Coefficients of a node for the stretch of the two elements at a point.
template <int dim>
struct StructuresInSoil<dim>::Column {
  int bar, point;
  PetscInt node;
  double shape;
  std::array<double, dim * dim> frame;
  std::array<char, dim> held;
};

template <int dim>
void StructuresInSoil<dim>::each_present(const std::function<void(Bar<dim> &, std::size_t)> &visit) const {
  for (std::size_t b = 0; structures_ && b < structures_->bars().size(); ++b)
    if (structures_->bars()[b].present) visit(structures_->bars()[b], b);
}

template <int dim>
PetscErrorCode StructuresInSoil<dim>::activate() {
  PetscFunctionBeginUser;
  places_.clear();
  if (!any()) PetscFunctionReturn(0);
  const BackgroundMesh<dim> &mesh = soil_.mesh();
  std::vector<int> cells;
  for (int c = 0; c < mesh.cell_count(); ++c)
    if (soil_.active(c)) cells.push_back(c);
  std::vector<Vec<dim>> points;
  std::vector<std::pair<int, int>> of;  // bar and point
  each_present([&](const Bar<dim> &bar, std::size_t b) {
    for (int i = 0; i < bar.points(); ++i) points.push_back(bar.place[i]), of.emplace_back(static_cast<int>(b), i);
  });
  std::vector<char> found;
  for (const PlacedPoint<dim> &one : place_points<dim>(mesh, cells, points, &found)) {
    Place &place = places_.emplace_back(Place{of[one.point].first, of[one.point].second, one.cell, {}});
    place.shape.resize(element_nodes<dim>(soil_.nodes().order()));
    shape_functions<dim>(soil_.nodes().order(), one.coordinate, place.shape.data());
  }
  for (std::size_t k = 0; k < of.size(); ++k) structures_->bars()[of[k].first].in_soil[of[k].second] = found[k];
  std::sort(places_.begin(), places_.end(),
            [](const Place &a, const Place &b) { return std::tie(a.bar, a.point) < std::tie(b.bar, b.point); });
  each_present([](Bar<dim> &bar, std::size_t) { bar.find_absent(); });
  PetscCall(find_nodes());
  PetscFunctionReturn(0);
}

/// The nodes around each bar, on whatever rank, so that each rank can make the rows that it has.
template <int dim>
PetscErrorCode StructuresInSoil<dim>::find_nodes() {
  PetscFunctionBeginUser;
  const ElementNodes<dim> &nodes = soil_.nodes();
  std::vector<Column> columns;
  for (const Place &place : places_)
    for (std::size_t a = 0; a < place.shape.size(); ++a) {
      const int node = nodes.of_cell(place.cell)[a];
      const Support<dim> *support = supports_.at(node);
      Column one{place.bar, place.point, nodes.global()[node], place.shape[a], {}, {}};
      Eigen::Map<Square<dim>> frame(one.frame.data());
      frame.setIdentity();
      if (support && support->turned) frame = support->frame;
      if (support) one.held = support->held;
      columns.push_back(one);
    }
  int ranks;
  PetscCallMPI(MPI_Comm_size(nodes.comm(), &ranks));
  std::vector<int> count(ranks), start(ranks, 0);
  const int mine = static_cast<int>(columns.size() * sizeof(Column));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, count.data(), 1, MPI_INT, nodes.comm()));
  for (int r = 1; r < ranks; ++r) start[r] = start[r - 1] + count[r - 1];
  std::vector<Column> all((start.back() + count.back()) / sizeof(Column));
  PetscCallMPI(
      MPI_Allgatherv(columns.data(), mine, MPI_BYTE, all.data(), count.data(), start.data(), MPI_BYTE, nodes.comm()));
  std::stable_sort(all.begin(), all.end(), [](const Column &a, const Column &b) {
    return std::tie(a.bar, a.point) < std::tie(b.bar, b.point);
  });

  nodes_.assign(structures_->bars().size(), {});
  std::vector<std::map<PetscInt, int>> number(nodes_.size());
  for (const Column &one : all) number[one.bar].emplace(one.node, 0);
  for (std::size_t b = 0; b < nodes_.size(); ++b) {
    int next = 0;
    for (auto &[node, place] : number[b]) {
      place = next++;
      for (int d = 0; d < dim; ++d) nodes_[b].row.push_back(node * dim + d);
    }
    nodes_[b].stretch_of.setZero(structures_->bars()[b].elements(), next * dim);
  }
  for (const Column &one : all) {
    const Bar<dim> &bar = structures_->bars()[one.bar];
    const Eigen::Map<const Square<dim>> frame(one.frame.data());
    const int first = number[one.bar].at(one.node) * dim;
    for (const auto &[element, sign] : {std::pair{one.point - 1, 1.}, {one.point, -1.}}) {
      if (element < 0 || element >= bar.elements()) continue;
      const ColumnVector<dim> along = frame * map<dim>(bar.direction[element]);
      for (int d = 0; d < dim; ++d)
        if (!one.held[d]) nodes_[one.bar].stretch_of(element, first + d) += sign * one.shape * along[d];
    }
  }
  PetscFunctionReturn(0);
}

/// Stretch of the elements of each bar by nodal increments [m]; empty for bars that are not there. Collective.
template <int dim>
std::vector<std::vector<double>> StructuresInSoil<dim>::stretches(const std::vector<double> &u) const {
  const std::vector<Bar<dim>> &bars = structures_->bars();
  std::vector<std::size_t> first{0};
  for (const Bar<dim> &bar : bars) first.push_back(first.back() + (bar.present ? bar.elements() : 0));
  std::vector<double> all(first.back(), 0);
  for (const Place &place : places_) {
    const Bar<dim> &bar = bars[place.bar];
    Vec<dim> way{};
    for (std::size_t a = 0; a < place.shape.size(); ++a)
      for (int d = 0; d < dim; ++d) way[d] += place.shape[a] * u[soil_.nodes().of_cell(place.cell)[a] * dim + d];
    double *stretch = &all[first[place.bar]];
    if (place.point > 0) stretch[place.point - 1] += dot<dim>(bar.direction[place.point - 1], way);
    if (place.point < bar.elements()) stretch[place.point] -= dot<dim>(bar.direction[place.point], way);
  }
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, soil_.nodes().comm());
  std::vector<std::vector<double>> by_bar;
  for (std::size_t b = 0; b < bars.size(); ++b) {
    by_bar.emplace_back(all.begin() + first[b], all.begin() + first[b + 1]);
    for (std::size_t e = 0; e < by_bar[b].size(); ++e)
      if (bars[b].chain.element[e].absent) by_bar[b][e] = 0;
  }
  return by_bar;
}

/// Forces on local nodes of axial forces.
template <int dim>
void StructuresInSoil<dim>::force_of(const std::function<double(const BarChain &, int)> &axial,
                                     std::vector<double> &force) const {
  for (const Place &place : places_) {
    const Bar<dim> &bar = structures_->bars()[place.bar];
    Vec<dim> sum{};
    if (place.point > 0) add_scaled<dim>(sum, axial(bar.chain, place.point - 1), bar.direction[place.point - 1]);
    if (place.point < bar.elements()) add_scaled<dim>(sum, -axial(bar.chain, place.point), bar.direction[place.point]);
    for (std::size_t a = 0; a < place.shape.size(); ++a)
      for (int d = 0; d < dim; ++d) force[soil_.nodes().of_cell(place.cell)[a] * dim + d] += place.shape[a] * sum[d];
  }
}

template <int dim>
void StructuresInSoil<dim>::add_trial_force(const std::vector<double> &u, std::vector<double> &force) {
  if (!any()) return;
  const auto by_bar = stretches(u);
  each_present([&](Bar<dim> &bar, std::size_t b) { bar.chain.deform(by_bar[b]); });
  force_of([](const BarChain &chain, int e) { return chain.force(e); }, force);
}

template <int dim>
void StructuresInSoil<dim>::add_force(std::vector<double> &force) const {
  if (any()) force_of([](const BarChain &chain, int e) { return chain.committed_force(e); }, force);
}

template <int dim>
void StructuresInSoil<dim>::commit(const std::vector<double> &u) {
  if (!any()) return;
  const auto by_bar = stretches(u);
  each_present([&](Bar<dim> &bar, std::size_t b) {
    bar.chain.deform(by_bar[b]);
    bar.chain.commit();
  });
}

// ---- stiffness ----

template <int dim>
PetscErrorCode StructuresInSoil<dim>::add_room(SparseMatrix &matrix) const {
  PetscFunctionBeginUser;
  for (const Nodes &nodes : nodes_) {
    const PetscInt count = static_cast<PetscInt>(nodes.row.size());
    const std::vector<double> zeros(nodes.row.size() * nodes.row.size(), 0);
    if (any()) PetscCall(matrix.add_here(count, nodes.row.data(), zeros.data()));
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode StructuresInSoil<dim>::add_stiffness(double plastic, double elastic, SparseMatrix &matrix,
                                                    const std::vector<double> *motion,
                                                    std::vector<double> *lift) const {
  PetscFunctionBeginUser;
  if (!any()) PetscFunctionReturn(0);
  std::vector<std::vector<double>> moved;  // stretch by motion that supports prescribe
  if (lift) {
    std::vector<double> u(soil_.displacement().size(), 0);
    for (int i = 0; i < soil_.nodes().count(); ++i)
      if (const Support<dim> *s = supports_.at(i)) {
        ColumnVector<dim> own;
        for (int d = 0; d < dim; ++d) own[d] = s->held[d] ? (*motion)[i * dim + d] : 0;
        if (s->turned) own = (s->frame.transpose() * own).eval();
        for (int d = 0; d < dim; ++d) u[i * dim + d] = own[d];
      }
    moved = stretches(u);
  }
  std::vector<double> rows;
  for (std::size_t b = 0; b < nodes_.size(); ++b) {
    const Bar<dim> &bar = structures_->bars()[b];
    if (!bar.present || nodes_[b].row.empty()) continue;
    bar.chain.tangent(plastic, elastic, rows);
    const int n = bar.elements();
    const Eigen::Map<const typename SoilElements<dim>::Stiffness> tangent(rows.data(), n, n);
    const typename SoilElements<dim>::Stiffness block =
        nodes_[b].stretch_of.transpose() * (tangent * nodes_[b].stretch_of);
    PetscCall(matrix.add_here(static_cast<PetscInt>(nodes_[b].row.size()), nodes_[b].row.data(), block.data()));
    if (!lift) continue;
    const Eigen::VectorXd axial = tangent * Eigen::Map<const Eigen::VectorXd>(moved[b].data(), n);
    for (const Place &place : places_) {
      if (place.bar != static_cast<int>(b)) continue;
      ColumnVector<dim> sum = ColumnVector<dim>::Zero();
      if (place.point > 0) sum += axial[place.point - 1] * map<dim>(bar.direction[place.point - 1]);
      if (place.point < n) sum -= axial[place.point] * map<dim>(bar.direction[place.point]);
      for (std::size_t a = 0; a < place.shape.size(); ++a) {
        const int node = soil_.nodes().of_cell(place.cell)[a];
        const Support<dim> *s = supports_.at(node);
        ColumnVector<dim> own = place.shape[a] * sum;
        if (s && s->turned) own = (s->frame * own).eval();
        for (int d = 0; d < dim; ++d)
          if (!s || !s->held[d]) (*lift)[node * dim + d] += own[d];
      }
    }
  }
  PetscFunctionReturn(0);
}

// ---- bonds ----

template <int dim>
void StructuresInSoil<dim>::take_bonds(bool trial, double *changed, double *all) {
  constexpr int components = stress_size<dim>;
  const std::vector<Bar<dim>> &bars = structures_->bars();
  std::vector<std::size_t> first{0};
  for (const Bar<dim> &bar : bars) first.push_back(first.back() + bar.points());
  std::vector<double> found(first.back(), 0);  // normal stresses
  for (const Place &place : places_) {
    const GaussPoints<dim> &p = soil_.points()[soil_.body_of(place.cell)];
    const int points = soil_.points_per_cell(), begin = soil_.first_point(place.cell);
    Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
    for (int q = begin; q < begin + points; ++q) {
      const double *s = &(trial ? p.trial_stress : p.stress)[static_cast<std::size_t>(q) * components];
      for (int k = 0; k < 3; ++k) stress(k, k) += s[k] / points;
      stress(0, 1) += s[3] / points;
      if (dim == 3) stress(1, 2) += s[components - 2] / points, stress(0, 2) += s[components - 1] / points;
    }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < i; ++j) stress(i, j) = stress(j, i);
    const Bar<dim> &bar = bars[place.bar];
    found[first[place.bar] + place.point] =
        bar.normal_stress(bar.along_at(place.point, bar.place), stress, structures_->up());
  }
  MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(found.size()), MPI_DOUBLE, MPI_SUM, soil_.nodes().comm());
  each_present([&](Bar<dim> &bar, std::size_t b) {
    for (int i = 0; i < bar.points(); ++i) {
      const double before = bar.chain.point[i].limit;
      bar.set_bond(i, found[first[b] + i], false);
      *changed += std::abs(bar.chain.point[i].limit - before), *all += bar.chain.point[i].limit;
    }
  });
}

template <int dim>
void StructuresInSoil<dim>::set_bonds() {
  if (!any()) return;
  double changed = 0, all = 0;
  take_bonds(false, &changed, &all);
}

template <int dim>
void StructuresInSoil<dim>::follow_soil(double *change) {
  *change = 0;
  if (!any()) return;
  double changed = 0, all = 0;
  take_bonds(true, &changed, &all);
  if (all > 0) *change = changed / all;
  each_present([&](Bar<dim> &bar, std::size_t) {
    if (bar.keys.rupture_strain == 0) return;
    const int e = bar.chain.to_tear(bar.keys.rupture_strain);
    if (e < 0) return;
    bar.chain.element[e].torn = 1, *change = 1;
  });
}

template <int dim>
std::string StructuresInSoil<dim>::too_weak_for_prestress() const {
  std::string sentence;
  each_present([&](const Bar<dim> &bar, std::size_t) {
    if (!bar.chain.element[0].held || !sentence.empty()) return;
    double bond = 0;
    for (int i = 1; i < bar.points(); ++i) bond += bar.chain.point[i].limit / bar.share;
    if (bond < bar.keys.prestress)
      sentence = "the bond of structure." + bar.name + " bears " + rounded(bond / 1e3) +
                 " kN in the present stress of the soil, less than its prestress of " +
                 rounded(bar.keys.prestress / 1e3) + " kN: make it longer or stronger, or pull less";
  });
  return sentence;
}

// ---- states ----

template <int dim>
typename StructuresInSoil<dim>::State StructuresInSoil<dim>::save() const {
  State state;
  for (std::size_t b = 0; any() && b < structures_->bars().size(); ++b) state.push_back(structures_->bars()[b].chain);
  return state;
}

template <int dim>
void StructuresInSoil<dim>::restore(const State &state) {
  for (std::size_t b = 0; b < state.size(); ++b) {
    const double divisor = structures_->bars()[b].chain.divisor;
    structures_->bars()[b].chain = state[b], structures_->bars()[b].chain.divisor = divisor;
  }
}

template <int dim>
void StructuresInSoil<dim>::set_trial(double factor) {
  for (std::size_t b = 0; any() && b < structures_->bars().size(); ++b)
    if (Bar<dim> &bar = structures_->bars()[b]; bar.keys.reduce_strength) bar.chain.divisor = factor;
}

template class StructuresInSoil<2>;
template class StructuresInSoil<3>;

}  // namespace talus
