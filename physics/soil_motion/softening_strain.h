#pragma once
/// What the law of each body takes for softening: the plastic strain of a point and the size of its cell, or, where the
/// scene gives an averaging length, the average of the strain and the width of a band (transfer/nonlocal_strain.h).
#include <memory>
#include <vector>

#include "particles/body.h"
#include "transfer/nonlocal_strain.h"

namespace talus {

template <int dim>
class SofteningStrain {
 public:
  SofteningStrain(const BackgroundMesh<dim> &mesh, const std::vector<std::unique_ptr<Body<dim>>> &bodies) {
    for (const auto &body : bodies) {
      const double length = body->averaging_length();
      average_.push_back(length > 0 ? std::make_unique<NonlocalStrain<dim>>(
                                          mesh, length, plastic_strain_field(body->law()), body->history_count())
                                    : nullptr);
    }
  }

  /// By what the law of a body sees more plastic strain than its points have; null: by nothing.
  const double *excess(size_t body) const { return average_[body] ? average_[body]->excess() : nullptr; }
  /// Which internal variable that is, where there is an average.
  int field(size_t body) const { return average_[body] ? average_[body]->field() : 0; }
  /// Width of a band, [cell] [m].
  const double *size(size_t body, const FilledGrid<dim> &grid) const {
    return average_[body] ? average_[body]->size() : grid.size.data();
  }
  bool averages(size_t body) const { return average_[body] != nullptr; }

  /// At a remap, and after an accepted step. Collective.
  PetscErrorCode begin(FilledGrid<dim> &grid, const std::vector<PointSet> &points) {
    PetscFunctionBeginUser;
    for (size_t b = 0; b < points.size(); ++b)
      if (average_[b]) PetscCall(average_[b]->begin(grid, points[b]));
    PetscFunctionReturn(0);
  }
  PetscErrorCode update(FilledGrid<dim> &grid, const std::vector<PointSet> &points) {
    PetscFunctionBeginUser;
    for (size_t b = 0; b < points.size(); ++b)
      if (average_[b]) PetscCall(average_[b]->update(grid, points[b]));
    PetscFunctionReturn(0);
  }
  void serialize(size_t body, Archive &archive, const FilledGrid<dim> &grid, const typename FilledGrid<dim>::Rows &rows,
                 const Archive::Rows &points) {
    if (average_[body]) average_[body]->serialize(archive, grid, rows, points);
  }

 private:
  std::vector<std::unique_ptr<NonlocalStrain<dim>>> average_;  ///< per body; null: the strain of the point itself
};

}  // namespace talus
