#include "physics/boundary/soil_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/local_numbers.h"
#include "base/room.h"
#include "scene/contact_source.h"

namespace talus {
namespace {

constexpr int smoothing_passes = 4;
constexpr double stiff = 1e-6;     // mobility of nodes that cannot give way, over that of their masses
constexpr double open_area = 0.1;  // added to the area over which a gap is spread, in units of the cell's face
constexpr double touching =
    0.5;                      // gap below which groups touch at the start, in units of the cell size: ends read open
constexpr double shut = 0.1;  // gap below which adhesion acts between steps that press, in units of the cell's face
/// Weight of a node beside its neighbours, each of which counts once for each cell that has both.
template <int dim>
constexpr double own_weight = dim == 2 ? 2 : 5;

template <int dim>
double face(double edge) {
  return dim == 2 ? edge : edge * edge;
}

}  // namespace

template <int dim>
SoilContact<dim>::SoilContact(const BackgroundMesh<dim> &mesh, const std::vector<ContactSource> &sources,
                              const std::vector<std::array<int, 2>> &pairs)
    : mesh_(mesh),
      sources_(sources),
      pairs_(pairs),
      source_of_(mesh.sheet_count() * mesh.sheet_count(), -1),
      first_cell_(mesh.nodes_in_sheet() + 1, 0),
      cell_(static_cast<std::size_t>(mesh.cells_in_sheet()) * (dim + 1)),
      contact_at_(mesh.nodes_in_sheet(), 0),
      sums_(sources.size()) {
  for (int k = 0; k < static_cast<int>(pairs.size()); ++k)
    for (const auto &[a, b] : {pairs[k], {pairs[k][1], pairs[k][0]}}) source_of_[a * mesh.sheet_count() + b] = k;
  for (int c = 0; c < mesh.cells_in_sheet(); ++c)
    for (const int i : mesh.cells[c].node) ++first_cell_[i + 1];
  for (int i = 0; i < mesh.nodes_in_sheet(); ++i) first_cell_[i + 1] += first_cell_[i];
  std::vector<int> next(first_cell_.begin(), first_cell_.end() - 1);
  for (int c = 0; c < mesh.cells_in_sheet(); ++c)
    for (const int i : mesh.cells[c].node) cell_[next[i]++] = c;
  contacts_.reserve(mesh.nodes_in_sheet()), before_.reserve(mesh.nodes_in_sheet());
  area_.reserve(mesh.nodes_in_sheet());
  nodal_.reserve(static_cast<std::size_t>(mesh.node_count()) * dim);
}

// ---- search ----

template <int dim>
PetscErrorCode SoilContact<dim>::search(FilledGrid<dim> &grid, double smallest_mass, double *volume, int stride) {
  PetscFunctionBeginUser;
  find_meetings(grid, smallest_mass, volume, stride);
  PetscCall(find_areas(grid));
  PetscCall(smooth_normals(grid));
  PetscCall(find_gaps(grid, volume, stride));
  searched_ = true;
  PetscFunctionReturn(0);
}

/// Nodes at which two sheets have soil, with what contacts there remember.
template <int dim>
void SoilContact<dim>::find_meetings(const FilledGrid<dim> &grid, double smallest_mass, double *volume, int stride) {
  const int sheets = mesh_.sheet_count(), nodes = mesh_.nodes_in_sheet();
  std::swap(contacts_, before_), contacts_.clear(), crowded_.clear();
  for (int i = 0; i < grid.node_count(); ++i) {
    const int base = grid.mesh_node[i] % nodes, sheet = grid.mesh_node[i] / nodes;
    int below = 0, met = 0, other = -1;
    double all = 0;
    for (int s = 0; s < sheets; ++s) {
      const int j = grid.find_node(base + s * nodes);
      if (j < 0) continue;
      below += s < sheet, all += volume[static_cast<std::size_t>(j) * stride];
      if (s == sheet || std::min(grid.mass[i], grid.mass[j]) <= smallest_mass) continue;
      ++met;
      if (s > sheet) other = j;
    }
    for (int s = sheet; below == 0 && s < sheets; ++s)  // once, for all sheets
      if (const int j = grid.find_node(base + s * nodes); j >= 0) volume[static_cast<std::size_t>(j) * stride] = all;
    if (met > 1) crowded_.push_back(grid.mesh_node[i]);
    if (met != 1 || other < 0) continue;
    Contact c{};
    c.memory = {0, searched_ ? FrictionMemory::never : 0, FrictionMemory::never};
    c.source = source_of_[sheet * sheets + grid.mesh_node[other] / nodes];
    if (const int old = contact_at_[base]; old > 0 && before_[old - 1].source == c.source) c = before_[old - 1];
    c.base = base, c.node = {i, other}, c.inverse = {1 / grid.mass[i], 1 / grid.mass[other]};
    contacts_.push_back(c);
  }
  for (const Contact &c : before_) contact_at_[c.base] = 0;
  number_contacts();
}

template <int dim>
void SoilContact<dim>::number_contacts() {
  for (std::size_t k = 0; k < contacts_.size(); ++k) contact_at_[contacts_[k].base] = static_cast<int>(k) + 1;
}

/// Calls use(other contact) for the contacts of the same groups at the other nodes of the cells around a contact, once
/// for each cell.
template <int dim>
template <class Use>
void SoilContact<dim>::each_around(const Contact &c, Use &&use) const {
  for (int k = first_cell_[c.base]; k < first_cell_[c.base + 1]; ++k)
    for (const int i : mesh_.cells[cell_[k]].node)
      if (const int other = contact_at_[i]; i != c.base && other > 0 && contacts_[other - 1].source == c.source)
        use(other - 1);
}

/// Half the difference of the outward area vectors of both groups, theory (6.15): the integrals of the gradient of the
/// shape function over each group.
template <int dim>
PetscErrorCode SoilContact<dim>::find_areas(FilledGrid<dim> &grid) {
  PetscFunctionBeginUser;
  const int nodes = mesh_.nodes_in_sheet();
  zeros_with_room(nodal_, static_cast<std::size_t>(grid.node_count()) * dim);
  for (int c = 0; c < grid.cell_count(); ++c) {
    const Shape<dim> &shape = grid.shape[c];
    if (std::none_of(shape.node.begin(), shape.node.end(),
                     [&](int i) { return contact_at_[grid.mesh_node[i] % nodes] > 0; }))
      continue;
    double volume = 0;
    for (const double part : grid.nodal_share[c]) volume += part;
    for (int k = 0; k < dim; ++k)
      for (int d = 0; d < dim; ++d) {
        const double part = volume * shape.gradient[k][d];
        nodal_[static_cast<std::size_t>(shape.node[k + 1]) * dim + d] += part;
        nodal_[static_cast<std::size_t>(shape.node[0]) * dim + d] -= part;
      }
  }
  PetscCall(grid.sum(nodal_.data(), dim));
  area_.resize(contacts_.size());
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    for (int d = 0; d < dim; ++d)
      area_[k][d] = (nodal_[static_cast<std::size_t>(contacts_[k].node[0]) * dim + d] -
                     nodal_[static_cast<std::size_t>(contacts_[k].node[1]) * dim + d]) /
                    2;
  PetscFunctionReturn(0);
}

/// Normals are those of sums of areas over neighbours: a node deep in one group has an area that is an error of
/// quadrature, and weighs little.
template <int dim>
PetscErrorCode SoilContact<dim>::smooth_normals(FilledGrid<dim> &grid) {
  PetscFunctionBeginUser;
  for (std::size_t k = 0; k < contacts_.size(); ++k) contacts_[k].normal = area_[k];
  for (int pass = 0; pass < smoothing_passes; ++pass) {
    zeros_with_room(nodal_, static_cast<std::size_t>(grid.node_count()) * dim);
    for (const Contact &c : contacts_)
      each_around(c, [&](int other) {
        for (int d = 0; d < dim; ++d)
          nodal_[static_cast<std::size_t>(c.node[0]) * dim + d] += contacts_[other].normal[d];
      });
    PetscCall(grid.sum(nodal_.data(), dim));
    for (Contact &c : contacts_)
      for (int d = 0; d < dim; ++d)
        c.normal[d] = (own_weight<dim> * c.normal[d] + nodal_[static_cast<std::size_t>(c.node[0]) * dim + d]) /
                      (own_weight<dim> + 1);  // keeps the size of numbers
  }
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact &c = contacts_[k];
    const double size = map<dim>(c.normal).norm();
    for (double &x : c.normal) x = size > 0 ? x / size : 0;
    c.area = std::max(0., dot<dim>(area_[k], c.normal));
  }
  PetscFunctionReturn(0);
}

/// The volume that no group fills over the area of the surface, both summed over a node and its neighbours, theory
/// (6.16).
template <int dim>
PetscErrorCode SoilContact<dim>::find_gaps(FilledGrid<dim> &grid, const double *volume, int stride) {
  PetscFunctionBeginUser;
  const auto empty = [&](const Contact &c) {
    return mesh_.nodal_volume[c.base] - volume[static_cast<std::size_t>(c.node[0]) * stride];
  };
  zeros_with_room(nodal_, static_cast<std::size_t>(grid.node_count()) * 2);
  for (const Contact &c : contacts_) {
    double *sums = &nodal_[static_cast<std::size_t>(c.node[0]) * 2];
    each_around(c, [&](int other) {
      sums[0] += empty(contacts_[other]), sums[1] += std::max(0., dot<dim>(area_[other], c.normal));
    });
  }
  PetscCall(grid.sum(nodal_.data(), 2));
  for (Contact &c : contacts_) {
    const double *sums = &nodal_[static_cast<std::size_t>(c.node[0]) * 2], own = own_weight<dim>;
    const double edge = mesh_.mean_edge[c.base];
    c.gap = (sums[0] + own * empty(c)) / (sums[1] + own * (c.area + open_area * face<dim>(edge)));
    if (!searched_) c.hangs = sources_[c.source].tensile_strength > 0 && c.gap < touching * edge;
  }
  PetscFunctionReturn(0);
}

template <int dim>
bool SoilContact<dim>::find_crowded(Vec<dim> *where) const {
  if (!crowded_.empty()) *where = mesh_.position[crowded_.front()];
  return !crowded_.empty();
}

template <int dim>
void SoilContact<dim>::meet(const FilledGrid<dim> &grid, Vec<dim> *v) const {
  join_bonded(v);
  for (const int node : crowded_) v[grid.find_node(node)].fill(std::numeric_limits<double>::quiet_NaN());
}

// ---- a step ----

/// Supports, and bases on which a node presses, bear what would move it in these directions. Returns the velocity that
/// they leave it.
template <int dim>
Vec<dim> SoilContact<dim>::hold(Contact &c, int side, const Step &step, const Vec<dim> &v) const {
  const int node = c.node[side];
  PrescribedDirections<dim> &held = c.held[side];
  Vec<dim> left = v;
  held.count = 0;
  if (const auto *support = step.prescribed.find(node)) {
    held = *support->condition;
    step.prescribed.impose(*support, step.t, step.grid.position[node], left);
  }
  step.bases.each_at(node, [&](const auto &base) {
    if (!base.presses) return;
    held.add(base.contact->normal, base.contact->source);
    add_scaled<dim>(left, -std::max(0., dot<dim>(left, base.contact->normal)), base.contact->normal);
  });
  return left;
}

/// Velocity that an impulse gives the node of one group [1/kg].
template <int dim>
Square<dim> SoilContact<dim>::mobility_of(const Contact &c, int side) const {
  Square<dim> mobility = c.inverse[side] * Square<dim>::Identity();
  const PrescribedDirections<dim> &held = c.held[side];
  for (int k = 0; k < held.count; ++k)
    mobility -= c.inverse[side] * map<dim>(held.direction[k]) * map<dim>(held.direction[k]).transpose();
  return mobility;
}

template <int dim>
auto SoilContact<dim>::yield_of(const Contact &c) const -> Yield {
  Yield y{mobility_of(c, 0) + mobility_of(c, 1), 0, 0, stiff * (c.inverse[0] + c.inverse[1])};
  y.across = map<dim>(c.normal).dot(y.mobility * map<dim>(c.normal));
  y.along = (y.mobility.trace() - y.across) / (dim - 1);
  return y;
}

/// Impulses between both nodes of a contact, theory (6.17). Supports and bases, which act afterwards, take what
/// goes in directions that they hold.
template <int dim>
void SoilContact<dim>::resolve(Contact &c, const Step &step, Vec<dim> *v) {
  const ContactSource &source = sources_[c.source];
  const Vec<dim> first = hold(c, 0, step, v[c.node[0]]), second = hold(c, 1, step, v[c.node[1]]);
  const Yield y = yield_of(c);
  const Vec<dim> &x = step.grid.position[c.node[0]], &other = step.grid.position[c.node[1]];
  const ColumnVector<dim> n = map<dim>(c.normal);
  ColumnVector<dim> against = map<dim>(first) - map<dim>(second);
  const double gap = c.gap + (map<dim>(other) - map<dim>(x)).dot(n), approach = against.dot(n);
  const bool gives = y.across > y.light, touched = c.presses || c.hangs;
  c.closing = source.bonded ? 0 : std::max(gap, 0.) / step.gamma;
  const double wanted = gives ? (approach - c.closing) / y.across : 0;
  double pressed = source.bonded ? wanted : std::max(0., wanted);
  c.presses = pressed > 0 || (source.bonded && gives), c.hangs = false, c.joined = c.presses;
  if (!c.presses && gives && touched && source.tensile_strength > 0) {
    const double pull = -approach / y.across;
    c.hangs = pull <= source.tensile_strength * c.area * step.gamma;
    c.joined = c.hangs && pull > 0;
    if (c.joined) pressed = -pull, c.closing = 0;
  }
  against -= pressed * y.mobility * n;
  const ColumnVector<dim> slip = against - against.dot(n) * n;
  const double speed = slip.norm(), delay = step.bases.friction_delay(), z = dim == 3 ? x[dim - 1] : 0;
  double most = std::numeric_limits<double>::infinity();
  if (!source.bonded) {
    const double share = c.memory.share(step.gamma, delay),
                 slope = std::tan(source.friction_angle(x[0], x[1], z, step.t)),
                 capacity = c.memory.capacity + slope * std::max(0., pressed);
    most = share * capacity;
    const bool touches = c.presses || c.hangs || gap <= shut * std::pow(c.area, 1. / (dim - 1));
    if (c.memory.adheres(touches, step.gamma, delay))
      most += source.adhesion(x[0], x[1], z, step.t) * c.area * step.gamma;
    const bool gathers = c.memory.gathers(delay);
    c.memory.pass(step.gamma, c.presses || c.hangs, gathers ? capacity : (1 - share) * capacity);
  }
  const bool slides = y.along > y.light;
  c.sticks = slides && speed <= y.along * most;
  const double rubs = !slides || speed == 0 ? 0 : c.sticks ? 1 / y.along : most / speed;
  c.force = source.bonded ? 0 : most / step.gamma;
  map<dim>(c.impulse) = pressed * n + rubs * slip;
  add_scaled<dim>(v[c.node[0]], -c.inverse[0], c.impulse), add_scaled<dim>(v[c.node[1]], c.inverse[1], c.impulse);
  if (!mesh_.counted[c.base]) return;
  Sums &sums = sums_[c.source];
  add_scaled<dim>(sums.impulse, 1, c.impulse);
  sums.normal += std::max(0., pressed), sums.friction += rubs * speed;
  sums.slipped += std::max(0., pressed) * std::max(0., 1 - rubs * y.along) * speed;
}

template <int dim>
void SoilContact<dim>::resolve(const Step &step, Vec<dim> *v) {
  resolved_step_ = step.gamma;
  for (Contact &c : contacts_) resolve(c, step, v);
}

/// Impulses do their work on the velocity by which places move: where it parts groups that press, energy would be
/// created.
template <int dim>
void SoilContact<dim>::follow(Vec<dim> *w) const {
  for (const Contact &c : contacts_) {
    Vec<dim> &first = w[c.node[0]], &second = w[c.node[1]];
    const ColumnVector<dim> n = map<dim>(c.normal);
    const Yield y = yield_of(c);
    ColumnVector<dim> against = map<dim>(first) - map<dim>(second), impulse = ColumnVector<dim>::Zero();
    const double approach = against.dot(n), target = std::clamp(approach, 0., c.closing);
    if ((approach > c.closing || c.joined) && y.across > y.light) impulse = (approach - target) / y.across * n;
    if (c.sticks) {
      against -= y.mobility * impulse;
      impulse += (against - against.dot(n) * n) / y.along;
    }
    map<dim>(first) -= mobility_of(c, 0) * impulse, map<dim>(second) += mobility_of(c, 1) * impulse;
  }
}

template <int dim>
void SoilContact<dim>::join_bonded(Vec<dim> *v) const {
  for (const Contact &c : contacts_) {
    if (!sources_[c.source].bonded) continue;
    Vec<dim> &first = v[c.node[0]], &second = v[c.node[1]];
    const double both = c.inverse[0] + c.inverse[1];
    Vec<dim> impulse{};
    add_scaled<dim>(impulse, 1 / both, first), add_scaled<dim>(impulse, -1 / both, second);
    add_scaled<dim>(first, -c.inverse[0], impulse), add_scaled<dim>(second, c.inverse[1], impulse);
  }
}

template <int dim>
void SoilContact<dim>::project(const Vec<dim> *v, Vec<dim> *force) const {
  for (const Contact &c : contacts_) {
    Vec<dim> &first = force[c.node[0]], &second = force[c.node[1]];
    const ColumnVector<dim> n = map<dim>(c.normal);
    const Yield y = yield_of(c);
    const ColumnVector<dim> against = mobility_of(c, 0) * map<dim>(first) - mobility_of(c, 1) * map<dim>(second);
    ColumnVector<dim> passed = ColumnVector<dim>::Zero(), slip = map<dim>(v[c.node[0]]) - map<dim>(v[c.node[1]]);
    const double into = against.dot(n);
    if (c.joined && y.across > y.light && (into > 0 || !c.presses || sources_[c.source].bonded))
      passed = into / y.across * n;
    slip -= slip.dot(n) * n;
    const double speed = slip.norm();
    if (c.sticks)
      passed += (against - into * n) / y.along;
    else if (speed > 0)
      passed += c.force / speed * slip;
    map<dim>(first) -= passed, map<dim>(second) += passed;
  }
}

template <int dim>
void SoilContact<dim>::add_work(const Vec<dim> *u, double *work) const {
  for (const Contact &c : contacts_)
    if (mesh_.counted[c.base])
      work[c.source] += (dot<dim>(c.impulse, u[c.node[1]]) - dot<dim>(c.impulse, u[c.node[0]])) / resolved_step_;
}

// ---- results ----

template <int dim>
PetscErrorCode SoilContact<dim>::take_reports(std::vector<Report> &reports) {
  constexpr int width = dim + 3;
  PetscFunctionBeginUser;
  static_assert(sizeof(Sums) == width * sizeof(double));
  std::vector<Sums> all(sums_.size());
  PetscCallMPI(MPI_Allreduce(sums_.data(), all.data(), static_cast<int>(sums_.size()) * width, MPI_DOUBLE, MPI_SUM,
                             mesh_.comm()));
  reports.clear();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double pressed = all[k].normal > 0 ? 1 / all[k].normal : 0;
    reports.push_back({{}, pressed * all[k].friction, pressed * all[k].slipped});
    add_scaled<dim>(reports.back().impulse, pairs_[k][0] < pairs_[k][1] ? 1 : -1, all[k].impulse);
  }
  std::fill(sums_.begin(), sums_.end(), Sums{});
  PetscFunctionReturn(0);
}

template <int dim>
void SoilContact<dim>::serialize(Archive &archive, const FilledGrid<dim> &grid) {
  archive.serialize("search of contacts", searched_, resolved_step_);
  archive.sums("impulses of contacts", sums_);
  std::vector<long long> nodes;
  for (const Contact &c : contacts_) nodes.push_back(mesh_.global_node[c.base]);
  archive.column(archive.rows("nodes of contacts", Belongs::to_points, nodes), "contacts", contacts_);
  if (!archive.reading()) return;
  contacts_.resize(nodes.size());
  const LocalNumbers node_of(mesh_.global_node);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Contact &c = contacts_[k];
    const auto &[a, b] = std::minmax(pairs_[c.source][0], pairs_[c.source][1]);
    c.base = node_of(nodes[k]);
    c.node = {grid.find_node(c.base + a * mesh_.nodes_in_sheet()), grid.find_node(c.base + b * mesh_.nodes_in_sheet())};
  }
  std::fill(contact_at_.begin(), contact_at_.end(), 0);
  std::sort(contacts_.begin(), contacts_.end(),
            [](const Contact &a, const Contact &b) { return a.node[0] < b.node[0]; });
  number_contacts();
}

template class SoilContact<2>;
template class SoilContact<3>;

}  // namespace talus
