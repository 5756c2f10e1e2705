#pragma once
/// The unknowns of a quasi-static problem: increments of nodal displacement, each node's in the frame of its support,
/// and the matrices that act on them.
#include "solvers/quasi_static/linear_system.h"
#include "solvers/quasi_static/soil_elements.h"
#include "solvers/quasi_static/supports.h"

namespace talus {

template <int dim>
class Unknowns {
 public:
  /// The references must outlive the unknowns.
  Unknowns(const SoilElements<dim> &soil, const Supports<dim> &supports) : soil_(soil), supports_(supports) {}
  /// Numbers the nodes that are there now. Collective.
  PetscErrorCode setup();
  long long count() const { return count_; }  ///< on all ranks
  /// An empty matrix with room for the stiffness of the soil and for what `add_more` adds. Collective.
  PetscErrorCode make_matrix(SparseMatrix &matrix, const std::function<PetscErrorCode()> &add_more) const;
  /// Tells a matrix the rigid motions, for multigrid: zero where motion is prescribed. Collective.
  PetscErrorCode tell_rigid_motions(Mat matrix) const;

  /// Turns owned nodes' vectors into their frames; with `clear`, prescribed components become zero.
  void turn(double *global, bool clear) const;
  PetscErrorCode turn(::Vec global, bool clear) const;
  /// Calls visit(k) for each prescribed component k of this rank's part of a global vector.
  template <class Visit>
  void each_held(Visit &&visit) const {
    for (PetscInt row : supported_)
      for (int d = 0; d < dim; ++d)
        if (supports_.at(owned_[row])->held[d]) visit(row * dim + d);
  }
  /// Displacement of local nodes from the unknowns, with the prescribed motion if wanted. Collective.
  PetscErrorCode displacement_of(::Vec x, bool with_motion, std::vector<double> &u) const;
  /// Puts the stiffness of an element into `matrix`. `lift` receives what `motion` (local nodes, in their frames) does
  /// to the free rows.
  PetscErrorCode add(SparseMatrix &matrix, const int *node, int count, typename SoilElements<dim>::Stiffness &element,
                     const std::vector<double> *motion, std::vector<double> *lift) const;
  /// Diagonal of prescribed components, then assembly. Collective.
  PetscErrorCode finish(SparseMatrix &matrix, double diagonal) const;

  /// Prescribed increments of local nodes over (time, time + dt) in their frames; false if nothing moves on any rank.
  /// Collective.
  PetscErrorCode find_motion(double time, double dt, std::vector<double> &motion, bool *moves) const;
  /// From now on `displacement_of` takes these increments; none if empty.
  void set_motion(const std::vector<double> &motion);

 private:
  void rows_of(const int *node, int count, std::vector<PetscInt> &row) const;

  const SoilElements<dim> &soil_;
  const Supports<dim> &supports_;
  std::vector<PetscInt> owned_, supported_;  // local nodes in the order of their rows; rows with a support
  std::vector<double> motion_;               // prescribed increments of owned nodes in their frames [row * dim]
  long long count_ = 0;
  Vector scratch_;
};

}  // namespace talus
