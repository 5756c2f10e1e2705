#pragma once
/// The soil of a quasi-static problem as finite elements on the active cells of the background mesh,
/// docs/theory/finite_elements.md section 2: Gauss points with stress and history, which go through the laws' own
/// stress update; what nodal displacement makes of them; internal forces and element stiffness. Strains are small:
/// geometry is that of the mesh.
#include <algorithm>
#include <functional>

#include "base/archive.h"
#include "physics/laws/update_stress.h"
#include "solvers/quasi_static/element_nodes.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {

struct BodySource;
enum class Elements;
template <int dim>
class Structures;

/// What the problem takes from the rest of the program.
template <int dim>
struct SoilData {
  Elements elements{};
  /// Total density of a body at a place and time of the loads [kg/m3].
  std::function<double(const BodySource &, const Vec<dim> &, double)> density;
  /// Pore pressure at a place and time of the loads, of a body or of the common water [Pa]; empty where the scene has
  /// none.
  std::function<double(const Vec<dim> &, double, int soil)> pressure;
  /// Has a body water of its own, whose pressure may jump at its border?
  std::function<bool(int soil)> apart;
  bool open_water_load = true;
  /// Water whose pressure and weight the soil carries instead, where it flows; else null.
  const PoreFlow<dim> *flow = nullptr;
  /// What is built into the soil, or null.
  Structures<dim> *structures = nullptr;
};

/// The Gauss points of one body. Arrays have one row per point, those of a cell together.
template <int dim>
struct GaussPoints {
  Law law;
  bool present = true;                  ///< the body is there in this stage
  std::vector<int> cell;                ///< of points
  std::vector<double> volume;           ///< [m3]
  std::vector<Vec<dim>> position;       ///< [m]
  std::vector<double> stress, history;  ///< at the last converged state, as laws store them
  std::vector<double> total_strain;     ///< since displacement was last reset [stress_size]
  std::vector<double> trial_stress, trial_history;
  std::vector<Increment<dim>> increment;
  std::vector<int> number;                             ///< 0, 1, ...: each point has an increment of its own
  std::vector<double> size;                            ///< element size of softening laws [m]
  std::vector<double> suction;                         ///< at the loads of the step, for laws that read it [Pa]
  std::vector<double> cohesion_share, friction_share;  ///< of the law's c and phi, for laws that read them; empty: 1
  int count() const { return static_cast<int>(cell.size()); }
  /// From the converged state to the trial one by `increment`.
  StressPoints<dim> trial() {
    const auto or_null = [](const std::vector<double> &values) { return values.empty() ? nullptr : values.data(); };
    return {.count = count(),
            .stress_in = stress.data(),
            .history_in = history.data(),
            .stress_out = trial_stress.data(),
            .history_out = trial_history.data(),
            .cell = number.data(),
            .increment = increment.data(),
            .size = size.data(),
            .suction = or_null(suction),
            .cohesion_share = or_null(cohesion_share),
            .friction_share = or_null(friction_share)};
  }
};

template <int dim>
class SoilElements {
 public:
  /// Stiffness of one element, rows and columns [node][component].
  using Stiffness = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Gauss points of all bodies, stresses zero. The references must outlive the elements.
  SoilElements(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws,
               const SoilData<dim> &data);

  /// Takes these bodies (by their place in the scene) in and leaves out the others. Nodes keep their displacement; new
  /// ones have none. Collective.
  PetscErrorCode activate(const std::vector<char> &present);
  /// `activate` leaves these cells out, whatever their body; empty: none.
  void leave_out(const std::vector<char> &cells) { left_out_ = cells; }
  const std::vector<char> &left_out() const { return left_out_; }

  /// Suction of laws that read it, at the loads of time t.
  void find_suction(double t);
  /// Trial state of all points by an increment of nodal displacement `u` [local nodes][dim].
  void deform(const std::vector<double> &u);
  /// Forces of the stresses on local nodes, this rank's part, in the trial or the committed state [N].
  void internal_force(std::vector<double> &force, bool trial) const;
  /// Calls put(nodes, their number, stiffness) for each element: `plastic` times that of the laws at the trial state
  /// plus `elastic` times that of elastic soil.
  PetscErrorCode each_stiffness(double plastic, double elastic,
                                const std::function<PetscErrorCode(const int *, int, Stiffness &)> &put);
  /// Calls visit(nodes, their number) for each element.
  PetscErrorCode each_element(const std::function<PetscErrorCode(const int *, int)> &visit) const;
  /// Work that the stress, between the committed and the trial state, does on the increment of strain, this rank's part
  /// [J]. Of elastic soil it is the change of strain energy.
  double stress_work() const;
  /// Strain energy at the committed state, this rank's part [J].
  double strain_energy() const;
  /// Accepts the trial state to which `u` has led.
  void accept(const std::vector<double> &u, bool softening);
  void commit(const std::vector<double> &u, bool softening) { deform(u), accept(u, softening); }
  /// Displacement counts from here; so does plastic strain.
  void reset_displacement();
  /// Brings the present stress to what the laws admit now, as after a change of strength.
  void admit();
  /// A state to come back to.
  struct State {
    std::vector<GaussPoints<dim>> points;
    std::vector<double> displacement;
  };
  State save() const { return {points_, displacement_}; }
  void restore(const State &state) { points_ = state.points, displacement_ = state.displacement; }
  /// The state in a checkpoint, between two paths.
  void serialize(Archive &archive);

  std::vector<GaussPoints<dim>> &points() { return points_; }
  const std::vector<GaussPoints<dim>> &points() const { return points_; }
  const BackgroundMesh<dim> &mesh() const { return mesh_; }
  const ElementNodes<dim> &nodes() const { return nodes_; }
  bool active(int cell) const { return active_[cell]; }
  const std::vector<char> &active() const { return active_; }
  int body_of(int cell) const { return body_of_[cell]; }
  /// Has the cell, which is active, stress at the last converged state? Soil without stress bears no loads yet.
  bool stressed(int cell) const {
    const auto first = points_[body_of_[cell]].stress.begin() + first_point_[cell] * components;
    return std::any_of(first, first + points_per_cell() * components, [](double s) { return s != 0; });
  }
  /// First point of a cell in its body; -1 if the body is not there.
  int first_point(int cell) const { return first_point_[cell]; }
  const Quadrature<dim> &rule() const { return rule_; }
  int points_per_cell() const { return static_cast<int>(rule_.point.size()); }
  const std::vector<double> &displacement() const { return displacement_; }  ///< of local nodes, committed [m]
  /// Displacement at a place of a cell given in barycentric coordinates [m].
  Vec<dim> displacement(int cell, const Barycentric<dim> &place) const;
  /// The same since `displacement_is_taken` [m].
  Vec<dim> further_displacement(int cell, const Barycentric<dim> &place) const;
  void displacement_is_taken() { taken_ = displacement_, restarted_ = false; }
  /// Has displacement been counted anew since then?
  bool restarted() const { return restarted_; }
  /// Adds what motion has displaced the soil by: `more` [node][d] of vertices, edges take the mean of their ends [m].
  void add_displacement(const std::vector<double> &more);
  /// Largest displacement of a node [m]; collective.
  double largest_displacement() const;
  /// Does a law read suction? Pressure below zero is then suction, not stress.
  bool suction_matters() const { return suction_matters_; }

 private:
  static constexpr int components = stress_size<dim>;
  /// Cells that are integrated together: one, or a patch that shares its volumetric strain.
  struct Group {
    int body, first_point, points;
    int first_node, nodes;  ///< in group_node_
    size_t first_gradient;  ///< in gradient_: [point][node]
    size_t mean_gradient;   ///< in gradient_: [node]
  };
  void place_points();
  Vec<dim> interpolate(const std::vector<double> &nodal, int cell, const Barycentric<dim> &place) const;
  void make_groups();
  void serialize_points(Archive &archive, GaussPoints<dim> &points);

  const BackgroundMesh<dim> &mesh_;
  const SoilData<dim> &data_;
  int order_;
  bool patches_, suction_matters_ = false;
  Quadrature<dim> rule_;
  std::vector<int> body_of_, first_point_;  // of cells
  std::vector<char> active_, left_out_;     // cells
  std::vector<GaussPoints<dim>> points_;
  ElementNodes<dim> nodes_;
  std::vector<Group> groups_;
  std::vector<int> group_node_;
  std::vector<Vec<dim>> gradient_;
  std::vector<double> displacement_;           // of local nodes, committed
  std::vector<double> taken_;                  // the part of it that particles have
  std::vector<double> displacement_of_point_;  // `displacement_` by point of the DMPlex, kept while nodes come and go
  std::vector<double> taken_of_point_;         // `taken_`
  bool restarted_ = false;
};

}  // namespace talus
