#pragma once
/// Contact of the finite elements with the rigid bases of a scene, docs/theory/finite_elements.md section 2.1: soil
/// that does not enter the base, may lift off it, and slides against Coulomb friction and adhesion without dilating.
/// Each patch of a base at a node is a constraint of its own, with the normal that it has in motion
/// (physics/boundary/node_normals.h). Stiff springs between soil and base
/// carry the force; what friction cannot bear of it is taken off.
#include <map>
#include <utility>
#include <vector>

#include "base/archive.h"
#include "physics/boundary/conditions.h"
#include "solvers/quasi_static/moving_soil.h"
#include "solvers/quasi_static/soil_elements.h"

namespace talus {

/// What a base bears of the force `spring` that springs without strength would carry [N]. Components along the outward
/// normal `n` are positive where soil presses on the base; a negative one is the opening times the stiffness.
template <int dim>
struct BaseForce {
  Vec<dim> borne;        ///< [N]
  Square<dim> tangent;   ///< its derivative by `spring` [-]
  bool presses, slides;  ///< in contact; at the limit of friction
};

/// Coulomb's law. `friction` is the tangent of the friction angle, `adhesion` the force that the base bears along
/// itself beside friction [N], though no more with it than three times the normal force. Slip leaves the normal force
/// as it is, and a base that nothing presses on bears nothing.
template <int dim>
BaseForce<dim> force_on_base(const Vec<dim> &spring, const Vec<dim> &n, double friction, double adhesion);
/// The same with a friction of `most` [N] whatever presses on the base, as in the trials of a factor of safety: the
/// closest of the admissible forces, which has an energy.
template <int dim>
BaseForce<dim> force_at_given_friction(const Vec<dim> &spring, const Vec<dim> &n, double most);

template <int dim>
class BaseContact {
 public:
  using Source = NamedBoundary;
  using NormalForce = typename RigidBases<dim>::NormalForce;
  using State = std::vector<Vec<dim>>;  ///< forces of the springs at the last converged state [N]
  using Put = std::function<PetscErrorCode(const int *node, int count, typename SoilElements<dim>::Stiffness &)>;
  /// The references must outlive it.
  BaseContact(const SoilElements<dim> &soil, const std::vector<Source> &sources) : soil_(soil), sources_(sources) {}

  /// Finds the faces of the soil that is active now which touch a base. Faces that were there keep their force.
  /// Collective.
  PetscErrorCode activate();
  /// Has the scene a base, whether or not soil touches it now?
  bool any() const {
    return std::any_of(sources_.begin(), sources_.end(),
                       [](const Source &source) { return source.kind.quasi_static == OnSoil::contact; });
  }
  /// Friction and adhesion are those at time t from now on.
  void set_strength(double t);
  /// Soil and base have no force between them any more, as where soil comes from a motion that knows no springs.
  void release();

  /// Adds the forces of the soil on the base to those of local nodes, after nodal increments `u` of the last converged
  /// state, on the rank that owns the node [N].
  void add_trial_force(const std::vector<double> &u, std::vector<double> &force);
  /// The largest share of nodal increments `u` of the trial state, up to 1, after which the slip of no point of this
  /// rank has turned by more than a right angle.
  double until_turn(const std::vector<double> &u) const;
  /// The same at the last converged state; `of_source`, if given, receives the force of each boundary on the soil.
  void add_force(std::vector<double> &force, std::vector<Vec<dim>> *of_source = nullptr) const;
  /// Adds to the work of each boundary on the soil what the forces of the last converged state, times `share`, do on
  /// the nodal increments `u` [J].
  void add_work(const std::vector<double> &u, double share, std::vector<double> &of_source) const;
  /// Calls put(node, 1, stiffness): `plastic` times that at the trial state plus `elastic` times that of a layer
  /// between soil and base as stiff as the elements upon it.
  PetscErrorCode each_stiffness(double plastic, double elastic, const Put &put) const;
  /// Accepts the trial state that `u` leads to.
  void commit(const std::vector<double> &u);

  State save() const;
  void restore(const State &state);
  void serialize(Archive &archive);  ///< the same in a checkpoint

  /// From now on friction and adhesion are divided by `factor`, for trials of a factor of safety, and friction is that
  /// of given normal forces; 0: the base is as the scene says.
  void set_trial(double factor) { factor_ = factor; }
  /// The normal forces of the trial state give the friction of trials from now on. `change`: by how much that changes
  /// the friction of all bases, over this friction [-]. Collective.
  PetscErrorCode follow_normal_forces(double *change);
  /// Trials divide the strength of the base only where `divided(place, element size)`.
  void confine(const std::function<bool(const Vec<dim> &, double)> &divided);
  /// Trials divide it under these cells by `divisor`. Collective.
  PetscErrorCode hold(const CellSet &cells, double divisor);
  /// All of it is divided by the factor of the trial again.
  void let_go();

  /// Calls visit(node, direction) for the directions in which a base may hold the nodes of this rank: the normal, and
  /// along a base with strength all.
  template <class Visit>
  void each_hold(Visit &&visit) const {
    for (const Point &p : points_)
      if (p.friction > 0 || p.adhesion > 0)
        for (int d = 0; d < dim; ++d) visit(p.node, axis(d));
      else
        visit(p.node, p.normal);
  }
  /// Area of the bases under nodes of this rank that are marked, and of it what is open and what slips at the trial
  /// state [m2].
  std::array<double, 3> areas(const std::vector<char> &marked) const {
    std::array<double, 3> sums{};
    for (const Point &p : points_) {
      if (!marked[p.node]) continue;
      const BaseForce<dim> f = borne(p, p.trial);
      sums[0] += p.area, sums[1] += f.presses ? 0 : p.area, sums[2] += f.presses && f.slides ? p.area : 0;
    }
    return sums;
  }
  /// Forces of this rank's soil on the bases at the vertices of the mesh; those of middles of edges go to their ends.
  std::vector<NormalForce> normal_forces() const;

 private:
  struct Point {  ///< one patch of a base at a node that this rank owns
    int node, source;
    Vec<dim> normal;
    double area;                        ///< [m2]
    double stiffness;                   ///< of the soil upon it, area times constrained modulus over height [N/m]
    double size;                        ///< largest element on it [m]
    std::array<Vec<dim>, 2> ends;       ///< of the edge whose middle the node is; else the node twice
    Vec<dim> spring{}, trial{};         ///< at the last converged state and at the trial one [N]
    double friction = 0, adhesion = 0;  ///< at the loads: tan phi_b [-], force [N]
    double divisor = 0;                 ///< in trials; 0: that of the trial
    double pressing = 0;                ///< normal force that gives the friction of trials [N]
  };
  static Vec<dim> axis(int d) {
    Vec<dim> unit{};
    unit[d] = 1;
    return unit;
  }
  BaseForce<dim> borne(const Point &point, const Vec<dim> &spring) const;
  PetscErrorCode find_normals();
  Vec<dim> normal_at(int source, const Facet<dim> &facet, int mesh_node) const;

  const SoilElements<dim> &soil_;
  const std::vector<Source> &sources_;
  std::map<std::pair<int, int>, std::vector<Vec<dim>>> normals_;  ///< of the patches, by boundary and node of the mesh
  bool knows_normals_ = false;
  std::vector<Point> points_;
  std::vector<PetscInt> point_;  ///< of the DMPlex, by node, when the points were found
  double factor_ = 0;
};

}  // namespace talus
