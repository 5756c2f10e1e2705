#include "physics/boundary/rigid_bases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/gather.h"
#include "base/local_numbers.h"
#include "base/room.h"

namespace talus {
namespace {

constexpr double never = FrictionMemory::never;
constexpr double stuck = 1e-7;  // of the velocity that the contacts of a node meet

}  // namespace

template <int dim>
void RigidBases<dim>::setup(int nodes, const std::vector<NamedBoundary> &sources) {
  for (const NamedBoundary &source : sources) kinds_.push_back(source.kind);
  first_contact_of_node_.assign(nodes, -1);
  zone_grids_.resize(kinds_.size()), rubbed_.assign(kinds_.size(), {0, 0});
}

template <int dim>
void RigidBases<dim>::add_contact(int node, int source, const Vec<dim> &normal, double area) {
  int &index = first_contact_of_node_[node];
  if (index < 0) index = static_cast<int>(contacts_.size()), contacts_.emplace_back();
  contacts_[index].push_back({node, source, normal, area, {}, false, 0, 0, 0, 0, -1, false});
}

template <int dim>
size_t RigidBases<dim>::finish_setup() {
  for (size_t s = 0; s < kinds_.size(); ++s)
    if (kinds_[s].shear_zone) zone_grids_[s] = std::make_unique<ShearZoneGrid>(*kinds_[s].shear_zone);
  int zone_values = 0;
  size_t contacts = 0, most = 0;
  for (auto &of_node : contacts_) {
    contacts += of_node.size(), most = std::max(most, of_node.size());
    for (Contact &c : of_node)
      if (zone_grids_[c.source]) c.zone = zone_values, zone_values += grid_of(c).size(), zoned_.push_back(&c);
  }
  zone_state_.assign(zone_values, 0);
  active_.reserve(contacts);
  take_turns_.reserve(most + 1);  // and a support
  return contacts;
}

template <int dim>
PetscErrorCode RigidBases<dim>::begin(FilledGrid<dim> &grid, const std::vector<double> &filling) {
  PetscFunctionBeginUser;
  active_.clear();
  if (none()) PetscFunctionReturn(0);
  const int nodes = grid.node_count();
  for (auto &of_node : contacts_)
    for (Contact &c : of_node)
      if (grid.find_node(c.node) < 0) {
        c.memory = {0, never, never};  // soil that arrives here later has not pressed yet
        c.slip = c.beside = c.covered * c.slip + (1 - c.covered) * c.beside;
        c.covered = c.passed = 0;
      }
  enum { area, soil, room, width };  // with soil behind it [m2]; volume in the cells beside it, and theirs [m3]
  zeros_with_room(nodal_, static_cast<size_t>(nodes) * width);
  for (const auto &[source, facets] : facets_)
    for (const Facet<dim> &f : facets) {
      const int cell = grid.find_cell(f.cell);
      const auto &vertex = grid.mesh().cells[f.cell].node;
      for (int k = 0; k <= dim; ++k) {
        const int node = k == f.face ? -1 : grid.find_node(vertex[k]);
        if (node < 0) continue;
        double *of = &nodal_[node * width];
        of[room] += grid.mesh().volume[f.cell] / (dim + 1);
        if (cell < 0) continue;
        of[area] += f.area / dim * std::min(1., filling[cell]);
        of[soil] += grid.nodal_share[cell][k];
      }
    }
  PetscCall(grid.sum(nodal_.data(), width));
  for (int i = 0; i < nodes; ++i) {
    const int index = first_contact_of_node_[grid.mesh_node[i]];
    if (index < 0) continue;
    const double *of = &nodal_[i * width];
    double total = 0;
    for (const Contact &c : contacts_[index]) total += c.area;
    for (Contact &c : contacts_[index]) {
      cover(c, of[soil] / of[room]);
      active_.push_back({.node = i,
                         .contact = &c,
                         .area = of[area] * c.area / total,
                         .force = 0,
                         .presses = c.rests,
                         .sticks = c.rests,
                         .counted = static_cast<bool>(grid.mesh().counted[grid.mesh_node[i]]),
                         .rubbed = {},
                         .change = {},
                         .pressed = 0,
                         .rubs = 0,
                         .capacity = 0});
    }
  }
  PetscFunctionReturn(0);
}

/// Soil covers this share of the place of a contact now, and what it has covered since it came. The ground that it
/// comes to brings its own slip, docs/theory (6.7a). Soil that has passed from one end of the place to the other has
/// covered all of it, however thin it is.
template <int dim>
void RigidBases<dim>::cover(Contact &c, double share) {
  const double length = dim == 2 ? 2 * c.area : 2 * std::sqrt(3 * c.area / M_PI);
  const double now = std::clamp(share, c.covered, 1.);
  if (c.passed >= length)
    c.covered = 1;
  else if (now > c.covered)
    c.slip += (now - c.covered) / now * (c.beside - c.slip), c.covered = now;
}

template <int dim>
PetscErrorCode RigidBases<dim>::find_depth(const BackgroundMesh<dim> &mesh, const std::vector<char> &filled,
                                           double *depth) const {
  double sums[2] = {}, ends[2 * dim];  // volume and area; how far the soil reaches towards +d and -d
  PetscFunctionBeginUser;
  *depth = 0;
  if (none()) PetscFunctionReturn(0);
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
  for (const auto &[source, facets] : facets_)
    for (const Facet<dim> &f : facets)
      if (filled[f.cell]) sums[1] += f.area;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh.comm()));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends, 2 * dim, MPI_DOUBLE, MPI_MAX, mesh.comm()));
  for (int d = 0; d < dim; ++d) *depth = std::max(*depth, ends[d] + ends[dim + d]);
  if (sums[1] > 0) *depth = std::min(*depth, sums[0] / sums[1]);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode RigidBases<dim>::set_normal_forces(const BackgroundMesh<dim> &mesh, std::vector<NormalForce> forces,
                                                  double t) {
  PetscFunctionBeginUser;
  if (none()) PetscFunctionReturn(0);
  PetscCall(gather_from(mesh.comm(), mesh.halo.neighbours(), forces));
  std::map<Vec<dim>, std::vector<Contact> *> at;
  for (auto &of_node : contacts_) {
    for (Contact &c : of_node) c.memory = {0, never, never}, c.rests = false;
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
    nearest->memory.capacity +=
        f.force * friction_delay_ *
        kinds_[f.source].friction_coefficient(x[0], x[1], dim == 3 ? x[dim - 1] : 0, t, nearest->slip);
    nearest->memory.since_pressed = 0, nearest->rests = true;
  }
  PetscFunctionReturn(0);
}

/// The contacts of a node follow one another; the place behind the last one of the node of contact `first`.
template <int dim>
size_t RigidBases<dim>::last_at_node(size_t first) const {
  size_t last = first + 1;
  while (last < active_.size() && active_[last].node == active_[first].node) ++last;
  return last;
}

/// All that acts on the vector of a node takes its turn there, the contact that it presses on most before the others,
/// so that one contact that holds the node alone leaves nothing to them: which of them is the first in a list must not
/// matter. `at_contact(c, into, others)`, where `into` is the part of `others` into the base, changes `others` and says
/// whether the base also takes what draws off it, besides what presses on it; `at_support(p, others)` changes `others`.
template <int dim>
template <class AtContact, class AtSupport>
void RigidBases<dim>::take_turns_at_nodes(PrescribedMotion<dim> &prescribed, Vec<dim> *vectors,
                                          const AtContact &at_contact, const AtSupport &at_support) {
  for (size_t first = 0, last; first < active_.size(); first = last) {
    last = last_at_node(first);
    const int node = active_[first].node, contacts = static_cast<int>(last - first);
    Vec<dim> &v = vectors[node];
    const auto presses_less = [&](const Active &a, const Active &b) {
      return dot<dim>(v, a.contact->normal) < dot<dim>(v, b.contact->normal);
    };
    const auto most = std::max_element(&active_[first], &active_[first] + contacts, presses_less) - &active_[first];
    const auto *support = prescribed.find(node);
    take_turns_(contacts + (support != nullptr), static_cast<int>(most), v, [&](int k, const Vec<dim> &others) {
      Vec<dim> left = others;
      if (k == contacts) {
        at_support(*support, left);
        return left;
      }
      const Vec<dim> &n = active_[first + k].contact->normal;
      const double into = dot<dim>(left, n);
      const bool holds = at_contact(active_[first + k], into, left);
      if (into > 0 || holds) add_scaled<dim>(left, -dot<dim>(left, n), n);
      return left;
    });
  }
}

template <int dim>
void RigidBases<dim>::constrain(double t, const FilledGrid<dim> &grid, PrescribedMotion<dim> &prescribed, Vec<dim> *v,
                                bool sticking) {
  using Support = typename PrescribedMotion<dim>::Active;
  take_turns_at_nodes(
      prescribed, v,
      [&](const Active &c, double into, Vec<dim> &left) {
        if (sticking && c.sticks) left = {}, add_scaled<dim>(left, into, c.contact->normal);
        return sticking && c.presses;
      },
      [&](const Support &p, Vec<dim> &left) { prescribed.impose(p, t, grid.position[p.node], left); });
}

template <int dim>
void RigidBases<dim>::leave_base(PrescribedMotion<dim> &prescribed, Vec<dim> *v) {
  take_turns_at_nodes(
      prescribed, v, [](const Active &, double, Vec<dim> &) { return false; },
      [](const typename PrescribedMotion<dim>::Active &, Vec<dim> &) {});
}

template <int dim>
void RigidBases<dim>::project(PrescribedMotion<dim> &prescribed, const Vec<dim> *v, Vec<dim> *force) {
  using Support = typename PrescribedMotion<dim>::Active;
  take_turns_at_nodes(
      prescribed, force,
      [&](const Active &c, double into, Vec<dim> &left) {
        const Vec<dim> &n = c.contact->normal;
        Vec<dim> slip = v[c.node];
        add_scaled<dim>(slip, -dot<dim>(slip, n), n);
        const double speed = std::sqrt(dot<dim>(slip, slip));
        if (c.sticks)
          left = {}, add_scaled<dim>(left, into, n);
        else if (speed > 0)
          add_scaled<dim>(left, -c.force / speed, slip);
        return false;
      },
      [](const Support &p, Vec<dim> &left) { p.condition->take_from(left); });
}

/// The velocity that contact `c` alone leaves of the velocity `before` of its node, theory (6.1).
template <int dim>
Vec<dim> RigidBases<dim>::respond(Active &c, double t, double gamma, const Vec<dim> &x, const Square<dim> &mass,
                                  const PoresInContact<dim> &pores, const Vec<dim> &before) {
  const Contact &contact = *c.contact;
  const Vec<dim> &n = contact.normal;
  const Boundary &base = kinds_[contact.source];
  const double into = dot<dim>(before, n);
  Vec<dim> slip = before;
  add_scaled<dim>(slip, -into, n);
  c.presses = into > 0;
  const double z = dim == 3 ? x[dim - 1] : 0, slipped = contact.slip,
               slope = base.friction_coefficient(x[0], x[1], z, t, slipped);
  c.pressed = c.presses ? map<dim>(n).dot(mass * map<dim>(n)) * into : 0;
  c.capacity = contact.memory.capacity;
  if (c.presses) c.capacity += slope * c.pressed;
  if (pores.thrust) c.capacity -= slope * gamma * pores.thrust(c.node, n);
  const double forgotten = contact.memory.share(gamma, friction_delay_) * c.capacity;
  const double speed = std::sqrt(dot<dim>(slip, slip));
  const double m = speed > 0 ? map<dim>(slip).dot(mass * map<dim>(slip)) / (speed * speed) : 0;
  const bool adheres = contact.memory.adheres(c.presses, gamma, friction_delay_);
  const double adhering = adheres ? base.adhesion(x[0], x[1], z, t, slipped) * c.area * gamma : 0;
  const double rubbing = left_by_pressure(c, std::max(0., forgotten), adhering, slope, gamma, speed);
  const double most = rubbing + adhering;
  if (!contact.memory.gathers(friction_delay_)) c.capacity -= forgotten;
  c.force = most / gamma, c.sticks = m * speed <= most;
  const double share = c.sticks ? 1 : most / (m * speed);
  c.rubs = share * m * speed;
  c.rubbed = {}, add_scaled<dim>(c.rubbed, -share * m, slip);
  Vec<dim> after{};
  if (!c.presses) add_scaled<dim>(after, into, n);
  if (!c.sticks) add_scaled<dim>(after, 1 - most / (m * speed), slip);
  return after;
}

/// What a contact remembers of a step.
template <int dim>
void RigidBases<dim>::commit(Active &c, double gamma) {
  Contact &contact = *c.contact;
  contact.rests = false;
  contact.memory.pass(gamma, c.presses, c.capacity);
}

template <int dim>
void RigidBases<dim>::resolve(double t, double gamma, const FilledGrid<dim> &grid, PrescribedMotion<dim> &prescribed,
                              const PoresInContact<dim> &pores, Vec<dim> *velocities) {
  resolved_step_ = gamma;
  spread_heat(gamma);
  for (size_t first = 0, last; first < active_.size(); first = last) {
    last = last_at_node(first);
    const int node = active_[first].node;
    const Vec<dim> &x = grid.position[node];
    Vec<dim> &v = velocities[node];
    const Square<dim> mass = pores.mass(grid, node);
    auto *support = prescribed.find(node);
    const int contacts = static_cast<int>(last - first), supports = support ? 1 : 0;
    double met = 0;
    take_turns_(contacts + supports, 0, v, [&](int k, Vec<dim> others) {
      if (k < supports) {
        prescribed.impose(*support, t, x, others);
        return others;
      }
      if (k == supports) met = std::max(met, std::sqrt(dot<dim>(v, v)));
      return respond(active_[first + k - supports], t, gamma, x, mass, pores, others);
    });
    if (support) support->change = take_turns_.change(0);
    for (int k = 0; k < contacts; ++k) {
      Active &c = active_[first + k];
      c.change = take_turns_.change(supports + k);
      // friction that holds the node together with others may be at its own limit to round-off
      if (contacts + supports > 1) {
        Vec<dim> slip = v;
        add_scaled<dim>(slip, -dot<dim>(v, c.contact->normal), c.contact->normal);
        c.sticks = c.force > 0 && std::sqrt(dot<dim>(slip, slip)) <= stuck * met;
      }
      commit(c, gamma);
      if (c.counted) rubbed_[c.contact->source][0] += c.rubs, rubbed_[c.contact->source][1] += c.pressed;
    }
  }
}

template <int dim>
void RigidBases<dim>::add_slip(const Vec<dim> *u) {
  for (Active &c : active_)
    if (kinds_[c.contact->source].remembers) add_slip(c, u[c.node]);
}

/// Slip is the way of a node along the base while it touches it; the work of friction on this way becomes heat.
template <int dim>
void RigidBases<dim>::add_slip(Active &c, const Vec<dim> &u) {
  Contact &contact = *c.contact;
  if (contact.memory.since_pressed > friction_delay_) return;
  Vec<dim> along = u;
  add_scaled<dim>(along, -dot<dim>(along, contact.normal), contact.normal);
  const double way = std::sqrt(dot<dim>(along, along));
  contact.passed += way;
  if (!remembers_) return;
  contact.slip += way;
  const double work = -dot<dim>(c.rubbed, u) / resolved_step_;
  if (contact.zone < 0 || c.area <= 0 || work == 0) return;
  grid_of(contact).add_heat(work / c.area, zone_of(contact));
  contact.warm = true;
}

/// Heat and excess pressure spread in all shear zones, those that soil has left among them.
template <int dim>
void RigidBases<dim>::spread_heat(double gamma) {
  for (const auto &grid : zone_grids_)
    if (grid) grid->set_step(gamma);
  for (Contact *c : zoned_)
    if (c->warm) grid_of(*c).spread(zone_of(*c));
}

/// Friction impulse that excess pressure leaves of `rubbing` beside the impulse of adhesion, docs/theory (6.11):
/// implicit in the pressure that the heat of this step brings, at the speed of slip before friction.
template <int dim>
double RigidBases<dim>::left_by_pressure(const Active &c, double rubbing, double adhering, double slope, double gamma,
                                         double speed) {
  const Contact &contact = *c.contact;
  if (contact.zone < 0 || c.area <= 0) return rubbing;
  const ShearZoneGrid &grid = grid_of(contact);
  const double taken = slope * gamma * c.area * (contact.warm ? grid.pressure(zone_of(contact)) : 0);
  const double heating = remembers_ ? slope * gamma * speed * grid.pressure_per_heat() : 0;
  return std::max(0., (rubbing - taken - heating * adhering) / (1 + heating));
}

template <int dim>
void RigidBases<dim>::forget_slip() {
  for (auto &of_node : contacts_)
    for (Contact &c : of_node) c.slip = c.beside = 0, c.warm = false;
  std::fill(zone_state_.begin(), zone_state_.end(), 0);
}

template <int dim>
PetscErrorCode RigidBases<dim>::take_reports(MPI_Comm comm, std::vector<Report> &reports) {
  PetscFunctionBeginUser;
  enum { area, slip, temperature, pressure, heat, friction, normal, sums };
  const int sources = static_cast<int>(kinds_.size());
  reports.assign(sources, {});
  if (none()) PetscFunctionReturn(0);
  std::vector<double> sum(sums * sources, 0), hottest(sources, 0);
  for (int s = 0; s < sources; ++s) std::copy_n(rubbed_[s].begin(), 2, &sum[s * sums + friction]);
  std::fill(rubbed_.begin(), rubbed_.end(), std::array<double, 2>{});
  for (const Active &c : active_) {
    const Contact &contact = *c.contact;
    if (!c.counted || contact.memory.since_pressed > friction_delay_) continue;
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
void RigidBases<dim>::serialize(Archive &archive, const FilledGrid<dim> &grid) {
  archive.sums("friction of bases", rubbed_);
  serialize_contacts(archive, grid.mesh());
  serialize_zones(archive, grid.mesh());
}

/// The contacts that soil has touched; `place` is the number of a contact at its node.
template <int dim>
void RigidBases<dim>::serialize_contacts(Archive &archive, const BackgroundMesh<dim> &mesh) {
  struct Stored {
    FrictionMemory memory;
    double slip, beside, covered, passed;
    int place, state;
  };
  struct StoredNow {
    double force;
    int place, state;
  };
  enum { rests = 1, warm = 2, presses = 1, sticks = 2 };
  const LocalNumbers node_of(archive.reading() ? mesh.global_node : std::vector<long long>{});
  std::vector<long long> nodes;
  std::vector<Stored> stored;
  for (auto &of_node : contacts_)
    for (Contact &c : of_node) {
      if (archive.reading())
        c.slip = c.beside = c.covered = c.passed = 0, c.memory = {0, never, never}, c.rests = c.warm = false;
      else if (c.memory.capacity != 0 || c.memory.gathered != never || c.memory.since_pressed != never || c.rests ||
               c.slip != 0 || c.beside != 0 || c.covered != 0 || c.warm)
        nodes.push_back(mesh.global_node[c.node]),
            stored.push_back({c.memory, c.slip, c.beside, c.covered, c.passed, static_cast<int>(&c - of_node.data()),
                              (c.rests ? rests : 0) | (c.warm ? warm : 0)});
    }
  archive.column(archive.rows("nodes of contacts", Belongs::to_points, nodes), "contacts", stored);
  for (size_t k = 0; archive.reading() && k < nodes.size(); ++k) {
    const Stored &s = stored[k];
    Contact &c = contacts_.at(first_contact_of_node_[node_of(nodes[k])]).at(s.place);
    c.memory = s.memory;
    c.slip = s.slip, c.beside = s.beside, c.covered = s.covered, c.passed = s.passed;
    c.rests = s.state & rests, c.warm = s.state & warm;
  }

  std::vector<StoredNow> stored_now;
  std::map<const Contact *, Active *> active;
  nodes.clear();
  for (Active &c : active_) {
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
    Active &c = *found->second;
    c.force = s.force, c.presses = s.state & presses, c.sticks = s.state & sticks;
  }
}

/// Heat and pressure in the shear zones that are not as they were at the start.
template <int dim>
void RigidBases<dim>::serialize_zones(Archive &archive, const BackgroundMesh<dim> &mesh) {
  if (archive.reading()) std::fill(zone_state_.begin(), zone_state_.end(), 0.);
  for (int source = 0; source < static_cast<int>(kinds_.size()); ++source) {
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

template class RigidBases<2>;
template class RigidBases<3>;

}  // namespace talus
