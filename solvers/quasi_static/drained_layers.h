#pragma once
/// Water that leaves consolidating soil through a face while the change of pressure crosses the cells beneath,
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
  /// Does water leave a node through a layer, so that the node has the pressure behind it?
  bool at(int node) const { return node < static_cast<int>(layered_.size()) && layered_[node]; }
  /// Volume of water that crosses the layers of this rank's faces in the step, per pressure of the node [m3/Pa].
  double passes(int node) const { return passes_[node]; }

 private:
  static double crossing_time(const Face &f);
  static double passed(const Face &f, double t);
  const ElementNodes<dim> *nodes_ = nullptr;
  std::vector<Face> faces_;
  std::vector<char> layered_;
  std::vector<double> passes_;
};

}  // namespace talus
