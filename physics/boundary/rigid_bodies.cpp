#include "physics/boundary/rigid_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/gather.h"
#include "base/local_numbers.h"
#include "meshes/locate.h"
#include "scene/rigid_source.h"

namespace talus {
namespace {

constexpr double anywhere = std::numeric_limits<double>::infinity(), prescribed_mass = anywhere;
constexpr double stiff = 1e-6;        // mobility of a node that cannot give way, over that of its mass
constexpr double entry = 0.2;         // depth to which soil may enter a body, in units of the cell size
constexpr double search_again = 0.1;  // way of a body, in units of the smallest edge of the mesh

/// Half the mean distance of particles: how far the soil of one reaches.
template <int dim>
double radius(double volume) {
  return (dim == 2 ? std::sqrt(volume) : std::cbrt(volume)) / 2;
}

template <int dim>
Vec<dim> difference(const Vec<dim> &a, const Vec<dim> &b) {
  Vec<dim> result = a;
  add_scaled<dim>(result, -1, b);
  return result;
}

/// Of the shape function of corner k.
template <int dim>
Vec<dim> shape_gradient(const Cell<dim> &cell, int k) {
  if (k > 0) return cell.gradient[k - 1];
  Vec<dim> first{};
  for (const Vec<dim> &one : cell.gradient) add_scaled<dim>(first, -1, one);
  return first;
}

double value(const Function &function, double t) { return function.given() ? function(t) : 0; }

}  // namespace

// ---- bodies ----

template <int dim>
RigidBodies<dim>::RigidBodies(const BackgroundMesh<dim> &mesh, const Soil &soil,
                              const std::vector<RigidSource> &sources)
    : mesh_(mesh), soil_(soil), sources_(sources), impulse_(sources.size(), Freedoms{}) {
  for (const RigidSource &source : sources) bodies_.push_back(moving_of(source));
  for (const int node : mesh.halo.shared_nodes()) shared_.emplace(mesh.global_node[node], node);
  smallest_edge_ = anywhere;
  for (const double edge : mesh.mean_edge) smallest_edge_ = std::min(smallest_edge_, edge);
  MPI_Allreduce(MPI_IN_PLACE, &smallest_edge_, 1, MPI_DOUBLE, MPI_MIN, mesh.comm());
}

template <int dim>
auto RigidBodies<dim>::moving_of(const RigidSource &source) -> Moving {
  Moving body{RigidShape<dim>(source.polygon), {}, {}, {}, {}};
  Vec<dim> centre = body.shape.centre();
  if (!source.centre.empty()) std::copy_n(source.centre.begin(), dim, centre.begin());
  const double mass = source.density > 0 ? source.density * body.shape.volume() : source.mass;
  const double off = map<dim>(difference<dim>(centre, body.shape.centre())).squaredNorm();
  const double uniform = mass * (body.shape.square_radius() + off);
  body.mass.fill(prescribed_mass);
  if (source.is_free()) std::fill_n(body.mass.begin(), dim, mass);
  if (source.is_free() && !source.rotation.given()) body.mass[dim] = source.inertia > 0 ? source.inertia : uniform;
  std::copy_n(centre.begin(), dim, body.place.begin());
  std::copy(source.initial_velocity.begin(), source.initial_velocity.end(), body.velocity.begin());
  for (double &x : centre) x = -x;
  body.shape.move(centre);
  return body;
}

template <int dim>
ConstMap<dim> RigidBodies<dim>::centre(const Moving &body) const {
  return ConstMap<dim>(body.place.data());
}

/// The rotation vector grows with the rotation about a fixed axis; bodies that turn freely are those of plane strain.
template <int dim>
Square<dim> RigidBodies<dim>::orientation(const Freedoms &place) const {
  if constexpr (dim == 2) return Eigen::Rotation2Dd(place[2]).toRotationMatrix();
  const ColumnVector<dim> turned = map<freedoms>(place).template tail<dim>();
  if constexpr (dim == 3) return Eigen::AngleAxisd(turned.norm(), turned.stableNormalized()).toRotationMatrix();
}

/// Where a point of the body is now that was at `x` at the last search.
template <int dim>
Vec<dim> RigidBodies<dim>::carried(const Moving &body, const Vec<dim> &x) const {
  const ConstMap<dim> from(body.searched.data()), to(body.place.data());
  Vec<dim> now;
  map<dim>(now) = to + orientation(body.place) * (orientation(body.searched).transpose() * (map<dim>(x) - from));
  return now;
}

/// Velocity of a point of the body at `x` by each freedom.
template <int dim>
auto RigidBodies<dim>::arm(const Moving &body, const Vec<dim> &x) const -> Arm {
  const ColumnVector<dim> r = map<dim>(x) - centre(body);
  Arm arm;
  if constexpr (dim == 2)
    arm << 1, 0, -r[1], 0, 1, r[0];
  else
    arm << 1, 0, 0, 0, r[2], -r[1], 0, 1, 0, -r[2], 0, r[0], 0, 0, 1, r[1], -r[0], 0;
  return arm;
}

/// Of a place from the surface of the body now.
template <int dim>
double RigidBodies<dim>::distance(const Moving &body, const Vec<dim> &x, Vec<dim> &outward) const {
  const Square<dim> turned = orientation(body.place);
  Vec<dim> local;
  map<dim>(local) = turned.transpose() * (map<dim>(x) - centre(body));
  const double distance = body.shape.distance(local, outward);
  map<dim>(outward) = (turned * map<dim>(outward)).eval();
  return distance;
}

// ---- search ----

template <int dim>
bool RigidBodies<dim>::find_overlap(double share, int *body, Vec<dim> *where) const {
  double deepest = 0;
  for (const auto &soil : soil_)
    for (int i = 0; i < soil->particles().count; ++i)
      for (size_t b = 0; b < bodies_.size(); ++b) {
        const ParticleArrays<dim> &p = soil->particles();
        Vec<dim> outward;
        const double depth = radius<dim>(p.volume[i]) - distance(bodies_[b], p.position[i], outward) -
                             share * mesh_.mean_edge[mesh_.cells[p.cell[i]].node[0]];
        if (depth > deepest) deepest = depth, *body = static_cast<int>(b), *where = p.position[i];
      }
  return deepest > 0;
}

template <int dim>
PetscErrorCode RigidBodies<dim>::search(const FilledGrid<dim> &grid) {
  PetscFunctionBeginUser;
  for (Moving &body : bodies_) body.searched = body.place;
  candidates_.clear();
  for (const auto &soil : soil_)
    for (int i = 0; i < soil->particles().count; ++i) add_candidates(grid, *soil, i);
  merge_candidates();
  PetscCall(share_candidates());
  std::swap(contacts_, before_), contacts_.clear();
  for (const Candidate &found : candidates_)
    if (grid.find_node(found.node) >= 0) contacts_.push_back(contact_of(found, grid));
  searched_ = true;
  PetscFunctionReturn(0);
}

/// The nodes of the cell of a particle near a body. One behind the particle, as the body sees it, meets the body once
/// soil has entered: at once it would make the layer between both rigid.
template <int dim>
void RigidBodies<dim>::add_candidates(const FilledGrid<dim> &grid, const Body<dim> &soil, int i) {
  const ParticleArrays<dim> &p = soil.particles();
  const Cell<dim> &cell = mesh_.cells[p.cell[i]];
  const double edge = mesh_.mean_edge[cell.node[0]], reach = radius<dim>(p.volume[i]);
  for (int b = 0; b < static_cast<int>(bodies_.size()); ++b) {
    const Moving &body = bodies_[b];
    const double most = body.shape.reach() + 3 * edge;
    if ((map<dim>(p.position[i]) - centre(body)).squaredNorm() > most * most) continue;
    const auto n = barycentric(cell, p.position[i]);
    Vec<dim> now{}, outward, ignored;
    for (int k = 0; k <= dim; ++k) add_scaled<dim>(now, n[k], grid.position[grid.find_node(cell.node[k])]);
    const double away = distance(body, now, outward), gap = away - reach;
    for (int k = 0; k <= dim && gap <= edge; ++k) {
      const bool behind = distance(body, grid.position[grid.find_node(cell.node[k])], ignored) > away;
      const double area = -p.volume[i] * dot<dim>(shape_gradient(cell, k), outward);
      candidates_.push_back(
          {mesh_.global_node[cell.node[k]], b, cell.node[k], gap + (behind ? entry * edge : 0), area, outward});
    }
  }
}

/// Leaves one candidate of a body at a node: the nearest, with the area of all. Their order does not depend on that of
/// the particles.
template <int dim>
void RigidBodies<dim>::merge_candidates() {
  const auto key = [](const Candidate &c) { return std::tie(c.body, c.global, c.gap, c.outward, c.area); };
  std::sort(candidates_.begin(), candidates_.end(),
            [&](const Candidate &a, const Candidate &b) { return key(a) < key(b); });
  size_t count = 0;
  for (const Candidate &c : candidates_)
    if (count > 0 && candidates_[count - 1].body == c.body && candidates_[count - 1].global == c.global)
      candidates_[count - 1].area += c.area;
    else
      candidates_[count++] = c;
  candidates_.resize(count);
}

/// Nodes that ranks share have the candidates of all of them. Collective.
template <int dim>
PetscErrorCode RigidBodies<dim>::share_candidates() {
  PetscFunctionBeginUser;
  if (mesh_.halo.neighbours().empty()) PetscFunctionReturn(0);
  std::vector<Candidate> shared;
  std::erase_if(candidates_, [&](const Candidate &c) {
    if (!shared_.contains(c.global)) return false;
    shared.push_back(c);
    return true;
  });
  PetscCall(gather_from(mesh_.comm(), mesh_.halo.neighbours(), shared));
  for (Candidate &c : shared)
    if (const auto mine = shared_.find(c.global); mine != shared_.end())
      c.node = mine->second, candidates_.push_back(c);
  merge_candidates();
  PetscFunctionReturn(0);
}

/// A contact, with what the one of the search before remembers.
template <int dim>
auto RigidBodies<dim>::contact_of(const Candidate &found, const FilledGrid<dim> &grid) const -> Contact {
  const auto key = [](const auto &c) { return std::tie(c.body, c.global); };
  const auto old = std::lower_bound(before_.begin(), before_.end(), found,
                                    [&](const Contact &a, const Candidate &b) { return key(a) < key(b); });
  Contact c{};
  c.memory = {0, searched_ ? FrictionMemory::never : 0, FrictionMemory::never}, c.follows = anywhere;
  if (old != before_.end() && key(*old) == key(found)) c = *old;
  c.global = found.global, c.body = found.body, c.node = found.node, c.gap = found.gap,
  c.area = std::max(found.area, 0.);
  c.at = grid.find_node(found.node), c.place = grid.position[c.at], c.normal = {};
  add_scaled<dim>(c.normal, -1, found.outward);
  return c;
}

/// Has a body moved so far that nodes near it are others? It moves no node of the soil, so that no remap looks.
template <int dim>
bool RigidBodies<dim>::search_due() const {
  for (const Moving &body : bodies_) {
    Freedoms way = body.place;
    map<freedoms>(way) -= map<freedoms>(body.searched);
    const double moved =
        map<freedoms>(way).template head<dim>().norm() +
        map<freedoms>(way).template tail<freedoms - dim>().norm() * (body.shape.reach() + smallest_edge_);
    if (moved > search_again * smallest_edge_) return true;
  }
  return false;
}

// ---- a step ----

/// Velocity at the end of a step that ends at t, if no soil is in the way.
template <int dim>
auto RigidBodies<dim>::predicted(int b, double t, double gamma) const -> Freedoms {
  const RigidSource &source = sources_[b];
  const Moving &body = bodies_[b];
  Freedoms velocity = body.velocity;
  for (int d = 0; d < dim; ++d) {
    const double force = source.force.empty() ? 0 : source.force[d](t);
    velocity[d] = source.is_free()          ? velocity[d] + gamma * (gravity_[d] + force / body.mass[d])
                  : source.velocity.empty() ? 0
                                            : source.velocity[d](t);
  }
  if (std::isinf(body.mass[dim])) velocity[dim] = value(source.rotation, t);
  const double speed = map<freedoms>(velocity).template head<dim>().norm();
  if (source.largest_speed > 0 && speed > source.largest_speed)
    for (int d = 0; d < dim; ++d) velocity[d] *= source.largest_speed / speed;
  return velocity;
}

template <int dim>
size_t RigidBodies<dim>::first_contact(int body) const {
  return std::lower_bound(contacts_.begin(), contacts_.end(), body,
                          [](const Contact &c, int of) { return c.body < of; }) -
         contacts_.begin();
}

/// Supports, and bases on which the node presses, bear what would move it in these directions.
template <int dim>
PrescribedDirections<dim> RigidBodies<dim>::held_at(int node, const Step &step) const {
  PrescribedDirections<dim> held{};
  if (const auto *support = step.prescribed.find(node)) held = *support->condition;
  step.bases.each_at(node, [&](const auto &base) {
    if (base.presses) held.add(base.contact->normal, base.contact->source);
  });
  return held;
}

/// What a contact meets in a step.
template <int dim>
auto RigidBodies<dim>::meeting(const Contact &c, const Step &step, const Vec<dim> *v) const -> Meeting {
  const RigidSource &source = sources_[c.body];
  const Vec<dim> &x = step.grid.position[c.at];
  const double inverse = 1 / step.grid.mass[c.at], z = dim == 3 ? x[dim - 1] : 0;
  Square<dim> mobility = inverse * Square<dim>::Identity();
  for (int k = 0; k < c.held.count; ++k)
    mobility -= inverse * map<dim>(c.held.direction[k]) * map<dim>(c.held.direction[k]).transpose();
  const Vec<dim> body = difference<dim>(carried(bodies_[c.body], c.place), c.place), soil = difference<dim>(x, c.place);
  const double gap = c.gap + dot<dim>(difference<dim>(body, soil), c.normal);
  return {.counted = static_cast<bool>(mesh_.counted[c.node]),
          .mobility = mobility,
          .light = stiff * inverse,
          .least = source.is_free() ? stiff * inverse : 0,
          .closing = std::max(gap, 0.) / step.gamma,
          .slope = std::tan(source.friction_angle(x[0], x[1], z, step.t)),
          .adhering = source.adhesion(x[0], x[1], z, step.t) * c.area * step.gamma,
          .share = c.memory.share(step.gamma, step.bases.friction_delay()),
          .before = v[c.at]};
}

template <int dim>
Vec<dim> RigidBodies<dim>::velocity_at(const Moving &body, const Freedoms &motion, const Vec<dim> &x) const {
  Vec<dim> velocity;
  map<dim>(velocity) = arm(body, x) * map<freedoms>(motion);
  return velocity;
}

/// Impulse between a node and a body that moves with `motion`, theory (6.13), (6.14).
template <int dim>
auto RigidBodies<dim>::respond(size_t contact, const Step &step, const Freedoms &motion) const -> Response {
  const Contact &c = contacts_[contact];
  const Meeting &m = meetings_[contact];
  const Vec<dim> with = velocity_at(bodies_[c.body], motion, step.grid.position[c.at]);
  const ColumnVector<dim> n = map<dim>(c.normal);
  ColumnVector<dim> against = map<dim>(m.before) - map<dim>(with);
  const double across = n.dot(m.mobility * n), give = across < m.light ? m.least : across,
               along = (m.mobility.trace() - across) / (dim - 1), into = against.dot(n) - m.closing;
  Response r{};
  r.presses = into > 0 && give > 0;
  const double pressed = r.presses ? into / give : 0;
  against -= pressed * m.mobility * n;
  const ColumnVector<dim> slip = against - against.dot(n) * n;
  const double speed = slip.norm(), delay = step.bases.friction_delay();
  r.capacity = c.memory.capacity + m.slope * pressed;
  r.most = m.share * r.capacity + (c.memory.adheres(r.presses, step.gamma, delay) ? m.adhering : 0);
  r.sticks = along > m.light && speed <= along * r.most;
  const double rubs = speed == 0 ? 0 : r.sticks ? 1 / along : r.most / speed;
  map<dim>(r.impulse) = pressed * n + rubs * slip;
  r.stiffness.setZero();
  if (r.presses) r.stiffness = (n * n.transpose()) / give;
  if (r.sticks)
    r.stiffness += (Square<dim>::Identity() - n * n.transpose()) / along;
  else if (r.presses && speed > 0)
    r.stiffness += m.share * m.slope / (give * speed) * slip * n.transpose();
  return r;
}

/// Sums over the nodes of all ranks for a free body that moves with `motion`: the stiffness that they put against a
/// change of it, and behind it their impulse, in its freedoms. Collective.
template <int dim>
PetscErrorCode RigidBodies<dim>::sum_responses(int b, const Step &step, const Freedoms &motion, System *sums) const {
  PetscFunctionBeginUser;
  sums->setZero();
  for (size_t k = first_contact(b); k < first_contact(b + 1); ++k) {
    if (!meetings_[k].counted) continue;
    const Response r = respond(k, step, motion);
    const Arm lever = arm(bodies_[b], step.grid.position[contacts_[k].at]);
    sums->template leftCols<freedoms>() += lever.transpose() * r.stiffness * lever;
    sums->col(freedoms) += lever.transpose() * map<dim>(r.impulse);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums->data(), freedoms * (freedoms + 1), MPI_DOUBLE, MPI_SUM, mesh_.comm()));
  PetscFunctionReturn(0);
}

/// Motion of a free body at the end of a step with the impulses that belong to it, by Newton's method in its freedoms:
/// given the motion, nodes do not know one another. `motion` begins as what is predicted without soil. Collective.
template <int dim>
PetscErrorCode RigidBodies<dim>::solve(int b, const Step &step, Freedoms *motion) const {
  constexpr int most = 60, slower = 20;  // iterations, and from when on by half of their change
  constexpr double negligible = 1e-14;
  const Freedoms start = *motion, &mass = bodies_[b].mass;
  PetscFunctionBeginUser;
  for (int iteration = 0; iteration < most; ++iteration) {
    System system;
    PetscCall(sum_responses(b, step, *motion, &system));
    for (int f = 0; f < freedoms; ++f) {
      if (std::isinf(mass[f])) system.row(f).setZero();
      const double inertia = std::isinf(mass[f]) ? 1 : mass[f];
      system(f, f) += inertia, system(f, freedoms) -= inertia * ((*motion)[f] - start[f]);
    }
    const ColumnVector<freedoms> change =
        system.template leftCols<freedoms>().partialPivLu().solve(system.col(freedoms));
    double changed = 0, moving = 0;  // twice kinetic energies
    for (int f = 0; f < freedoms; ++f) {
      if (std::isinf(mass[f])) continue;
      (*motion)[f] += (iteration < slower ? 1 : 0.5) * change[f];
      changed += mass[f] * change[f] * change[f];
      moving += mass[f] * ((*motion)[f] * (*motion)[f] + start[f] * start[f]);
    }
    if (changed <= negligible * negligible * moving) break;
  }
  PetscFunctionReturn(0);
}

/// Gives the node of a contact its impulse from a body that moves with `motion`, which it returns in the freedoms of
/// the body.
template <int dim>
auto RigidBodies<dim>::exchange(size_t contact, const Step &step, const Freedoms &motion, Vec<dim> *v) -> Freedoms {
  Contact &c = contacts_[contact];
  const Meeting &m = meetings_[contact];
  const Response r = respond(contact, step, motion);
  c.impulse = r.impulse, c.presses = r.presses, c.sticks = r.sticks, c.force = r.most / step.gamma;
  const bool gathers = c.memory.gathers(step.bases.friction_delay());
  c.memory.pass(step.gamma, r.presses, gathers ? r.capacity : (1 - m.share) * r.capacity);
  map<dim>(v[c.at]) -= m.mobility * map<dim>(r.impulse);
  Freedoms received;
  map<freedoms>(received) = arm(bodies_[c.body], step.grid.position[c.at]).transpose() * map<dim>(r.impulse);
  return received;
}

/// Gives the nodes their impulses from a body that moves with `motion`, and the body theirs. Collective for a body that
/// moves freely.
template <int dim>
PetscErrorCode RigidBodies<dim>::apply(int b, const Step &step, const Freedoms &motion, Vec<dim> *v) {
  PetscFunctionBeginUser;
  Moving &body = bodies_[b];
  Freedoms received{};
  for (size_t k = first_contact(b); k < first_contact(b + 1); ++k) {
    const Freedoms one = exchange(k, step, motion, v);
    if (meetings_[k].counted) map<freedoms>(received) += map<freedoms>(one);
  }
  map<freedoms>(impulse_[b]) += map<freedoms>(received);
  if (sources_[b].is_free())
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, received.data(), freedoms, MPI_DOUBLE, MPI_SUM, mesh_.comm()));
  const Freedoms before = body.velocity;
  body.velocity = predicted(b, step.t, step.gamma);
  for (int f = 0; f < freedoms; ++f)
    if (!std::isinf(body.mass[f])) body.velocity[f] += received[f] / body.mass[f];
  for (size_t k = first_contact(b); k < first_contact(b + 1); ++k) {
    Contact &c = contacts_[k];
    c.with = velocity_at(body, body.velocity, step.grid.position[c.at]);
    c.gained = difference<dim>(c.with, velocity_at(body, before, step.grid.position[c.at]));
    c.follows = dot<dim>(c.with, c.normal) + meetings_[k].closing;
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode RigidBodies<dim>::resolve(const Step &step, Vec<dim> *v) {
  PetscFunctionBeginUser;
  if (search_due()) PetscCall(search(step.grid));
  resolved_step_ = step.gamma;
  meetings_.resize(contacts_.size());
  for (int b = 0; b < static_cast<int>(bodies_.size()); ++b) {
    for (size_t k = first_contact(b); k < first_contact(b + 1); ++k) {
      contacts_[k].held = held_at(contacts_[k].at, step);
      meetings_[k] = meeting(contacts_[k], step, v);
    }
    Freedoms motion = predicted(b, step.t, step.gamma);
    if (sources_[b].is_free()) PetscCall(solve(b, step, &motion));
    PetscCall(apply(b, step, motion, v));
  }
  PetscFunctionReturn(0);
}

/// Impulses do their work on the velocity by which places move: where it leaves a body that presses, energy would be
/// created.
template <int dim>
void RigidBodies<dim>::follow(Vec<dim> *w) const {
  for (const Contact &c : contacts_) {
    Vec<dim> &of_node = w[c.at], way = c.normal;
    c.held.take_from(way);
    const double into = dot<dim>(of_node, c.normal) - c.follows, gives = dot<dim>(way, c.normal);
    if ((into > 0 || c.presses) && gives > stiff) add_scaled<dim>(of_node, -into / gives, way);
    if (!c.sticks) continue;
    Vec<dim> slip = difference<dim>(of_node, c.with);
    add_scaled<dim>(slip, -dot<dim>(slip, c.normal), c.normal), c.held.take_from(slip);
    add_scaled<dim>(of_node, -1, slip);
  }
}

template <int dim>
void RigidBodies<dim>::project(const Vec<dim> *v, Vec<dim> *force) const {
  for (const Contact &c : contacts_) {
    const int node = c.at;
    const double into = dot<dim>(force[node], c.normal);
    Vec<dim> slip = difference<dim>(v[node], c.with);
    add_scaled<dim>(slip, -dot<dim>(slip, c.normal), c.normal);
    const double speed = std::sqrt(dot<dim>(slip, slip));
    if (c.sticks)
      force[node] = {}, add_scaled<dim>(force[node], into, c.normal);
    else if (speed > 0)
      add_scaled<dim>(force[node], -c.force / speed, slip);
    if (c.presses && into > 0) add_scaled<dim>(force[node], -into, c.normal);
  }
}

template <int dim>
void RigidBodies<dim>::advance(const Vec<dim> *u, double *work) {
  for (size_t k = 0; k < contacts_.size(); ++k) {
    const Contact &c = contacts_[k];
    if (!meetings_[k].counted) continue;
    Vec<dim> mean{};  // velocity in the step, of which the displacement has that at its end
    add_scaled<dim>(mean, 1 / resolved_step_, u[c.at]), add_scaled<dim>(mean, -0.5, c.gained);
    work[c.body] -= dot<dim>(c.impulse, mean);
  }
  for (Moving &body : bodies_) map<freedoms>(body.place) += resolved_step_ * map<freedoms>(body.velocity);
}

// ---- results ----

template <int dim>
PetscErrorCode RigidBodies<dim>::take_reports(std::vector<Report> &reports) {
  PetscFunctionBeginUser;
  std::vector<Freedoms> sums = impulse_;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()) * freedoms, MPI_DOUBLE, MPI_SUM,
                             mesh_.comm()));
  reports.clear();
  for (size_t b = 0; b < bodies_.size(); ++b) reports.push_back({bodies_[b].place, bodies_[b].velocity, sums[b]});
  std::fill(impulse_.begin(), impulse_.end(), Freedoms{});
  PetscFunctionReturn(0);
}

template <int dim>
void RigidBodies<dim>::serialize(Archive &archive, const FilledGrid<dim> &grid) {
  for (Moving &body : bodies_) archive.serialize("rigid body", body.place, body.velocity, body.searched);
  archive.serialize("search of rigid bodies", searched_, resolved_step_);
  archive.sums("impulses on rigid bodies", impulse_);
  std::vector<long long> nodes;
  for (const Contact &c : contacts_) nodes.push_back(c.global);
  archive.column(archive.rows("nodes of rigid bodies", Belongs::to_points, nodes), "contacts of rigid bodies",
                 contacts_);
  if (!archive.reading()) return;
  contacts_.resize(nodes.size());
  const LocalNumbers node_of(mesh_.global_node);
  for (Contact &c : contacts_) c.node = node_of(c.global), c.at = grid.find_node(c.node);
  std::sort(contacts_.begin(), contacts_.end(),
            [](const Contact &a, const Contact &b) { return std::tie(a.body, a.global) < std::tie(b.body, b.global); });
}

template class RigidBodies<2>;
template class RigidBodies<3>;

}  // namespace talus
