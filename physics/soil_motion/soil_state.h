#pragma once
/// State of the soil within a Lagrangian part: where its cells are and what their stress points carry. It exists twice:
/// the accepted state, which lies in the grid and in the stress points, and the trial state of integrators with stages,
/// which has arrays of its own.
#include <vector>

#include "base/room.h"
#include "transfer/filled_grid.h"
#include "transfer/stress_points.h"

namespace talus {

template <int dim>
struct SoilState {
  Vec<dim> *position = nullptr;         ///< [node] [m]
  Shape<dim> *shape = nullptr;          ///< [cell]
  std::vector<double> particle_volume;  ///< [cell] sum over the stress points [m3]
  std::vector<double> weight;           ///< [cell] integration volume, docs/theory (4.5) [m3]
  std::vector<double *> stress;         ///< [body][point][stress_size] [Pa]
  std::vector<double *> history;        ///< [body][point][history]
  std::vector<double *> volume;         ///< [body][point] [m3]
};

/// The accepted state: refers to the arrays in which the particles were gathered.
template <int dim>
struct AcceptedState : SoilState<dim> {
  AcceptedState(int cells, size_t bodies) {
    for (auto *field : {&this->particle_volume, &this->weight}) talus::make_room(*field, cells);
    this->stress.resize(bodies), this->history.resize(bodies), this->volume.resize(bodies);
  }
  void refer_to(FilledGrid<dim> &grid) { this->position = grid.position.data(), this->shape = grid.shape.data(); }
  void refer_to(const PointSet &points, size_t body) {
    this->stress[body] = points.stress, this->history[body] = points.history, this->volume[body] = points.volume;
  }
};

/// A trial state; nothing is allocated before the first one is asked for.
template <int dim>
class TrialState : public SoilState<dim> {
 public:
  /// Makes room for all nodes and cells of the grid ...
  void make_room(const FilledGrid<dim> &grid, size_t bodies) {
    own_position_.resize(grid.position.size()), own_shape_.resize(grid.cell_count());
    this->position = own_position_.data(), this->shape = own_shape_.data();
    this->particle_volume.resize(grid.cell_count()), this->weight.resize(grid.cell_count());
    for (auto *views : {&this->stress, &this->history, &this->volume}) views->resize(bodies);
    for (auto *arrays : {&own_stress_, &own_history_, &own_volume_}) arrays->resize(bodies);
  }
  /// ... and for the points of a body.
  void make_room(size_t body, int points, int history_count) {
    own_stress_[body].resize(static_cast<size_t>(points) * stress_size<dim>);
    own_history_[body].resize(static_cast<size_t>(points) * history_count), own_volume_[body].resize(points);
    this->stress[body] = own_stress_[body].data(), this->history[body] = own_history_[body].data();
    this->volume[body] = own_volume_[body].data();
  }

 private:
  std::vector<Vec<dim>> own_position_;
  std::vector<Shape<dim>> own_shape_;
  std::vector<std::vector<double>> own_stress_, own_history_, own_volume_;
};

}  // namespace talus
