#pragma once
/// Loads on the soil of a quasi-static problem: weight, pore pressure, body accelerations, and the loads and the open
/// water that boundaries put on faces.
#include <algorithm>
#include <functional>
#include <vector>

#include "physics/boundary/conditions.h"
#include "scene/scene.h"
#include "solvers/quasi_static/soil_elements.h"

namespace talus {

template <int dim>
class Loads {
 public:
  using Source = NamedBoundary;
  /// The references must outlive the loads.
  Loads(const SoilElements<dim> &soil, const Scene &scene, const std::vector<Source> &sources,
        const SoilData<dim> &data)
      : soil_(soil),
        scene_(scene),
        sources_(sources),
        data_(data),
        rule_(load_quadrature<dim>()),
        facet_rule_(load_quadrature<dim - 1>()) {
    std::copy_n(scene.gravity.begin(), dim, acceleration.begin());
  }
  /// Finds the loaded faces of the soil that is active now. Collective.
  void activate();
  /// Forces on local nodes at time t, this rank's part [N]; of all active cells or of those that `counts` names.
  void force(double t, std::vector<double> &force, const std::function<bool(int cell)> &counts = {}) const;
  /// Does a boundary load the soil that is active now, on this rank?
  bool loads(int source) const {
    return std::any_of(facets_.begin(), facets_.end(), [&](const LoadedFacet &f) { return f.source == source; });
  }
  /// Of these the weight, with what `acceleration` has beside gravity, and the load of one boundary.
  void weight(double t, std::vector<double> &force, const std::function<bool(int cell)> &counts = {}) const;
  void load_of(int source, double t, std::vector<double> &force,
               const std::function<bool(int cell)> &counts = {}) const;
  /// Mean displacement of each loaded face, by source [m]. Collective.
  PetscErrorCode mean_displacement(std::vector<Vec<dim>> &face) const;

  Vec<dim> acceleration;  ///< gravity, and the pseudo-static inertia of an earthquake [m/s2]

 private:
  struct LoadedFacet {
    Facet<dim> facet;
    int source;
    double share;  ///< of its force that acts on this cell: half where soil is on both sides
    std::vector<int> node;
  };
  double pore_pressure(const Vec<dim> &x, double t, int soil) const;
  Vec<dim> traction_of(const LoadedFacet &load, const Vec<dim> &x, double t) const;
  void add_volume(int cell, double t, bool only_weight, std::vector<double> &force) const;
  void add_load(const LoadedFacet &load, double t, std::vector<double> &force) const;

  const SoilElements<dim> &soil_;
  const Scene &scene_;
  const std::vector<Source> &sources_;
  const SoilData<dim> &data_;
  Quadrature<dim> rule_;
  Quadrature<dim - 1> facet_rule_;
  std::vector<LoadedFacet> facets_;
};

}  // namespace talus
