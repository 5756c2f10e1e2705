#pragma once
/// Structures in the finite elements, docs/theory/structures.md section 3: the points of a bar go with the soil by the
/// shape functions of the element that each lies in, and the bar between them is a chain that finds its own slips
/// (physics/structures/bar_chain.h). So it is one large element with the nodes around it and no unknowns of its own.
#include <functional>
#include <string>
#include <vector>

#include "physics/structures/structures.h"
#include "solvers/quasi_static/linear_system.h"
#include "solvers/quasi_static/soil_elements.h"
#include "solvers/quasi_static/supports.h"

namespace talus {

template <int dim>
class StructuresInSoil {
 public:
  using State = std::vector<BarChain>;
  /// `structures` may be null; the references must outlive it.
  StructuresInSoil(const SoilElements<dim> &soil, const Supports<dim> &supports, Structures<dim> *structures)
      : soil_(soil), supports_(supports), structures_(structures) {}

  bool any() const { return structures_ && structures_->any(); }
  /// Finds the elements of the soil that is active now in which the points lie. Collective.
  PetscErrorCode activate();
  /// Bonds have the strength that the present stress of the soil gives them from now on. Collective.
  void set_bonds();
  /// The same with the trial stress, and elements tear that have yielded too far. `change`: of the strength of all
  /// bonds over this strength, or 1 if something tore [-]. Collective.
  void follow_soil(double *change);
  /// Why a bond cannot hold the prestress of its anchor; empty if all can.
  std::string too_weak_for_prestress() const;

  /// Adds the forces on local nodes, as those of the stress of the soil count, after nodal increments `u` of the last
  /// converged state [N]. Collective.
  void add_trial_force(const std::vector<double> &u, std::vector<double> &force);
  /// The same at the last converged state.
  void add_force(std::vector<double> &force) const;
  /// Adds the entries of the stiffness, zero in rows and columns that supports hold; `lift` receives what `motion`
  /// (local nodes, in their frames) does to the free rows. Collective.
  PetscErrorCode add_stiffness(double plastic, double elastic, SparseMatrix &matrix, const std::vector<double> *motion,
                               std::vector<double> *lift) const;
  /// Room for these entries. Collective.
  PetscErrorCode add_room(SparseMatrix &matrix) const;
  /// Accepts the trial state of the last `add_trial_force`.
  void commit(const std::vector<double> &u);

  State save() const;
  void restore(const State &state);
  /// From now on the capacities of those bars are divided that a factor of safety reduces.
  void set_trial(double factor);

 private:
  /// A point whose element is on this rank.
  struct Place {
    int bar, point, cell;
    std::vector<double> shape;  ///< of the nodes of the element
  };
  struct Column;
  /// Stretch of the elements of a bar by the nodes around it.
  struct Nodes {
    std::vector<PetscInt> row;                         ///< global rows of the matrix, those of a node together
    typename SoilElements<dim>::Stiffness stretch_of;  ///< [element][row], zero where a support holds the node
  };
  void each_present(const std::function<void(Bar<dim> &, std::size_t)> &visit) const;
  std::vector<std::vector<double>> stretches(const std::vector<double> &u) const;
  void force_of(const std::function<double(const BarChain &, int)> &axial, std::vector<double> &force) const;
  void take_bonds(bool trial, double *changed, double *all);
  PetscErrorCode find_nodes();

  const SoilElements<dim> &soil_;
  const Supports<dim> &supports_;
  Structures<dim> *structures_;
  std::vector<Place> places_;
  std::vector<Nodes> nodes_;  ///< of bars
};

}  // namespace talus
