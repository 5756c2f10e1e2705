#pragma once
/// Flow of pore water through soil by finite elements of first order on the active cells, docs/theory/seepage.md:
/// Darcy's law with the retention curves and permeabilities of the scene, storage lumped at the nodes and conserved as
/// mass. Boundaries act as their kinds state (physics/boundary/kind.h), as in the motion of the fluids.
#include <functional>
#include <optional>

#include "base/archive.h"
#include "physics/boundary/pore_conditions.h"
#include "physics/pores/fluids.h"
#include "physics/pores/soil_pores.h"
#include "solvers/quasi_static/cell_permeability.h"
#include "solvers/quasi_static/drained_layers.h"
#include "solvers/quasi_static/element_nodes.h"
#include "solvers/quasi_static/linear_system.h"

namespace talus {

struct Scene;

/// The values at a node that the step control looks at: the pressure in the total stress [Pa], and the saturation.
struct FlowMeasure {
  double pressure, saturation;
};

/// The body of each cell by its place in the scene, -1 for none.
template <int dim>
std::vector<int> bodies_of_cells(const BackgroundMesh<dim> &mesh, const Scene &scene);

/// The water balance of local nodes: its residual, and the size of the terms that must cancel.
struct WaterBalance {
  std::vector<double>
      rest;  ///< water that the soil of a node stores and passes on in the step, minus the water that flows in [m3]
  std::vector<double> size;  ///< the same with all terms positive [m3]
};

template <int dim>
class PoreFlow {
 public:
  using Source = NamedBoundary;
  /// `suction`: pores may dry; otherwise they stay full at any pressure. `more` are boundaries of the water in addition
  /// to those that the motion has too. The references must outlive it.
  PoreFlow(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Source> &sources, bool suction,
           const std::vector<Source> &more = {});

  /// Sets the cells through which water flows. Nodes retain their pressure, new ones take `fresh`(x). Collective.
  PetscErrorCode activate(const std::vector<char> &active, const std::function<double(const Vec<dim> &)> &fresh);

  /// Lets water leave by layers that are thinner than cells: `storage` [1/Pa] is that of the soil of each body, with
  /// its skeleton. Without it faces drain as deep as cells are. To be told after `activate`.
  void drain_in_layers(const std::vector<double> &storage);
  /// Begins a step that ends at the loads of time t, `from` to `to` [s] after the stage began: finds the nodes whose
  /// pressure boundaries prescribe (`fixed`) and writes it into `pressure`. The pressures of the other nodes are
  /// unknown. Collective.
  PetscErrorCode begin(double t, double travel, double from, double to);
  /// Balance of a step dt from the accepted pressures to `pressure`, without the volume strain of the soil.
  void balance(double t, double dt, WaterBalance *balance) const;
  /// Adds its derivative to the rows and columns of nodes that are not fixed.
  /// Without `newton` the permeability counts as it is (Picard), which converges slower and from further away.
  PetscErrorCode tangent(double dt, bool newton, SparseMatrix &matrix) const;
  /// Seepage faces: opens nodes that are under pressure, and closes those that would draw in more than the supply.
  /// `rest` is the balance of the solved step, summed over ranks. True, on all ranks alike, if any changed.
  bool update_seepage(const std::vector<double> &rest);
  /// Accepts `pressure`, and the water that crossed the boundaries.
  void commit(double t, double dt, const std::vector<double> &rest);

  // Fields of the present trial state, linear between the vertices of a cell.
  double pressure_at(int cell, const Barycentric<dim> &l) const;
  /// The same, and on a face beneath which a layer thinner than the cells drains the pressure beyond it, for results.
  double pressure_on_faces(int cell, const Barycentric<dim> &l) const;
  /// Pressure of the pores in the total stress [Pa], docs/theory/pores.md (4.2), and its derivative with pressure.
  double stress_pressure(int cell, const Barycentric<dim> &l) const;
  double stress_pressure_slope(int cell, const Barycentric<dim> &l) const;
  double saturation(int cell, const Barycentric<dim> &l) const;
  FlowMeasure measure(int node) const;
  /// Mass of water per volume of soil [kg/m3].
  double water_density(int cell, const Barycentric<dim> &l) const;

  const ElementNodes<dim> &nodes() const { return nodes_; }
  bool fixed(int node) const { return fixed_[node]; }
  bool active(int cell) const { return active_[cell]; }
  int body_of(int cell) const { return body_of_[cell]; }
  double conductivity(int cell) const {
    return soils_[body_of_[cell]].permeability() / liquid_.viscosity;
  }  ///< of full pores [m2/(Pa s)]
  double porosity(int body) const { return soils_[body].porosity(); }
  const Liquid &liquid() const { return liquid_; }
  /// Weight of the water [N/m3].
  double unit_weight() const;
  /// Sum of the volumes of water that the pores of this rank have gained or lost since the accepted state, without
  /// signs [m3].
  double stored() const;
  /// Volume of water per time that entered through each boundary in the last step [m3/s], by source. Collective.
  std::vector<double> inflow() const;
  /// The same of the boundaries that only the flow has, by their names. Collective.
  std::vector<std::pair<std::string, double>> own_inflow() const;
  /// The same of faces of the soil that no boundary names. Collective.
  double unnamed_inflow() const;
  /// Mass of water that has entered through all boundaries since this was asked last [kg]. Collective.
  double take_entered();
  int cell_count() const { return mesh_.cell_count(); }
  /// Coordinates [m] and pressure [Pa] of the vertices of cells, one after another: the accepted pressure in active
  /// cells, and that of open water at time t in the others which it fills. Collective.
  PetscErrorCode pressure_of_cells(double t, std::vector<double> *cells) const;

  /// The pressure of open water at time t as a function of places on the surface of the soil and beyond [Pa]: of the
  /// water that stands on the face of the soil which is nearest. Collective.
  PetscErrorCode find_open_water(double t, std::function<double(const Vec<dim> &)> *pressure) const;

  /// The state in a checkpoint, between two steps.
  void serialize(Archive &archive);

  std::vector<double> pressure;  ///< trial, of local nodes [Pa]
  std::vector<double> accepted;  ///< at the start of the step [Pa]
  /// By how much the accepted pressure is above the mean of the particles around a node that have their pressure from
  /// it, of local nodes [Pa]; 0 where it is not known.
  std::vector<double> above_mean;

 private:
  struct Supply {  ///< a boundary that supplies water at a node of a face
    int node, source;
    double area, upward;              ///< [m2]; component of the face's normal against gravity [-]
    std::array<Vec<dim>, dim> place;  ///< Gauss points of the face, the nearest to the node first
  };
  double saturation_of(int body, double p) const;
  double saturation_slope_of(int body, double p) const;
  CellPermeability<dim> relative_permeability(int cell, const std::array<Vec<dim>, dim + 1> &gradient,
                                              bool with_slope) const;
  double content(int body, double p) const;        ///< of water per volume of soil, at its density without pressure [-]
  double content_slope(int body, double p) const;  ///< [1/Pa]
  double inflow_at(const Supply &supply, double t) const;  ///< mean, weighted by the node's shape function [m/s]
  /// In the step [m3].
  double out_of_layer(int node) const { return layers_.passes(node) * (pressure[node] - beyond_[node]); }
  double outside(int node, double t) const;
  double outside(int source, const Vec<dim> &x, double t) const;
  bool has_curve(int body) const;

  const BackgroundMesh<dim> &mesh_;
  const Scene &scene_;
  std::vector<Source> sources_;
  std::size_t shared_sources_;  ///< number of those that the motion has too, which come first
  std::vector<int> body_of_;
  bool suction_, bishop_;
  Liquid liquid_;
  Vec<dim> gravity_, upward_;
  std::vector<SoilPores> soils_;
  std::vector<std::optional<MeanPermeability>> mean_permeability_;  ///< of soils_ whose pores may dry
  std::vector<char> active_;
  std::vector<int> body_of_node_;  ///< of one of the cells around it
  ElementNodes<dim> nodes_;
  std::vector<double> pressure_of_point_;  ///< accepted, by point of the DMPlex; NaN where water never was
  static constexpr int atmosphere = -1, none = -2;
  std::vector<int> pressed_;        ///< of nodes: source of the pressure beyond the face, the atmosphere, or none
  std::vector<char> at_surface_;    ///< nodes of faces without soil beyond
  std::vector<char> may_close_;     ///< 1 at seepage faces, where water leaves and no more than the supply enters
  std::vector<char> open_, fixed_;  ///< seepage nodes that have the pressure beyond; nodes whose pressure is known
  std::vector<char> layered_;       ///< nodes that water leaves through a layer of layers_
  std::vector<double> beyond_;      ///< pressure beyond, of nodes that are pressed [Pa]
  std::vector<Supply> supplies_;
  std::vector<Facet<dim>> pressed_faces_;  ///< beyond which the pressure is prescribed
  DrainedLayers<dim> layers_;
  std::vector<double> inflow_;  ///< by source, and at last of faces without one, of this rank [m3/s]
  double entered_ = 0;          ///< on this rank [kg]
  double travel_ = 0;           ///< load time of the step [s]
};

}  // namespace talus
