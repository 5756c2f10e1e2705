#include "solvers/quasi_static/base_contact.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/gather.h"
#include "physics/boundary/node_normals.h"
#include "physics/laws/update_stress.h"

namespace talus {
namespace {

// Stiffness of the springs over that of the elements on the base: soil sinks into the base by a hundredth of what the
// elements on it are compressed, and sticks with a hundredth of their shear.
constexpr double stiffer = 100;

/// A facet of a base at one of its nodes, as ranks tell each other.
template <int dim>
struct Touch {
  PetscInt global;
  int source;
  Vec<dim> normal;
  double area, stiffness, size;
  std::array<Vec<dim>, 2> ends;
  auto key() const { return std::make_tuple(global, source, normal, area, stiffness); }
};

}  // namespace

template <int dim>
BaseForce<dim> force_at_given_friction(const Vec<dim> &spring, const Vec<dim> &normal, double most) {
  const ColumnVector<dim> s = map<dim>(spring), n = map<dim>(normal);
  const double pressing = s.dot(n);
  const ColumnVector<dim> along = s - pressing * n;
  const double shear = along.norm();
  BaseForce<dim> f;
  f.presses = pressing >= 0, f.slides = shear > most;
  const double borne = f.slides ? most / shear : 1;  // of the shear
  const ColumnVector<dim> t = f.slides ? ColumnVector<dim>(along / shear) : ColumnVector<dim>::Zero();
  const Square<dim> of_normal = n * n.transpose();
  map<dim>(f.borne) = std::max(0., pressing) * n + borne * along;
  f.tangent = borne * (Square<dim>::Identity() - of_normal - t * t.transpose());
  if (f.presses) f.tangent += of_normal;
  return f;
}

/// Adhesion comes with the force that presses, along a steep line: at once, it would make the force of soil that is
/// about to lift off jump, and iterations go to and fro there.
template <int dim>
BaseForce<dim> force_on_base(const Vec<dim> &spring, const Vec<dim> &normal, double friction, double adhesion) {
  constexpr double steep = 3;  // most shear over normal force: with 10, soil that leans on a base wedges itself
  const ColumnVector<dim> s = map<dim>(spring), n = map<dim>(normal);
  const double pressing = s.dot(n);
  if (pressing < 0) return {{}, Square<dim>::Zero(), false, false};
  const double full = friction * pressing + adhesion, most = std::min(full, std::max(steep, friction) * pressing);
  const double rise = most < full ? std::max(steep, friction) : friction;
  BaseForce<dim> f = force_at_given_friction<dim>(spring, normal, most);
  if (f.slides) f.tangent += rise * (s - pressing * n).normalized() * n.transpose();
  return f;
}

template <int dim>
PetscErrorCode BaseContact<dim>::find_normals() {
  PetscFunctionBeginUser;
  std::vector<SourceFacets<dim>> bases;
  for (int s = 0; s < static_cast<int>(sources_.size()); ++s)
    if (sources_[s].kind.quasi_static == OnSoil::contact)
      for (const std::string &group : sources_[s].groups) bases.push_back({s, soil_.mesh().facets(group)});
  std::vector<NodeNormal<dim>> found;
  PetscCall(find_node_normals(soil_.mesh(), bases, found));
  for (const NodeNormal<dim> &n : found) normals_[{n.source, n.node}].push_back(n.normal);
  knows_normals_ = true;  // on ranks without a base too
  PetscFunctionReturn(0);
}

/// That of the patch to which the facet belongs.
template <int dim>
Vec<dim> BaseContact<dim>::normal_at(int source, const Facet<dim> &facet, int mesh_node) const {
  const std::vector<Vec<dim>> &of_patches = normals_.at({source, mesh_node});
  return *std::max_element(of_patches.begin(), of_patches.end(), [&facet](const Vec<dim> &a, const Vec<dim> &b) {
    return dot<dim>(a, facet.normal) < dot<dim>(b, facet.normal);
  });
}

template <int dim>
PetscErrorCode BaseContact<dim>::activate() {
  PetscFunctionBeginUser;
  if (!knows_normals_ && any()) PetscCall(find_normals());
  const BackgroundMesh<dim> &mesh = soil_.mesh();
  const ElementNodes<dim> &nodes = soil_.nodes();
  const Quadrature<dim - 1> rule = load_quadrature<dim - 1>();
  std::array<double, element_nodes<dim>(2)> shape;
  std::vector<Touch<dim>> all;
  for (int s = 0; s < static_cast<int>(sources_.size()); ++s) {
    if (sources_[s].kind.quasi_static != OnSoil::contact) continue;
    for (const std::string &group : sources_[s].groups)
      for (const Facet<dim> &facet : mesh.facets(group)) {
        if (!soil_.active(facet.cell)) continue;
        const std::vector<int> node = nodes.of_facet(facet.cell, facet.face);
        std::vector<double> share(node.size(), 0);
        for (size_t q = 0; q < rule.point.size(); ++q) {
          shape_functions<dim - 1>(nodes.order(), rule.point[q], shape.data());
          for (size_t a = 0; a < node.size(); ++a) share[a] += rule.weight[q] * shape[a];
        }
        const double height = dim * mesh.volume[facet.cell] / facet.area;
        const double modulus = constrained_modulus(soil_.points()[soil_.body_of(facet.cell)].law);
        std::array<Vec<dim>, dim> at_vertex;  // normals, in the order of the element's nodes
        for (const int mesh_node : facet.node)
          at_vertex[std::find(node.begin(), node.end(), nodes.at_vertex(mesh_node)) - node.begin()] =
              normal_at(s, facet, mesh_node);
        for (size_t a = 0; a < node.size(); ++a) {
          std::array<Vec<dim>, 2> ends{nodes.position[node[a]], nodes.position[node[a]]};
          Vec<dim> normal = a < dim ? at_vertex[a] : Vec<dim>{};
          if (a >= dim) {
            const auto [first, second] = simplex_edges<dim - 1>[a - dim];
            ends = {nodes.position[node[first]], nodes.position[node[second]]};
            map<dim>(normal) = (map<dim>(at_vertex[first]) + map<dim>(at_vertex[second])).normalized();
          }
          const double area = share[a] * facet.area;
          all.push_back({nodes.global()[node[a]], s, normal, area, area * modulus / height,
                         element_size<dim>(mesh.volume[facet.cell]), ends});
        }
      }
  }

  // a facet lies on one rank, and its node may belong to a neighbour
  PetscCall(gather_from(mesh.comm(), mesh.halo.neighbours(), all));
  std::sort(all.begin(), all.end(), [](const Touch<dim> &a, const Touch<dim> &b) { return a.key() < b.key(); });

  std::map<PetscInt, int> local;
  for (int i = 0; i < nodes.count(); ++i)
    if (nodes.owned[i]) local[nodes.global()[i]] = i;
  const std::vector<Point> before = std::exchange(points_, {});
  for (const Touch<dim> &touch : all) {
    const auto found = local.find(touch.global);
    if (found == local.end()) continue;
    const auto same = std::find_if(points_.begin(), points_.end(), [&](const Point &p) {
      return p.node == found->second && p.source == touch.source &&
             map<dim>(p.normal).dot(map<dim>(touch.normal)) > same_direction;
    });
    if (same == points_.end()) {
      points_.push_back(
          {found->second, touch.source, touch.normal, touch.area, touch.stiffness, touch.size, touch.ends});
      continue;
    }
    map<dim>(same->normal) =
        (same->area * map<dim>(same->normal) + touch.area * map<dim>(touch.normal)).normalized().eval();
    same->area += touch.area, same->stiffness += touch.stiffness, same->size = std::max(same->size, touch.size);
  }
  for (Point &p : points_)
    for (const Point &old : before)
      if (point_[old.node] == nodes.point[p.node] && old.source == p.source &&
          map<dim>(old.normal).dot(map<dim>(p.normal)) > same_direction)
        p.spring = p.trial = old.spring;
  point_ = nodes.point;
  PetscFunctionReturn(0);
}

template <int dim>
void BaseContact<dim>::set_strength(double t) {
  for (Point &p : points_) {
    const Vec<dim> &x = soil_.nodes().position[p.node];
    const Boundary &base = sources_[p.source].kind;
    const double z = dim == 3 ? x[dim - 1] : 0;
    constexpr double fresh = 0;  // slip: that of motion comes later
    p.friction = base.friction_coefficient(x[0], x[1], z, t, fresh);
    p.adhesion = p.area * base.adhesion(x[0], x[1], z, t, fresh);
  }
}

template <int dim>
void BaseContact<dim>::release() {
  for (Point &p : points_) p.spring = p.trial = {};
}

template <int dim>
BaseForce<dim> BaseContact<dim>::borne(const Point &p, const Vec<dim> &spring) const {
  if (factor_ == 0) return force_on_base<dim>(spring, p.normal, p.friction, p.adhesion);
  const double divisor = p.divisor > 0 ? p.divisor : factor_;
  return force_at_given_friction<dim>(spring, p.normal, (p.adhesion + p.friction * p.pressing) / divisor);
}

template <int dim>
PetscErrorCode BaseContact<dim>::follow_normal_forces(double *change) {
  double sums[2]{};  // of changes, and of all
  PetscFunctionBeginUser;
  for (Point &p : points_) {
    const double pressing = std::max(0., map<dim>(p.trial).dot(map<dim>(p.normal)));
    sums[0] += p.friction * std::abs(pressing - p.pressing), sums[1] += p.adhesion + p.friction * pressing;
    p.pressing = pressing;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, soil_.nodes().comm()));
  *change = sums[0] > 0 ? sums[0] / sums[1] : 0;
  PetscFunctionReturn(0);
}

template <int dim>
void BaseContact<dim>::add_trial_force(const std::vector<double> &u, std::vector<double> &force) {
  for (Point &p : points_) {
    for (int d = 0; d < dim; ++d) p.trial[d] = p.spring[d] + stiffer * p.stiffness * u[p.node * dim + d];
    const BaseForce<dim> f = borne(p, p.trial);
    for (int d = 0; d < dim; ++d) force[p.node * dim + d] += f.borne[d];
  }
}

template <int dim>
double BaseContact<dim>::until_turn(const std::vector<double> &u) const {
  double share = 1;
  for (const Point &p : points_) {
    const BaseForce<dim> f = borne(p, p.trial);
    if (!f.presses || !f.slides) continue;
    const ColumnVector<dim> n = map<dim>(p.normal);
    ColumnVector<dim> along = map<dim>(p.trial), way;
    for (int d = 0; d < dim; ++d) way[d] = stiffer * p.stiffness * u[p.node * dim + d];
    along -= along.dot(n) * n, way -= way.dot(n) * n;
    const double forth = along.squaredNorm(), change = along.dot(way);
    if (change < -forth) share = std::min(share, -forth / change);
  }
  return share;
}

template <int dim>
void BaseContact<dim>::add_force(std::vector<double> &force, std::vector<Vec<dim>> *of_source) const {
  for (const Point &p : points_) {
    const double pressing = map<dim>(p.spring).dot(map<dim>(p.normal));
    for (int d = 0; d < dim; ++d) {
      const double f = p.spring[d] - std::min(0., pressing) * p.normal[d];
      force[p.node * dim + d] += f;
      if (of_source) (*of_source)[p.source][d] -= f;
    }
  }
}

template <int dim>
void BaseContact<dim>::add_work(const std::vector<double> &u, double share, std::vector<double> &of_source) const {
  for (const Point &p : points_) {
    const double pressing = map<dim>(p.spring).dot(map<dim>(p.normal));
    for (int d = 0; d < dim; ++d)
      of_source[p.source] -= share * (p.spring[d] - std::min(0., pressing) * p.normal[d]) * u[p.node * dim + d];
  }
}

template <int dim>
PetscErrorCode BaseContact<dim>::each_stiffness(double plastic, double elastic, const Put &put) const {
  PetscFunctionBeginUser;
  typename SoilElements<dim>::Stiffness block;
  for (const Point &p : points_) {
    block = p.stiffness * (plastic * stiffer * borne(p, p.trial).tangent + elastic * Square<dim>::Identity());
    PetscCall(put(&p.node, 1, block));
  }
  PetscFunctionReturn(0);
}

template <int dim>
void BaseContact<dim>::commit(const std::vector<double> &u) {
  for (Point &p : points_) {
    for (int d = 0; d < dim; ++d) p.trial[d] = p.spring[d] + stiffer * p.stiffness * u[p.node * dim + d];
    const BaseForce<dim> f = borne(p, p.trial);
    const double opening = f.presses ? 0 : std::min(0., map<dim>(p.trial).dot(map<dim>(p.normal)));
    for (int d = 0; d < dim; ++d) p.spring[d] = f.borne[d] + opening * p.normal[d];
  }
}

template <int dim>
typename BaseContact<dim>::State BaseContact<dim>::save() const {
  State state;
  for (const Point &p : points_) state.push_back(p.spring);
  return state;
}

template <int dim>
void BaseContact<dim>::restore(const State &state) {
  for (size_t k = 0; k < points_.size(); ++k) points_[k].spring = points_[k].trial = state[k];
}

/// The points at a node, which are on the rank that owns it, are in the same order on any partition.
template <int dim>
void BaseContact<dim>::serialize(Archive &archive) {
  const ElementNodes<dim> &nodes = soil_.nodes();
  State state = save();
  std::vector<long long> of;
  for (const Point &p : points_) of.push_back(nodes.number[p.node]);
  std::vector<long long> stored = of;
  archive.column(archive.rows("nodes of springs", Belongs::to_points, stored), "springs", state);
  if (!archive.reading()) return;
  std::map<long long, std::vector<size_t>> rows;
  for (size_t k = 0; k < stored.size(); ++k) rows[stored[k]].push_back(k);
  State mine;
  std::map<long long, size_t> met;
  for (const long long node : of) {
    const std::vector<size_t> &of_node = rows[node];
    const size_t place = met[node]++;
    mine.push_back(place < of_node.size() ? state[of_node[place]] : Vec<dim>{});
  }
  restore(mine);
}

template <int dim>
void BaseContact<dim>::confine(const std::function<bool(const Vec<dim> &, double)> &divided) {
  for (Point &p : points_) p.divisor = divided(soil_.nodes().position[p.node], p.size) ? 0 : 1;
}

template <int dim>
PetscErrorCode BaseContact<dim>::hold(const CellSet &cells, double divisor) {
  PetscFunctionBeginUser;
  const ElementNodes<dim> &nodes = soil_.nodes();
  std::vector<PetscInt> held(nodes.count(), 0);
  for (size_t c = 0; c < cells.size(); ++c)
    for (int a = 0; cells[c] && a < element_nodes<dim>(nodes.order()); ++a)
      held[nodes.of_cell(static_cast<int>(c))[a]] = 1;
  PetscCall(nodes.maximum(held));
  for (Point &p : points_)
    if (held[p.node]) p.divisor = divisor;
  PetscFunctionReturn(0);
}

template <int dim>
void BaseContact<dim>::let_go() {
  factor_ = 0;
  for (Point &p : points_) p.divisor = 0;
}

template <int dim>
std::vector<typename BaseContact<dim>::NormalForce> BaseContact<dim>::normal_forces() const {
  std::vector<NormalForce> forces;
  for (const Point &p : points_)
    if (const double pressing = map<dim>(p.spring).dot(map<dim>(p.normal)); pressing > 0)
      for (const Vec<dim> &end : p.ends) forces.push_back({p.source, end, p.normal, pressing / 2});
  return forces;
}

template BaseForce<2> force_at_given_friction<2>(const Vec<2> &, const Vec<2> &, double);
template BaseForce<3> force_at_given_friction<3>(const Vec<3> &, const Vec<3> &, double);
template BaseForce<2> force_on_base<2>(const Vec<2> &, const Vec<2> &, double, double);
template BaseForce<3> force_on_base<3>(const Vec<3> &, const Vec<3> &, double, double);
template class BaseContact<2>;
template class BaseContact<3>;

}  // namespace talus
