#pragma once
/// The action of boundaries on the pore fluids, docs/theory/pores.md section 5, as their kinds state it (kind.h). Walls
/// let no fluid pass, faces have a pressure or a flux beyond them. Everywhere else the atmosphere acts on the surface
/// of the soil, where that is now: the sum of w grad N at a node is the area vector of the surface there. Where it is
/// small there is a gap between particles: the pressure beyond it is that of the neighbouring cells. The group name
/// `free_surface` in a scene stands for the surface of the soil; a wall there stops the liquid alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "physics/boundary/conditions.h"
#include "physics/boundary/flow_limits.h"
#include "physics/boundary/node_normals.h"
#include "physics/boundary/prescribed_directions.h"

namespace talus {

inline constexpr const char *free_surface = "free_surface";

/// The liquid at a node, for boundaries that limit its flux.
struct LiquidAtNode {
  double mass, volume;  ///< m_l [kg], V [m3]
};

template <int dim>
class PoreConditions {
 public:
  using Source = NamedBoundary;
  /// `sealed`: the surface of the soil, where no boundary acts on it, lets water out and not in. `upward`: unit vector
  /// against gravity. Collective.
  PetscErrorCode setup(const BackgroundMesh<dim> &mesh, const std::vector<Source> &sources, bool sealed, int vertical,
                       const Vec<dim> &upward);
  /// Gravity along which the pressure of still water grows. Behind tied sides the same ground comes again, and what
  /// would push water through them makes it flow.
  Vec<dim> filling_gravity(Vec<dim> gravity) const {
    for (const Vec<dim> &n : through_) add_scaled<dim>(gravity, -dot<dim>(gravity, n), n);
    return gravity;
  }
  /// Is there open water on the free surface, so that `begin` needs its moments?
  bool open_water() const { return rain_ != atmosphere && (*sources_)[rain_].kind.open_water; }
  /// Does a boundary let water pass one way only?
  bool limits_one_side() const {
    return sealed_ || std::ranges::any_of(*sources_, [](const Source &source) {
             return source.kind.water == OnWater::outflow || source.kind.water == OnWater::seepage;
           });
  }
  /// Picks nodes and faces of the filled grid; `surface` [node] is the sum of w grad N over all cells [m2], `moment`
  /// [node] that area's first moment in depth below the node [m3], theory (5.2), which only open water asks for.
  /// Collective.
  PetscErrorCode begin(FilledGrid<dim> &grid, const std::vector<double> &filling, const std::vector<Vec<dim>> &surface,
                       const std::vector<Vec<dim>> &moment);

  /// Calls put(node, P, push, load) for every face with a pressure P beyond it [Pa]: `push` is the force of that
  /// pressure on the node, positive along the outer normal, and `load` the part of it that the skeleton bears [N].
  template <class Put>
  void pressures(double t, const FilledGrid<dim> &grid, double unit_weight, Put &&put) const {
    for (const Face &f : faces_) {
      if (f.source < 0) continue;
      const Boundary &kind = (*sources_)[f.source].kind;
      if (!kind.outside) continue;
      const Vec<dim> &x = grid.position[f.node];
      const double p = kind.outside(x[0], x[1], dim == 3 ? x[dim - 1] : 0, t, {unit_weight, x[vertical_]});
      const double growth = kind.open_water && p > 0 ? unit_weight : 0;
      Vec<dim> push, load{};
      for (int d = 0; d < dim; ++d) push[d] = p * f.area[d] + growth * f.moment[d];
      if (kind.open_water) load = push;
      put(f.node, p, push, load);
    }
  }
  /// Calls put(node, P, area) for every face with a prescribed gas pressure P beyond it [Pa]. Beyond the others is the
  /// atmosphere.
  template <class Put>
  void gas_pressures(double t, const FilledGrid<dim> &grid, Put &&put) const {
    for (const Face &f : faces_) {
      if (f.source < 0) continue;
      const Vec<dim> &x = grid.position[f.node];
      if (const auto &pressure = (*sources_)[f.source].kind.gas_outside)
        put(f.node, pressure(x[0], x[1], dim == 3 ? x[dim - 1] : 0, t), f.area);
    }
  }
  /// Calls put(node, area) for every gap: `area` is the sum of w grad N now, `surface(node)`, without the parts of
  /// named faces and walls [m2].
  template <class Surface, class Put>
  void gaps(const FilledGrid<dim> &grid, Surface &&surface, Put &&put) const {
    for (const int node : gaps_) put(node, open_area(grid, node, surface(node)));
  }
  /// Has the node a face, named or where the soil's surface is now?
  bool at_surface(int node) const { return face_of_node_[node] >= 0; }
  /// (gap node, cell, number of the node in it) of all cells of this rank at gaps.
  const std::vector<std::array<int, 3>> &gap_cells() const { return gap_cells_; }
  /// Calls hold(node, limits) for every node with faces whose outflow has limits, or with walls that let no fluid pass:
  /// first the limits of faces, which are those of the liquid alone, and then the normals of walls, which are
  /// orthonormal. `liquid_at(node)` is LiquidAtNode; `density` that of the liquid beyond [kg/m3].
  template <class At, class Hold>
  void limits(double t, const FilledGrid<dim> &grid, double density, double unit_weight, At &&liquid_at,
              Hold &&hold) const {
    FlowLimits<dim> limits;
    const auto hold_all = [&](int node) {
      walls_at(grid, node, [&](const Vec<dim> &n) {
        if (!pumped(node, n)) limits.add({n, 0, 0, true});
      });
      if (limits.count > 0) hold(node, limits);
      limits.count = 0;
    };
    for (std::size_t last = 0; last < faces_.size(); ++last) {
      const int node = faces_[last].node;
      if (face_of_node_[node] != static_cast<int>(last)) continue;
      limits_of_faces(t, grid, density, unit_weight, liquid_at, node, limits);
      hold_all(node);
    }
    for (const int node : walls_alone_) hold_all(node);
  }
  /// Calls along(n, all) for orthonormal directions in which boundaries fix how fluids at a node move against the
  /// skeleton: all of them along normals of walls, and only the liquid along those of faces with a flux and of a
  /// surface of the soil that is sealed.
  template <class Put>
  void fixed_at(const FilledGrid<dim> &grid, int node, Put &&along) const {
    each_pump(node, [&](const Face &f) { along(f.direction, false); });
    walls_at(grid, node, [&](const Vec<dim> &n) {
      if (!pumped(node, n)) along(n, true);
    });
  }
  /// Calls wall(n) for the normals of walls at one node.
  template <class Put>
  void walls_at(const FilledGrid<dim> &grid, int node, Put &&wall) const {
    const int index = wall_of_node_[grid.mesh_node[node]];
    for (int k = 0; index >= 0 && k < walls_[index].count; ++k) wall(walls_[index].direction[k]);
  }

 private:
  static constexpr int atmosphere = -1;
  using Wall = PrescribedDirections<dim>;
  static constexpr double none = -1e300;  ///< no limit
  /// Volume of liquid that leaves per area and time.
  struct Outflow {
    double least = none, most = -none;
  };
  struct Face {
    int node, source;               ///< compact; a source or the atmosphere
    int further;                    ///< an earlier face of the node, -1: none
    Vec<dim> area, normal, moment;  ///< moment: of the area, in depth below the node [m3]
    double length = 0;              ///< of `area` [m2]
    double spread = 1;              ///< sum of the areas of its facets over the length of their sum
    int leads = -1, next = -1;      ///< an earlier face of the node in the same plane; another one that this one leads
    /// Of a face that leads one which prescribes the flux, or prescribes it itself: the part of the normal across those
    /// of walls and of such faces before it, as a unit vector, and its length, 0 where they leave nothing to prescribe;
    /// and the area of walls in its plane [m2].
    Vec<dim> direction{};
    double across = 0, wall = 0;
  };
  /// The share of a node in a facet of a boundary.
  struct Corner {
    int cell, node;  ///< of the mesh
    Vec<dim> normal;
    double area, depth;  ///< of the facet; sum of the depths of its other nodes below this one [m]
  };
  /// Corners of a boundary, of which those at one node make one face there.
  struct Corners {
    int source;
    std::vector<Corner> corners;
  };
  struct NamedFace {
    Vec<dim> area, moment;
    double facets;  ///< sum of their areas [m2], 0: none
  };
  PetscErrorCode set_corners(const BackgroundMesh<dim> &mesh, const std::vector<SourceFacets<dim>> &faces);
  void add_face(int node, int source, const NamedFace &face);
  void relate_faces(const FilledGrid<dim> &grid, const std::vector<Vec<dim>> &surface);
  bool prescribes(int source) const {
    if (source == atmosphere) return false;
    const OnWater water = (*sources_)[source].kind.water;
    return water == OnWater::flux || water == OnWater::wall;
  }
  static bool same_side(const Vec<dim> &a, const Vec<dim> &b) { return dot<dim>(a, b) > same_direction; }
  /// A wall inside the mesh stops fluids on both of its sides, and its normal may be that of either.
  static bool in_plane_of_wall(const Vec<dim> &a, const Vec<dim> &wall) {
    return std::abs(dot<dim>(a, wall)) > same_direction;
  }
  /// Calls use(face) for the faces of a node that prescribe the flux, the last one first.
  template <class Use>
  void each_pump(int node, Use &&use) const {
    for (int f = face_of_node_[node]; f >= 0; f = faces_[f].further)
      if (faces_[f].across > 0) use(faces_[f]);
  }
  /// Calls use(face) for a face that leads and for those of its plane that it leads.
  template <class Use>
  void each_in_plane(const Face &f, Use &&use) const {
    for (const Face *g = &f; g; g = g->next >= 0 ? &faces_[g->next] : nullptr) use(*g);
  }
  /// Does a face that prescribes the flux lie in the plane of a wall with the normal n?
  bool pumped(int node, const Vec<dim> &n) const {
    bool any = false;
    each_pump(node, [&](const Face &f) { any |= in_plane_of_wall(f.normal, n); });
    return any;
  }
  Outflow outflow_of(double t, const FilledGrid<dim> &grid, const Face &f, double unit_weight) const {
    if (f.source == atmosphere) return {sealed_ ? 0 : none};
    const Vec<dim> &x = grid.position[f.node];
    const double z = dim == 3 ? x[dim - 1] : 0;
    const Boundary &kind = (*sources_)[f.source].kind;
    if (kind.water == OnWater::outflow) return {0};
    if (kind.water == OnWater::wall) return {0, 0};
    if (kind.water == OnWater::flux) {
      const double out = -f.spread * kind.inflow(x[0], x[1], z, t);
      return {out, out};
    }
    if (kind.water == OnWater::seepage && kind.outside(x[0], x[1], z, t, {unit_weight, x[vertical_]}) <= 0)
      return {-kind.supply(x[0], x[1], z, t, dot<dim>(f.normal, upward_))};
    return {};
  }
  /// Faces of a node in one plane share its velocity: what leaves by all of them together has the sum of their limits.
  /// Beside a face without a limit each keeps its own.
  Outflow outflow_in_plane(double t, const FilledGrid<dim> &grid, const Face &f, double unit_weight) const {
    if (f.next < 0) return outflow_of(t, grid, f, unit_weight);
    double area = 0, sum = 0, tightest = none;
    bool all = true;
    each_in_plane(f, [&](const Face &g) {
      const double least = outflow_of(t, grid, g, unit_weight).least;
      all &= least > none, area += g.length, sum += g.length * least, tightest = std::max(tightest, least);
    });
    return {all ? sum / area : tightest};
  }
  /// Of the plane of a face where a flux is prescribed: nothing passes by its walls and its faces without a flux. It
  /// leaves along the direction of the face, so that this much leaves along its normal, whatever faces before it
  /// prescribe.
  double outflow_of_pumps(double t, const FilledGrid<dim> &grid, const Face &f) const {
    double volume = 0, area = f.wall;
    each_in_plane(f, [&](const Face &g) {
      area += g.length;
      if (prescribes(g.source)) volume += g.length * outflow_of(t, grid, g, 0).least;
    });
    double out = volume / area;
    for (int before = f.further; before >= 0; before = faces_[before].further) {
      const Face &g = faces_[before];
      if (g.across > 0) out -= dot<dim>(f.normal, g.direction) * outflow_of_pumps(t, grid, g);
    }
    return out / f.across;
  }
  /// The limits of the faces of a node, the earliest first.
  template <class At>
  void limits_of_faces(double t, const FilledGrid<dim> &grid, double density, double unit_weight, At &&liquid_at,
                       int node, FlowLimits<dim> &limits) const {
    const LiquidAtNode at = liquid_at(node);
    const double scale = at.mass > 0 ? density * at.volume / at.mass : 0;
    for (int index = face_of_node_[node]; index >= 0; index = faces_[index].further) {
      const Face &f = faces_[index];
      if (f.leads >= 0) continue;
      Vec<dim> n = f.across > 0 ? f.direction : f.normal;
      Outflow out;
      if (f.across > 0)
        out.least = out.most = outflow_of_pumps(t, grid, f);
      else
        out = outflow_in_plane(t, grid, f, unit_weight);
      if (out.least == none) continue;
      if (f.across == 0) {  // with what is prescribed, only the rest of the normal is free
        each_pump(f.node, [&](const Face &g) {
          const double part = dot<dim>(f.normal, g.direction);
          out.least -= part * outflow_of_pumps(t, grid, g), add_scaled<dim>(n, -part, g.direction);
        });
        const double rest = std::sqrt(dot<dim>(n, n));
        if (rest < least_angle_sine) continue;
        for (double &x : n) x /= rest;
        out.least /= rest;
      }
      limits.add({n, out.least * scale, out.most * scale, false});
    }
    std::reverse(limits.all.begin(), limits.all.begin() + limits.count);
  }
  Vec<dim> open_area(const FilledGrid<dim> &grid, int node, const Vec<dim> &surface) const {
    return open_part(grid, node, surface, taken_[node]);
  }
  Vec<dim> open_part(const FilledGrid<dim> &grid, int node, const Vec<dim> &whole, const Vec<dim> &taken) const;

  const std::vector<Source> *sources_ = nullptr;
  bool sealed_ = false;
  int vertical_ = 1;  ///< component of a place that is its elevation
  Vec<dim> upward_{};
  int rain_ = atmosphere;          ///< what acts on the free surface
  std::vector<Vec<dim>> through_;  ///< normals of tied sides, the same on all ranks
  std::vector<int> wall_of_node_;
  std::vector<Wall> walls_;
  std::vector<Corners> named_;    ///< the same sources on all ranks
  std::vector<int> walls_alone_;  ///< nodes with a wall and without a face
  std::vector<Face> faces_;
  std::vector<int> gaps_;
  std::vector<std::array<int, 3>> gap_cells_;
  std::vector<char> at_gap_;
  std::vector<int> face_of_node_;  ///< the last one; -1: none
  std::vector<NamedFace> nodal_;
  std::vector<Vec<dim>> taken_, taken_moment_;
};

}  // namespace talus
