#include "physics/boundary/conditions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/gather.h"
#include "base/local_numbers.h"
#include "physics/boundary/node_normals.h"

namespace talus {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// `count` zeros, with room to grow: soil that spreads does not ask for memory at each remap.
void clear(std::vector<double> &values, size_t count) {
  if (values.capacity() < count) values.reserve(2 * count);
  values.assign(count, 0);
}

template <int dim>
double dot(const Vec<dim> &a, const Vec<dim> &b) {
  double s = 0;
  for (int d = 0; d < dim; ++d) s += a[d] * b[d];
  return s;
}
template <int dim>
void add(Vec<dim> &a, double scale, const Vec<dim> &b) {
  for (int d = 0; d < dim; ++d) a[d] += scale * b[d];
}

}  // namespace

template <int dim>
void Conditions<dim>::add_direction(PrescribedSet &set, int node, int source, const Vec<dim> &direction) {
  int &index = set.of_node[node];
  if (index < 0) index = static_cast<int>(set.entry.size()), set.entry.push_back({});
  set.entry[index].add(direction, source);
}

template <int dim>
void Conditions<dim>::add_contact(int node, int source, const Vec<dim> &normal, double area) {
  int &index = first_contact_of_node_[node];
  if (index < 0) index = static_cast<int>(contacts_.size()), contacts_.emplace_back();
  contacts_[index].push_back({node, source, normal, area, 0, 0, never, false, 0, -1, false});
}

template <int dim>
PetscErrorCode Conditions<dim>::setup(const BackgroundMesh<dim> &mesh, std::vector<Source> sources) {
  PetscFunctionBeginUser;
  sources_ = std::move(sources);
  impulse_.assign(sources_.size(), Vec<dim>{});
  work_.assign(sources_.size(), 0);
  for (PrescribedSet &set : prescribed_) set.of_node.assign(mesh.node_count(), -1);
  first_contact_of_node_.assign(mesh.node_count(), -1);
  std::vector<SourceFacets<dim>> faces;
  for (int s = 0; s < static_cast<int>(sources_.size()); ++s) {
    const Boundary &kind = sources_[s].kind;
    if (kind.fluids_only()) continue;
    std::vector<Facet<dim>> facets;
    for (const std::string &group : sources_[s].groups) {
      const auto more = mesh.facets(group);
      facets.insert(facets.end(), more.begin(), more.end());
    }
    if (kind.in_motion == OnSoil::load) {
      surface_loads_.add_face(s, kind, std::move(facets));
    } else {
      if (kind.in_motion == OnSoil::dashpot) dashpots_.emplace_back(s, facets);
      if (kind.in_motion == OnSoil::contact) bases_.emplace_back(s, facets);
      faces.push_back({s, std::move(facets)});
    }
  }
  std::vector<NodeNormal<dim>> normals;
  PetscCall(find_node_normals(mesh, faces, normals));
  // the order must not depend on the partition, so that all ranks build the same constraints
  std::stable_sort(normals.begin(), normals.end(), [&](const NodeNormal<dim> &a, const NodeNormal<dim> &b) {
    const auto key = [&](const NodeNormal<dim> &n) {
      return std::make_tuple(sources_[n.source].kind.precedence, n.source, n.normal, n.area);
    };
    return key(a) < key(b);
  });
  for (const NodeNormal<dim> &n : normals) {
    const Boundary &kind = sources_[n.source].kind;
    if (kind.in_motion == OnSoil::contact) add_contact(n.node, n.source, n.normal, n.area);
    if (const auto &directions = kind.template on_soil<dim>().directions)
      for (const Vec<dim> &direction : directions(n.normal))
        for (int set = kind.stands_in(); set < 2; ++set) add_direction(prescribed_[set], n.node, n.source, direction);
  }
  zone_grids_.resize(sources_.size()), rubbed_.assign(sources_.size(), {0, 0});
  for (size_t s = 0; s < sources_.size(); ++s)
    if (sources_[s].kind.shear_zone) zone_grids_[s] = std::make_unique<ShearZoneGrid>(*sources_[s].kind.shear_zone);
  int zone_values = 0;
  for (auto &of_node : contacts_)
    for (Contact &c : of_node)
      if (zone_grids_[c.source]) c.zone = zone_values, zone_values += grid_of(c).size(), zoned_.push_back(&c);
  zone_state_.assign(zone_values, 0);
  size_t contacts = 0;
  for (const auto &of_node : contacts_) contacts += of_node.size();
  size_t reactions = dim * prescribed_[1].entry.size() + contacts;
  active_prescribed_.reserve(prescribed_[1].entry.size()), active_contacts_.reserve(contacts);
  for (const auto &[source, facets] : dashpots_) reactions += dim * facets.size();
  impulses_.reserve(reactions);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Conditions<dim>::depth_on_bases(const BackgroundMesh<dim> &mesh, const std::vector<char> &filled,
                                               double *depth) const {
  double sums[2] = {}, ends[2 * dim];  // volume and area; how far the soil reaches towards +d and -d
  PetscFunctionBeginUser;
  *depth = 0;
  if (std::none_of(sources_.begin(), sources_.end(),
                   [](const Source &s) { return s.kind.in_motion == OnSoil::contact; }))
    PetscFunctionReturn(0);
  std::fill_n(ends, 2 * dim, -std::numeric_limits<double>::infinity());
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (!filled[c]) continue;
    sums[0] += mesh.volume[c];
    for (int node : mesh.cells[c].node)
      for (int d = 0; d < dim; ++d) {
        ends[d] = std::max(ends[d], mesh.position[node][d]);
        ends[dim + d] = std::max(ends[dim + d], -mesh.position[node][d]);
      }
  }
  for (const auto &[source, facets] : bases_)
    for (const Facet<dim> &f : facets)
      if (filled[f.cell]) sums[1] += f.area;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh.comm()));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends, 2 * dim, MPI_DOUBLE, MPI_MAX, mesh.comm()));
  for (int d = 0; d < dim; ++d) *depth = std::max(*depth, ends[d] + ends[dim + d]);
  if (sums[1] > 0) *depth = std::min(*depth, sums[0] / sums[1]);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Conditions<dim>::begin(FilledGrid<dim> &grid, const std::vector<std::array<double, 2>> &impedance,
                                      const std::vector<double> &filling) {
  PetscFunctionBeginUser;
  const BackgroundMesh<dim> &mesh = grid.mesh();
  const int nodes = grid.node_count();
  active_prescribed_.clear(), active_contacts_.clear(), active_dashpots_.clear(), active_frozen_.clear(),
      impulses_.clear();
  counted_.resize(nodes);
  for (int i = 0; i < nodes; ++i) {
    counted_[i] = mesh.owned[grid.mesh_node[i]];
    const PrescribedSet &set = prescribed_[stand_ins_];
    const int index = set.of_node[grid.mesh_node[i]];
    if (index >= 0) active_prescribed_.push_back({i, &set.entry[index], {}});
  }
  for (const Reaction &r : frozen_)
    if (!stand_ins_ && grid.find_node(r.node) >= 0)
      active_frozen_.push_back({grid.find_node(r.node), r.source, r.value});
  if (!bases_.empty()) {
    for (auto &of_node : contacts_)
      for (Contact &c : of_node)
        if (grid.find_node(c.node) < 0)
          c.capacity = 0, c.gathered = c.since_pressed = never;  // soil that arrives here later has not pressed yet
    clear(nodal_, nodes);
    for (const auto &[source, facets] : bases_)
      for (const Facet<dim> &f : facets) {
        const int cell = grid.find_cell(f.cell);
        if (cell < 0) continue;
        for (int node : f.node) nodal_[grid.find_node(node)] += f.area / dim * std::min(1., filling[cell]);
      }
    PetscCall(grid.sum(nodal_.data(), 1));
    for (int i = 0; i < nodes; ++i) {
      const int index = first_contact_of_node_[grid.mesh_node[i]];
      if (index < 0) continue;
      double total = 0;
      for (const Contact &c : contacts_[index]) total += c.area;
      for (Contact &c : contacts_[index])
        active_contacts_.push_back({i, &c, nodal_[i] * c.area / total, 0, c.rests, c.rests, {}, {}, 0, 0, 0});
    }
  }
  if (!dashpots_.empty() && !stand_ins_) {
    constexpr int width = dim * dim;
    for (const auto &[source, facets] : dashpots_) {
      const auto &dashpot = sources_[source].kind.template on_soil<dim>().dashpot;
      clear(nodal_, static_cast<size_t>(nodes) * width);
      for (const Facet<dim> &f : facets) {
        const int cell = grid.find_cell(f.cell);
        if (cell < 0) continue;
        const Square<dim> matrix = dashpot(impedance[cell], f.normal);
        for (int node : f.node)
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              nodal_[grid.find_node(node) * width + i * dim + j] += f.area / dim * matrix(i, j);
      }
      PetscCall(grid.sum(nodal_.data(), width));
      for (int i = 0; i < nodes; ++i) {
        const Square<dim> matrix = Eigen::Map<const Square<dim>>(&nodal_[i * width]);
        if (matrix.trace() > 0) active_dashpots_.push_back({i, source, matrix});
      }
    }
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Conditions<dim>::set_normal_forces(const BackgroundMesh<dim> &mesh, std::vector<NormalForce> forces,
                                                  double t) {
  PetscFunctionBeginUser;
  if (bases_.empty()) PetscFunctionReturn(0);
  PetscCall(gather_from(mesh.comm(), mesh.halo.neighbours(), forces));
  std::map<Vec<dim>, std::vector<Contact> *> at;
  for (auto &of_node : contacts_) {
    for (Contact &c : of_node) c.capacity = 0, c.gathered = c.since_pressed = never, c.rests = false;
    at[mesh.position[of_node.front().node]] = &of_node;
  }
  for (const NormalForce &f : forces) {
    const auto found = at.find(f.position);
    if (found == at.end()) continue;
    Contact *nearest = nullptr;  // finite elements know facets, and a contact is a patch of them
    for (Contact &c : *found->second)
      if (c.source == f.source && (!nearest || dot<dim>(c.normal, f.normal) > dot<dim>(nearest->normal, f.normal)))
        nearest = &c;
    if (!nearest) continue;
    const Vec<dim> &x = f.position;
    nearest->capacity +=
        f.force * friction_delay_ *
        sources_[f.source].kind.friction_coefficient(x[0], x[1], dim == 3 ? x[dim - 1] : 0, t, nearest->slip);
    nearest->since_pressed = 0, nearest->rests = true;
  }
  PetscFunctionReturn(0);
}

template <int dim>
void Conditions<dim>::freeze_reactions(const FilledGrid<dim> &grid, const Vec<dim> *force) {
  frozen_.clear();
  for (const ActivePrescribed &p : active_prescribed_)
    for (int k = 0; k < p.condition->count; ++k) {
      const int source = p.condition->source[k];
      if (!sources_[source].kind.stands_in()) continue;
      Reaction r{grid.mesh_node[p.node], source, {}};
      add<dim>(r.value, -dot<dim>(force[p.node], p.condition->direction[k]), p.condition->direction[k]);
      frozen_.push_back(r);
    }
}

template <int dim>
void Conditions<dim>::add_reactions(Vec<dim> *force) const {
  for (const Reaction &r : active_frozen_) add<dim>(force[r.node], 1, r.value);
}

template <int dim>
void Conditions<dim>::add_work(const Vec<dim> *u) {
  for (const Reaction &r : impulses_) work_[r.source] += dot<dim>(r.value, u[r.node]) / resolved_step_;
  for (const Reaction &r : active_frozen_)
    if (counted_[r.node]) work_[r.source] += dot<dim>(r.value, u[r.node]);
  surface_loads_.add_work(u, work_);
  for (ActiveContact &c : active_contacts_)
    if (remembers_ && sources_[c.contact->source].kind.remembers) add_slip(c, u[c.node]);
}

/// Slip is the way of a node along the base while it touches it; the work of friction on this way becomes heat.
template <int dim>
void Conditions<dim>::add_slip(ActiveContact &c, const Vec<dim> &u) {
  Contact &contact = *c.contact;
  if (contact.since_pressed > friction_delay_) return;
  Vec<dim> along = u;
  add<dim>(along, -dot<dim>(along, contact.normal), contact.normal);
  contact.slip += std::sqrt(dot<dim>(along, along));
  const double work = -dot<dim>(c.rubbed, u) / resolved_step_;
  if (contact.zone < 0 || c.area <= 0 || work == 0) return;
  grid_of(contact).add_heat(work / c.area, zone_of(contact));
  contact.warm = true;
}

/// Heat and excess pressure spread in all shear zones, those that soil has left among them.
template <int dim>
void Conditions<dim>::spread_heat(double gamma) {
  for (const auto &grid : zone_grids_)
    if (grid) grid->set_step(gamma);
  for (Contact *c : zoned_)
    if (c->warm) grid_of(*c).spread(zone_of(*c));
}

/// Friction impulse that excess pressure leaves of `rubbing` beside the impulse of adhesion, docs/theory (6.11):
/// implicit in the pressure that the heat of this step brings, at the speed of slip before friction.
template <int dim>
double Conditions<dim>::left_by_pressure(const ActiveContact &c, double rubbing, double adhering, double slope,
                                         double gamma, double speed) {
  const Contact &contact = *c.contact;
  if (contact.zone < 0 || c.area <= 0) return rubbing;
  const ShearZoneGrid &grid = grid_of(contact);
  const double taken = slope * gamma * c.area * (contact.warm ? grid.pressure(zone_of(contact)) : 0);
  const double heating = remembers_ ? slope * gamma * speed * grid.pressure_per_heat() : 0;
  return std::max(0., (rubbing - taken - heating * adhering) / (1 + heating));
}

template <int dim>
void Conditions<dim>::forget_slip() {
  for (auto &of_node : contacts_)
    for (Contact &c : of_node) c.slip = 0, c.warm = false;
  std::fill(zone_state_.begin(), zone_state_.end(), 0);
}

template <int dim>
PetscErrorCode Conditions<dim>::take_bases(MPI_Comm comm, std::vector<BaseReport> &reports) {
  PetscFunctionBeginUser;
  enum { area, slip, temperature, pressure, heat, friction, normal, sums };
  const int sources = static_cast<int>(sources_.size());
  reports.assign(sources, {});
  if (std::none_of(sources_.begin(), sources_.end(),
                   [](const Source &s) { return s.kind.in_motion == OnSoil::contact; }))
    PetscFunctionReturn(0);
  std::vector<double> sum(sums * sources, 0), hottest(sources, 0);
  for (int s = 0; s < sources; ++s) std::copy_n(rubbed_[s].begin(), 2, &sum[s * sums + friction]);
  std::fill(rubbed_.begin(), rubbed_.end(), std::array<double, 2>{});
  for (const ActiveContact &c : active_contacts_) {
    const Contact &contact = *c.contact;
    if (!counted_[c.node] || contact.since_pressed > friction_delay_) continue;
    double *of = &sum[contact.source * sums];
    of[area] += c.area, of[slip] += c.area * contact.slip;
    if (!contact.warm) continue;
    const double rise = grid_of(contact).temperature(zone_of(contact));
    of[temperature] += c.area * rise, of[pressure] += c.area * grid_of(contact).pressure(zone_of(contact));
    of[heat] += c.area * grid_of(contact).heat(zone_of(contact));
    hottest[contact.source] = std::max(hottest[contact.source], rise);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum.data(), sums * sources, MPI_DOUBLE, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, hottest.data(), sources, MPI_DOUBLE, MPI_MAX, comm));
  const auto ratio = [](double a, double b) { return b > 0 ? a / b : 0; };
  for (int s = 0; s < sources; ++s) {
    const double *of = &sum[s * sums];
    reports[s] = {.slip = ratio(of[slip], of[area]),
                  .friction = ratio(of[friction], of[normal]),
                  .temperature = ratio(of[temperature], of[area]),
                  .hottest = hottest[s],
                  .pressure = ratio(of[pressure], of[area]),
                  .heat = of[heat]};
  }
  PetscFunctionReturn(0);
}

template <int dim>
double Conditions<dim>::target(const Prescribed &c, int k, const Vec<dim> &x, double t) const {
  const auto &speed = sources_[c.source[k]].kind.template on_soil<dim>().speed;
  return speed ? speed(c.direction[k], x, t) : 0;
}

/// The directions in which the contacts of one node bar its motion, made orthogonal: what the second of two planes
/// takes must not give back what the first has taken.
template <int dim>
class Conditions<dim>::Barred {
 public:
  /// The next contact belongs to `node`.
  void at(int node) {
    if (node != node_) node_ = node, count_ = 0;
  }

  /// Takes from the vector `v` of the node its part along the normal `n` and the directions before it.
  void take(const Vec<dim> &n, Vec<dim> &v) {
    Vec<dim> direction = n;
    for (int k = 0; k < count_; ++k) add<dim>(direction, -dot<dim>(n, direction_[k]), direction_[k]);
    const double left = count_ > 0 ? std::sqrt(dot<dim>(direction, direction)) : 1;
    if (count_ == dim || left < parallel) return;
    for (double &component : direction) component /= left;
    add<dim>(v, -dot<dim>(v, direction), direction);
    direction_[count_++] = direction;
  }

 private:
  static constexpr double parallel = 1e-6;
  int node_ = -1, count_ = 0;
  std::array<Vec<dim>, dim> direction_;
};

template <int dim>
void Conditions<dim>::constrain(double t, const FilledGrid<dim> &grid, Vec<dim> *v, bool sticking) const {
  Barred barred;
  for (const ActiveContact &c : active_contacts_) {
    barred.at(c.node);
    const double into = dot<dim>(v[c.node], c.contact->normal);
    if (sticking && c.sticks) v[c.node] = {}, add<dim>(v[c.node], into, c.contact->normal);
    if (into > 0 || (sticking && c.presses)) barred.take(c.contact->normal, v[c.node]);
  }
  for (const ActivePrescribed &p : active_prescribed_)
    for (int k = 0; k < p.condition->count; ++k) impose(p, k, t, grid.position[p.node], v[p.node]);
}

template <int dim>
void Conditions<dim>::project(const FilledGrid<dim> &, const Vec<dim> *v, Vec<dim> *force) const {
  for (const Dashpot &d : active_dashpots_) map<dim>(force[d.node]) -= d.matrix * map<dim>(v[d.node]);
  Barred barred;
  for (const ActiveContact &c : active_contacts_) {
    barred.at(c.node);
    Vec<dim> &f = force[c.node], slip = v[c.node];
    const Vec<dim> &n = c.contact->normal;
    const double into = dot<dim>(f, n);
    add<dim>(slip, -dot<dim>(slip, n), n);
    const double speed = std::sqrt(dot<dim>(slip, slip));
    if (c.sticks)
      f = {}, add<dim>(f, into, n);
    else if (speed > 0)
      add<dim>(f, -c.force / speed, slip);
    if (into > 0) barred.take(n, f);
  }
  for (const ActivePrescribed &p : active_prescribed_)
    for (int k = 0; k < p.condition->count; ++k)
      add<dim>(force[p.node], -dot<dim>(force[p.node], p.condition->direction[k]), p.condition->direction[k]);
}

/// The contacts of a node follow one another; the place behind the last one of the node of contact `first`.
template <int dim>
size_t Conditions<dim>::last_at_node(size_t first) const {
  size_t last = first + 1;
  while (last < active_contacts_.size() && active_contacts_[last].node == active_contacts_[first].node) ++last;
  return last;
}

/// The velocity that contact `c` alone leaves of the velocity `before` of its node, theory (6.1).
template <int dim>
Vec<dim> Conditions<dim>::respond(ActiveContact &c, double t, double gamma, const Vec<dim> &x, const Square<dim> &mass,
                                  const Pores &pores, const Vec<dim> &before) {
  const Contact &contact = *c.contact;
  const Vec<dim> &n = contact.normal;
  const Boundary &base = sources_[contact.source].kind;
  const double into = dot<dim>(before, n);
  Vec<dim> slip = before;
  add<dim>(slip, -into, n);
  c.presses = into > 0;
  const double z = dim == 3 ? x[dim - 1] : 0, slipped = contact.slip,
               slope = base.friction_coefficient(x[0], x[1], z, t, slipped);
  c.pressed = c.presses ? map<dim>(n).dot(mass * map<dim>(n)) * into : 0;
  c.capacity = contact.capacity;
  if (c.presses) c.capacity += slope * c.pressed;
  if (pores.thrust) c.capacity -= slope * gamma * pores.thrust(c.node, n);
  const bool gathers = contact.gathered < friction_delay_;
  const double adapted = friction_delay_ > 0 ? 1 - std::exp(-gamma / friction_delay_) : 1;
  const double forgotten = (gathers ? gamma / (contact.gathered + gamma) : adapted) * c.capacity;
  const double speed = std::sqrt(dot<dim>(slip, slip));
  const double m = speed > 0 ? map<dim>(slip).dot(mass * map<dim>(slip)) / (speed * speed) : 0;
  const bool adheres = c.presses || contact.since_pressed + gamma <= friction_delay_;
  const double adhering = adheres ? base.adhesion(x[0], x[1], z, t, slipped) * c.area * gamma : 0;
  const double rubbing = left_by_pressure(c, std::max(0., forgotten), adhering, slope, gamma, speed);
  const double most = rubbing + adhering;
  if (!gathers) c.capacity -= forgotten;
  c.force = most / gamma, c.sticks = m * speed <= most;
  const double share = c.sticks ? 1 : most / (m * speed);
  c.rubs = share * m * speed;
  c.rubbed = {}, add<dim>(c.rubbed, -share * m, slip);
  Vec<dim> after{};
  if (!c.presses) add<dim>(after, into, n);
  if (!c.sticks) add<dim>(after, 1 - most / (m * speed), slip);
  return after;
}

/// The node of `p` gets the velocity of its direction `k`.
template <int dim>
void Conditions<dim>::impose(const ActivePrescribed &p, int k, double t, const Vec<dim> &x, Vec<dim> &v) const {
  const Vec<dim> &direction = p.condition->direction[k];
  add<dim>(v, target(*p.condition, k, x, t) - dot<dim>(v, direction), direction);
}

/// All contacts of a node, and its support if it has one, act on its velocity. At a true edge, and beside a roller, the
/// force of each depends on those of the others: each in turn meets the velocity that the others leave, until nothing
/// changes (Gauss-Seidel; Jean 1999), theory (6.1a).
template <int dim>
void Conditions<dim>::settle_node(double t, double gamma, const Vec<dim> &x, const Square<dim> &mass,
                                  const Pores &pores, size_t first, size_t last, ActivePrescribed *support,
                                  Vec<dim> &v) {
  constexpr int most_sweeps = 200;
  constexpr double negligible = 1e-14, stuck = 1e-7;  // of the velocity that the contacts meet
  const bool alone = last == first + 1 && !support;
  double met = 0;
  for (size_t k = first; k < last; ++k) active_contacts_[k].change = {};
  if (support) support->change = {};
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double moved = 0;
    const auto act = [&](Vec<dim> &change, const auto &response) {
      Vec<dim> others = v;
      add<dim>(others, -1, change);
      const Vec<dim> after = response(others);
      for (int d = 0; d < dim; ++d)
        change[d] = after[d] - others[d], moved = std::max(moved, std::abs(after[d] - v[d]));
      v = after;
    };
    if (support)
      act(support->change, [&](Vec<dim> others) {
        for (int k = 0; k < support->condition->count; ++k) impose(*support, k, t, x, others);
        return others;
      });
    met = std::max(met, std::sqrt(dot<dim>(v, v)));
    for (size_t k = first; k < last; ++k) {
      ActiveContact &c = active_contacts_[k];
      act(c.change, [&](const Vec<dim> &others) { return respond(c, t, gamma, x, mass, pores, others); });
    }
    if (alone) return;
    if (moved <= negligible * met) break;
  }
  // friction that holds the node together with others may be at its own limit to round-off
  for (size_t k = first; k < last; ++k) {
    ActiveContact &c = active_contacts_[k];
    Vec<dim> slip = v;
    add<dim>(slip, -dot<dim>(v, c.contact->normal), c.contact->normal);
    c.sticks = c.force > 0 && std::sqrt(dot<dim>(slip, slip)) <= stuck * met;
  }
}

/// What a contact remembers of a step.
template <int dim>
void Conditions<dim>::commit(ActiveContact &c, double gamma) {
  Contact &contact = *c.contact;
  contact.rests = false;
  contact.since_pressed = c.presses ? 0 : contact.since_pressed + gamma;
  contact.gathered += gamma;
  contact.capacity = c.capacity;
}

template <int dim>
void Conditions<dim>::resolve(double t, double gamma, const FilledGrid<dim> &grid, Vec<dim> *v, const Pores &pores) {
  const auto mass_of = [&](int node) -> Square<dim> {
    return pores.inertia ? pores.inertia(node) : Square<dim>(grid.mass[node] * Square<dim>::Identity());
  };
  const auto account = [&](int node, int source, const Vec<dim> &before) {
    if (!counted_[node]) return;
    Reaction r{node, source, {}};
    map<dim>(r.value) = mass_of(node) * (map<dim>(v[node]) - map<dim>(before));
    for (int d = 0; d < dim; ++d) impulse_[source][d] += r.value[d];
    impulses_.push_back(r);
  };
  impulses_.clear(), resolved_step_ = gamma;
  for (const Dashpot &d : active_dashpots_) {
    const Vec<dim> before = v[d.node];
    const Square<dim> mass = mass_of(d.node), system = mass + gamma * d.matrix;
    map<dim>(v[d.node]) = system.inverse() * (mass * map<dim>(before));
    account(d.node, d.source, before);
  }
  spread_heat(gamma);
  auto supported = active_prescribed_.begin();
  for (size_t first = 0, last; first < active_contacts_.size(); first = last) {
    last = last_at_node(first);
    const int node = active_contacts_[first].node;
    const Square<dim> mass = mass_of(node);
    while (supported != active_prescribed_.end() && supported->node < node) ++supported;
    const bool has_support = supported != active_prescribed_.end() && supported->node == node;
    settle_node(t, gamma, grid.position[node], mass, pores, first, last, has_support ? &*supported : nullptr, v[node]);
    for (size_t k = first; k < last; ++k) {
      ActiveContact &c = active_contacts_[k];
      commit(c, gamma);
      if (!counted_[node]) continue;
      Reaction r{node, c.contact->source, {}};
      map<dim>(r.value) = mass * map<dim>(c.change);
      for (int d = 0; d < dim; ++d) impulse_[r.source][d] += r.value[d];
      impulses_.push_back(r);
      rubbed_[r.source][0] += c.rubs;
      rubbed_[r.source][1] += c.pressed;
    }
  }
  for (const ActivePrescribed &p : active_prescribed_)
    for (int k = 0; k < p.condition->count; ++k) {
      const Vec<dim> &direction = p.condition->direction[k];
      Vec<dim> before = v[p.node];
      impose(p, k, t, grid.position[p.node], v[p.node]);
      add<dim>(before, -dot<dim>(p.change, direction), direction);
      account(p.node, p.condition->source[k], before);
    }
}

template <int dim>
PetscErrorCode Conditions<dim>::take_impulses(MPI_Comm comm, std::vector<Vec<dim>> &impulse) {
  PetscFunctionBeginUser;
  impulse.resize(impulse_.size());
  if (!impulse_.empty())
    PetscCallMPI(MPI_Allreduce(impulse_.data(), impulse.data(), static_cast<int>(impulse_.size()) * dim, MPI_DOUBLE,
                               MPI_SUM, comm));
  std::fill(impulse_.begin(), impulse_.end(), Vec<dim>{});
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Conditions<dim>::serialize(Archive &archive, FilledGrid<dim> &grid,
                                          const std::vector<std::array<double, 2>> &impedance,
                                          const std::vector<double> &filling) {
  PetscFunctionBeginUser;
  const BackgroundMesh<dim> &mesh = grid.mesh();
  archive.serialize("supports", stand_ins_);
  std::vector<long long> nodes;
  for (const Reaction &r : frozen_) nodes.push_back(mesh.global_node[r.node]);
  archive.column(archive.rows("nodes of reactions", Belongs::to_points, nodes), "reactions", frozen_);
  if (archive.reading()) {
    frozen_.resize(nodes.size());
    const LocalNumbers node_of(mesh.global_node);
    for (size_t k = 0; k < nodes.size(); ++k) frozen_[k].node = node_of(nodes[k]);
    PetscCall(begin(grid, impedance, filling));
  }
  archive.sums("boundaries", impulse_, work_, rubbed_);
  serialize_contacts(archive, grid);
  serialize_zones(archive, mesh);
  PetscFunctionReturn(0);
}

/// The contacts that soil has touched; `place` is the number of a contact at its node.
template <int dim>
void Conditions<dim>::serialize_contacts(Archive &archive, const FilledGrid<dim> &grid) {
  struct Stored {
    double capacity, gathered, since_pressed, slip;
    int place, state;
  };
  struct StoredNow {
    double force;
    int place, state;
  };
  enum { rests = 1, warm = 2, presses = 1, sticks = 2 };
  const BackgroundMesh<dim> &mesh = grid.mesh();
  const LocalNumbers node_of(archive.reading() ? mesh.global_node : std::vector<long long>{});
  std::vector<long long> nodes;
  std::vector<Stored> stored;
  for (auto &of_node : contacts_)
    for (Contact &c : of_node) {
      if (archive.reading())
        c.capacity = c.slip = 0, c.gathered = c.since_pressed = never, c.rests = c.warm = false;
      else if (c.capacity != 0 || c.gathered != never || c.since_pressed != never || c.rests || c.slip != 0 || c.warm)
        nodes.push_back(mesh.global_node[c.node]),
            stored.push_back({c.capacity, c.gathered, c.since_pressed, c.slip, static_cast<int>(&c - of_node.data()),
                              (c.rests ? rests : 0) | (c.warm ? warm : 0)});
    }
  archive.column(archive.rows("nodes of contacts", Belongs::to_points, nodes), "contacts", stored);
  for (size_t k = 0; archive.reading() && k < nodes.size(); ++k) {
    const Stored &s = stored[k];
    Contact &c = contacts_.at(first_contact_of_node_[node_of(nodes[k])]).at(s.place);
    c.capacity = s.capacity, c.gathered = s.gathered, c.since_pressed = s.since_pressed, c.slip = s.slip;
    c.rests = s.state & rests, c.warm = s.state & warm;
  }

  std::vector<StoredNow> stored_now;
  std::map<const Contact *, ActiveContact *> active;
  nodes.clear();
  for (ActiveContact &c : active_contacts_) {
    const int node = c.contact->node;
    active[c.contact] = &c;
    if (archive.reading()) continue;
    nodes.push_back(mesh.global_node[node]);
    stored_now.push_back({c.force, static_cast<int>(c.contact - contacts_[first_contact_of_node_[node]].data()),
                          (c.presses ? presses : 0) | (c.sticks ? sticks : 0)});
  }
  archive.column(archive.rows("nodes of contacts now", Belongs::to_points, nodes), "contacts now", stored_now);
  for (size_t k = 0; archive.reading() && k < nodes.size(); ++k) {
    const StoredNow &s = stored_now[k];
    const auto found = active.find(&contacts_.at(first_contact_of_node_[node_of(nodes[k])]).at(s.place));
    if (found == active.end()) continue;
    ActiveContact &c = *found->second;
    c.force = s.force, c.presses = s.state & presses, c.sticks = s.state & sticks;
  }
}

/// Heat and pressure in the shear zones that are not as they were at the start.
template <int dim>
void Conditions<dim>::serialize_zones(Archive &archive, const BackgroundMesh<dim> &mesh) {
  if (archive.reading()) std::fill(zone_state_.begin(), zone_state_.end(), 0.);
  for (int source = 0; source < static_cast<int>(sources_.size()); ++source) {
    if (!zone_grids_[source]) continue;
    const size_t width = zone_grids_[source]->size();
    std::vector<long long> nodes;
    std::vector<int> places;
    std::vector<double> states;
    for (auto &of_node : contacts_)
      for (Contact &c : of_node) {
        if (c.source != source || archive.reading() || !c.warm) continue;
        nodes.push_back(mesh.global_node[c.node]), places.push_back(static_cast<int>(&c - of_node.data()));
        states.insert(states.end(), zone_of(c), zone_of(c) + width);
      }
    const Archive::Rows rows = archive.rows("nodes of shear zones", Belongs::to_points, nodes);
    archive.column(rows, "place of the shear zone", places);
    archive.column(rows, "shear zone", states, width);
    if (!archive.reading()) continue;
    const LocalNumbers node_of(mesh.global_node);
    for (size_t k = 0; k < nodes.size(); ++k) {
      Contact &c = contacts_.at(first_contact_of_node_[node_of(nodes[k])]).at(places[k]);
      std::copy_n(&states[k * width], width, zone_of(c));
    }
  }
}

template class Conditions<2>;
template class Conditions<3>;

}  // namespace talus
