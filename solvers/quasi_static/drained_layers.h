#pragma once
/// Water that leaves consolidating soil through a face before the change of pressure has crossed the cells beneath,
/// docs/theory/seepage.md (3.2).
#include <array>
#include <vector>

#include "solvers/quasi_static/element_nodes.h"

namespace talus {

template <int dim>
class DrainedLayers {
 public:
  /// A face with a prescribed pressure beyond, and the cell beneath.
  struct Face {
    std::array<int, dim> node;  ///< local
    double area, height;        ///< [m2], [m]: height of the cell over the face
    double conductivity;        ///< k / viscosity [m2/(Pa s)]
    double storage;             ///< of water per volume and pressure [1/Pa]; 0: there is no layer at its nodes
  };
  /// `nodes` must outlive it.
  void setup(const ElementNodes<dim> &nodes, std::vector<Face> faces) { nodes_ = &nodes, faces_ = std::move(faces); }
  /// A step between two times after the change [s]. Collective.
  PetscErrorCode begin(double from, double to);
  /// Does the drained layer at a node end within the cells, so that the node has the pressure behind it?
  bool ends_at(int node) const { return node < static_cast<int>(thin_.size()) && thin_[node]; }
  /// Volume of water that crosses the layers of this rank's faces in the step, per pressure of the node [m3/Pa].
  double passes(int node) const { return passes_[node]; }

 private:
  const ElementNodes<dim> *nodes_ = nullptr;
  std::vector<Face> faces_;
  std::vector<char> thin_;
  std::vector<double> passes_;
};

}  // namespace talus
