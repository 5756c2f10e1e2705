#pragma once
/// The fluid part of the motion, docs/theory/pores.md: liquid and, in three phases, gas. Stress points of the soil are
/// pore points too: each has masses of the fluids, and its pressures are functions of these masses. SoilMotion calls,
/// in the order of a step:
///   gather -> [add_to_mixture -> find_accelerations -> apply_drag_to_solid -> apply_drag_to_fluids -> find_divergence
///   -> smooth_divergence -> change_masses -> update_pressures] ... -> write_update
/// Particles receive from the nodes and give to them in the sweeps of the soil (transfer/), between `write_update` and
/// `gather`.
#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "base/phases.h"
#include "base/room.h"
#include "physics/boundary/pore_conditions.h"
#include "physics/pores/drag.h"
#include "physics/pores/fluids.h"
#include "physics/pores/implicit_pressure.h"
#include "physics/pores/pore_report.h"
#include "physics/pores/soil_pores.h"
#include "physics/pores/storage.h"
#include "physics/prescribed_pressure.h"
#include "scene/scene.h"
#include "transfer/transfer.h"

namespace talus {

template <int dim, class Phases>
class PoreFluid {
 public:
  static constexpr int fluids = 1 + Phases::gas;
  using Array = std::vector<double>;

  PoreFluid(const BackgroundMesh<dim> &mesh, std::vector<std::unique_ptr<Body<dim>>> &bodies, const Scene &scene,
            bool implicit);

  /// Fills the pores of all particles as the scene's [water] says for time t.
  void fill(double t);
  /// Fills them to the pressures of `liquid`(cell, place) [Pa].
  void fill(const std::function<double(int, const Vec<dim> &)> &liquid);
  /// Pressure at a place by [water] [Pa]; negative above the water table where pores may dry.
  double prescribed_pressure(const Vec<dim> &x, double t) const;

  // Cells and nodes in a state of the motion, accepted or trial.
  struct Frame {
    FilledGrid<dim> &grid;
    const Shape<dim> *shape;   ///< [cell]
    const Vec<dim> *position;  ///< [node]
    const double *weight;      ///< w [cell]
    const std::vector<PointSet> &points;
    const double *const *volume;        ///< [body][point]
    const double *particle_volume;      ///< sum over the points of a cell
    const double *blend;                ///< [cell]
    Vec<dim> gravity, filling_gravity;  ///< the second is that of PoreConditions
    double time;
    bool averaged, trial;
  };

  /// The pores of the points of a body now, and those that are being gathered for the next Lagrangian part, for the
  /// sweeps of the soil.
  Pores<dim> pores(int body) { return pores_of(points_, body); }
  Pores<dim> next_pores(int body) { return pores_of(next_points_, body); }
  /// The gathered points take the place of the present ones.
  void swap_points() { std::swap(points_, next_points_); }
  /// The component of a place that is its elevation.
  int vertical() const { return scene_.vertical(); }
  Vec<dim> upward() const {  ///< against gravity
    Vec<dim> direction;
    std::copy_n(scene_.upward().begin(), dim, direction.begin());
    return direction;
  }
  /// Completes the nodes once the particles of all bodies have been added to points and cells: their pressures, the
  /// boundaries, and the velocities of the fluids, which go to `velocity` [fluids][nodes].
  PetscErrorCode gather(const Frame &frame, PoreConditions<dim> &conditions, const Array &filling,
                        const Vec<dim> *solid, Vec<dim> *velocity);
  /// Writes into `update` what particles read of the nodes before they move. `velocity` are those at the end, `start`
  /// those at the start, both [fluids][nodes]; `flip` is the share of its own velocity that a particle retains.
  void write_update(int nodes, const Vec<dim> *velocity, const Vec<dim> *start, double flip, NodalUpdate &update) const;

  /// Adds the pressure and the weight of the fluids to the forces on the mixture at the nodes.
  void add_to_mixture(const Frame &frame, const PoreConditions<dim> &conditions, Vec<dim> *force) const;
  /// Finds the accelerations of the fluids [fluids][nodes] and subtracts their inertia from the force on the mixture,
  /// which leaves the force on the solid. Drag is not among the forces, except where it is explicit: then it is that of
  /// `velocity` [1 + fluids][nodes].
  PetscErrorCode find_accelerations(const Frame &frame, const PoreConditions<dim> &conditions, Vec<dim> *force,
                                    Vec<dim> *acceleration, const Vec<dim> *velocity);
  /// Changes the velocity of the solid by implicit drag over `step` and by the boundaries that limit the fluids.
  /// `solid` and `fluid` enter without drag; the fluids' velocities change in `apply_drag_to_fluids`.
  void apply_drag_to_solid(double step, const Frame &frame, const PoreConditions<dim> &conditions, Vec<dim> *solid,
                           const Vec<dim> *fluid) const;
  /// Inertia of a node against a support of the solid, once drag has acted over `step` [kg].
  Square<dim> inertia(double step, const FilledGrid<dim> &grid, const PoreConditions<dim> &conditions, int node) const;
  /// Force with which the pores press on a wall of outer normal n at a node, docs/theory/pores.md (5.3) [N].
  double thrust(const Vec<dim> &gravity, int node, const Vec<dim> &n) const;
  /// Changes the velocities of the fluids by the same drag. `solid` is the velocity that supports and contact have left
  /// the solid. Boundaries of the fluids act last.
  void apply_drag_to_fluids(double step, const Frame &frame, const PoreConditions<dim> &conditions,
                            const Vec<dim> *solid, Vec<dim> *fluid) const;
  /// Brings the velocities of the fluids within the limits that boundaries and walls set.
  void constrain(const Frame &frame, const PoreConditions<dim> &conditions, const Vec<dim> *solid,
                 Vec<dim> *fluid) const;

  /// Brings the gas from nodes to particles and back: velocities `in` and `out` [1 + fluids][nodes], of which the
  /// skeleton's are there in `out`. Collective.
  PetscErrorCode gas_to_particles_and_back(FilledGrid<dim> &grid, const Vec<dim> *in,
                                           Vec<dim> *out) requires Phases::gas;
  /// Finds the divergence of the mass fluxes in cells, over displacements u [1 + fluids][nodes] from the accepted
  /// state. `frame` is the accepted one; its `trial` alone tells whether the step is one. Collective.
  PetscErrorCode find_divergence(const Frame &frame, const PoreConditions<dim> &conditions, const Vec<dim> *u);
  /// Is the cell among those over which pressures, volume strain of the pores and fluxes are smoothed? Those are the
  /// cells of patches in which all pores are nearly full, in the accepted state, theory (4.3).
  bool smoothed(int c) const { return !Phases::suction || cells_[c].smoothed; }
  /// Smooths the divergence together with the volume strain of the cells, which becomes that of the pores. Collective.
  PetscErrorCode smooth_divergence(const Frame &frame, Array &volume_strain);
  /// Subtracts the divergence from the masses of the points. `frame` has the volumes at the end.
  void change_masses(const Frame &frame);
  /// Finds the pressures of the points from their masses, and the sums over cells and nodes that the forces are made
  /// of. It may be left out before particles are released. Collective.
  PetscErrorCode update_pressures(const Frame &frame);

  // Pressure implicit in time, theory of pores, section 8; `frame` is the accepted state.
  PetscErrorCode start_implicit(const Frame &frame, const PoreConditions<dim> &conditions, double step,
                                ImplicitPressure<dim> &of);
  void find_walls(const Frame &frame, const PoreConditions<dim> &conditions, double step, const Vec<dim> *solid,
                  const Vec<dim> *fluid, ImplicitPressure<dim> &of) const;
  /// Part of the velocity that a fluid retains beside the skeleton in a step, once drag has acted.
  double free_share(double step, int node) const { return 1 / (1 + drag_number(step, over_step(node, 0))); }
  PetscErrorCode push_by_change(const StepStart<dim> &at, ImplicitPressure<dim> &of, Vec<dim> *velocity) const;

  /// Suction at the points of a body [Pa].
  const double *suction(int body) const requires Phases::suction { return points_[body].suction.data(); }
  PoreReport report(int body, int point, int cell, bool surface) const;
  const SoilPores &soil(int body) const { return soils_[body]; }
  /// `sums` [fluids]; `gathered`: points hold the masses, not particles. Collective.
  PetscErrorCode ledger(bool gathered, FluidLedger *sums);

  /// Largest rate at which drag brings together what moves apart at a node of this rank, docs/theory/pores.md (6.1a)
  /// [1/s].
  double drag_rate(const FilledGrid<dim> &grid) const;

  /// Sum of w grad N at the nodes, at the last remap [m2].
  const std::vector<Vec<dim>> &surface() const { return surface_; }
  /// Its first moment in depth below the node, where open water rests on it [m3].
  const std::vector<Vec<dim>> &surface_moment() const { return moment_; }
  void serialize(Archive &archive, const typename FilledGrid<dim>::Rows &grid,
                 const std::vector<Archive::Rows> &points_of_bodies);

  bool prescribed = false;  ///< pressures follow [water] instead of the fluids' motion
  double prescribed_ramp = 1;

 private:
  struct PorePoints {  // sized for a point in every cell or for all particles; only the first `count` are in use
    int count = 0;
    Array grains;        ///< V_s [m3]
    Array mass[fluids];  ///< [kg]
    Array share;         ///< S_g
    Array suction;       ///< [Pa]
    Array pressure;      ///< of the liquid, stored only where it is integrated by its rate [Pa]

    void reserve(int points) {
      if (points <= static_cast<int>(grains.size())) return;
      for (Array *field : {&grains, &share, &suction}) make_room(*field, points);
      for (Array &m : mass) make_room(m, points);
    }
  };
  struct CellPores {
    double pressure[fluids], smooth[fluids];  ///< [Pa]
    double conductivity[fluids];              ///< k k_r / mu [m2/(Pa s)]
    double saturated;                         ///< conductivity of the liquid in pores full of it [m2/(Pa s)]
    double density[fluids], mass[fluids];     ///< [kg/m3], [kg]
    double saturation;
    double mixture;          ///< pressure of the pores in the total stress [Pa]
    long long smoothed = 0;  ///< 1: the pores of all cells of its patch are nearly full; as wide as the others, since
                             ///< checkpoints would store what is between a narrower one and the end
  };
  static constexpr int last = 3, mixture = Phases::suction ? fluids : 0;  ///< lane; pressure that acts on the skeleton
  struct NodePores {                                                      // sums over cells and ranks
    Quad geometry;                              ///< sum of w grad N [m2]; V [m3] in the last lane
    Quad amount;                                ///< m, M = sum w rho / (d+1) of the liquid, and of the gas [kg]
    Quad push[mixture ? mixture + 1 : fluids];  ///< sum of w P grad N [N]; sum of w k / (d+1), for the mixture with
                                                ///< full pores, in the last lane

    double volume() const { return geometry[last]; }
    double mass(int a) const { return amount[2 * a]; }
    double whole(int a) const { return amount[2 * a + 1]; }
    double conductivity(int a) const { return push[a][last]; }
  };
  struct PatchPores {  // sums over the cells of a patch
    double weight, pressure, head, liquid;
    int open;  ///< number of cells whose pores are not nearly full
  };
  static constexpr double nearly_full = 0.99;  ///< degree of saturation
  static constexpr int node_width = sizeof(NodePores) / sizeof(double);

  /// Weight of a fluid at a node over the weight of its mass. The liquid weighs as if it were not compressed: a
  /// softened liquid would be compressed too much, and still water is hydrostatic to round-off this way.
  double weight_factor(const NodePores &node, int a) const {
    return a == 0 && node.whole(0) > 0 ? liquid_.density * node.volume() / node.whole(0) : 1;
  }
  Pores<dim> pores_of(std::vector<PorePoints> &points, int body);
  static Vec<dim> surface_at(const NodePores &node) {
    Vec<dim> area;
    talus::store<dim>(area.data(), node.geometry);
    return area;
  }
  double prescribed_gas_pressure(const Vec<dim> &x) const;
  std::array<double, 3> contents(const SoilPores &soil, double pressure, double gas_pressure) const;
  /// Of still liquid, which water beside the soil stays where the ground is shaken along it.
  double unit_weight(const Frame &frame) const { return -liquid_.density * dot<dim>(frame.gravity, upward()); }
  PetscErrorCode gas_flux(const Frame &frame, const Vec<dim> *gas, const Vec<dim> *solid) requires Phases::gas;
  static double pore_volume(double volume, double grains) { return std::max(volume - grains, 1e-6 * volume); }
  PetscErrorCode find_moment(const Frame &frame);
  void set_prescribed_pressures(const Frame &frame);
  void find_pressures(const Frame &frame);
  void find_smoothed(const Frame &frame) requires Phases::suction;
  void average_over_patches(const Frame &frame, std::vector<CellPores> &pores) requires Phases::suction;
  void save_pressures(const Frame &frame);
  void set_masses_by_rate(const Frame &frame);
  template <class Hold>
  void limits(const Frame &frame, const PoreConditions<dim> &conditions, Hold &&hold) const;
  void find_gaps(const Frame &frame, const PoreConditions<dim> &conditions);
  void start_drying(const Frame &frame, ImplicitPressure<dim> &of) requires Phases::suction;
  void find_mobility(const Frame &frame, const PoreConditions<dim> &conditions, double step,
                     ImplicitPressure<dim> &of) const;
  PetscErrorCode spread_divergence(const Frame &frame, Array &outflow);
  PetscErrorCode share_divergence(const Frame &frame, Array &divergence) requires Phases::suction;
  PetscErrorCode share_pressure(const Frame &frame, Array &pressure) requires Phases::suction;
  /// Integration volume of a cell minus the volume of its particles; 0 in nearly full cells [m3].
  double volume_beyond_particles(const Frame &frame, int c) const {
    return cells_[c].saturation >= nearly_full ? 0 : frame.weight[c] - frame.particle_volume[c];
  }
  double gas_density() const {
    if constexpr (Phases::gas) return gas_.density;
    return 0;
  }
  template <int count>
  PetscErrorCode smooth(const Frame &frame, const std::array<double *, count> &fields);
  Vec<dim> place(const Frame &frame, int cell, const std::array<double, dim + 1> &barycentric) const;
  NodalFluid at_node(int node, int a, double beyond) const;
  NodalFluid at_node(int node, int a) const { return at_node(node, a, a ? 0 : beyond_[node]); }
  NodalFluid over_step(int node, int a) const;
  double conductivity_beyond(int node, const NodePores &at, double pressure) const;
  double mixture_pressure(const double *p, double saturation) const;

  const BackgroundMesh<dim> &mesh_;
  std::vector<std::unique_ptr<Body<dim>>> &bodies_;
  const Scene &scene_;
  Liquid liquid_;
  [[no_unique_address]] If<Phases::gas, PoreGas> gas_;
  std::vector<SoilPores> soils_;
  PrescribedPressure<dim> pressure_;
  bool bishop_, smoothing_, patches_, explicit_drag_, by_rate_, implicit_;

  std::vector<PorePoints> points_, next_points_, trial_;
  std::vector<CellPores> cells_, trial_cells_;
  std::vector<NodePores> nodes_, trial_nodes_;
  std::vector<PatchPores> patch_pores_;
  std::vector<Vec<dim>> flux_[fluids], surface_, moment_;
  std::vector<Vec<dim>> gap_;  ///< of a node: area vector of the gap over the volume of its cells [1/m]; 0 elsewhere
  Array gap_flux_[fluids];     ///< of a node: mass flux through the gap were it open, over that volume [kg/(m3 s)]
  std::vector<std::array<double, dim + 1>> mean_,
      reference_;  ///< of a cell: mean place of its particles, and the place at which it has its pressure
  std::vector<std::array<double, dim + 1>> rows_;  ///< sums over rows of the solid's mass matrices [kg]
  Array grain_mass_;                               ///< of a cell [kg]
  [[no_unique_address]] If<Phases::gas, std::vector<std::array<double, dim + 1>>>
      uptake_;  ///< of a cell: volume that its nodes take from it, if its pores were full of gas [m3]
  std::vector<std::array<Quad, dim>> impulse_[fluids];  ///< of a cell [component][vertex]: sum m_s N v_a [kg m/s]
  std::vector<std::array<Quad, fluids>> momentum_;      ///< of a node: m_a v_a [kg m/s], m_a in the last lane
  Array divergence_[fluids], smooth_[fluids], head_, nodal_head_, nodal_;
  Array beyond_;  ///< conductivity of the soil beyond a face with a prescribed pressure [node]; 0 elsewhere
  std::vector<int> body_of_node_;  ///< one of the bodies around it
  double out_[fluids] = {}, prescribed_mass_[fluids] = {};
};

}  // namespace talus
