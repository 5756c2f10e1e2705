// Velocities between acceleration and motion: supports, drag, what particles map back; theory (4.9) and section 6;
// included only where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"

namespace talus {

/// What supports feel in a step gamma of fluids, where there are any; what is captured fits into a std::function
/// without memory of its own.
template <int dim, class Phases>
typename Conditions<dim>::Pores SoilMotion<dim, Phases>::contact(double gamma) {
  if constexpr (Phases::liquid)
    return {[this, gamma](int i) { return fluid_.inertia(gamma, grid_, pore_conditions_, i); },
            [this](int i, const Vec<dim> &n) { return fluid_.thrust(pore_frame(false).gravity, i, n); }};
  return {};
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::drag(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v);
  if constexpr (Phases::liquid)
    fluid_.resist(gamma, pore_frame(false), pore_conditions_, velocity, velocity + grid_.node_count());
  conditions_.resolve(loading.time_at(t), gamma, grid_, velocity, contact(gamma));
  if constexpr (Phases::liquid)
    fluid_.follow(gamma, pore_frame(false), pore_conditions_, velocity, velocity + grid_.node_count());
  PetscFunctionReturn(0);
}

/// Fluids follow the skeleton where supports hold it; its own velocity stays free, as in the rates.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::resist(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) {
    const int nodes = grid_.node_count();
    Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v), *held = scratch_.data();
    fluid_.resist(gamma, pore_frame(false), pore_conditions_, velocity, velocity + nodes);
    std::copy_n(velocity, nodes, held);
    conditions_.constrain(loading.time_at(t), grid_, held, true);
    fluid_.follow(gamma, pore_frame(false), pore_conditions_, held, velocity + nodes);
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::hold(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v);
  conditions_.resolve(loading.time_at(t), gamma, grid_, velocity, contact(gamma));
  if constexpr (Phases::liquid)
    fluid_.constrain(pore_frame(false), pore_conditions_, velocity, velocity + grid_.node_count());
  PetscFunctionReturn(0);
}

/// Imposes on velocities of places, of all phases, what boundaries prescribe.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::constrain(double t, Vec<dim> *v) {
  conditions_.constrain(loading.time_at(t), grid_, v, true);
  if constexpr (Phases::liquid) fluid_.constrain(pore_frame(false), pore_conditions_, v, v + grid_.node_count());
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::map_back(double t, double gamma, double *v, double *w) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v), *mapped = reinterpret_cast<Vec<dim> *>(w);
  const int nodes = grid_.node_count();
  if constexpr (Phases::liquid) {  // drag and walls act on what particles would map back, as after a remap: that
                                   // becomes the state
    const int all = nodes * velocity_fields<Phases>;
    const double share = relaxes() ? 1 - std::exp(-gamma / relaxation_time_) : 0;
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) scratch_[i][d] = velocity[i][d] - (1 - share) * before_[i][d];
    PetscCall(back_and_forth(scratch_.data(), mapped));
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) mapped[i][d] += (1 - share) * before_[i][d];
    constrain(t, mapped);
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) {
        start_velocity_[i][d] += mapped[i][d] - velocity[i][d];  // particles take the change that is not mapped
        velocity[i][d] = before_[i][d] = mapped[i][d];
      }
    PetscFunctionReturn(0);
  }
  if (relaxes()) {
    PetscCall(back_and_forth(velocity, mapped));
    const double share = 1 - std::exp(-gamma / relaxation_time_), own = relaxed(t + gamma);
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) {
        velocity[i][d] += share * (mapped[i][d] - velocity[i][d]);
        mapped[i][d] += own * mapped_start_[i][d];
      }
    constrain(t, velocity);
  } else {  // the same sum, mapped once
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) scratch_[i][d] = velocity[i][d] - start_velocity_[i][d];
    PetscCall(back_and_forth(scratch_.data(), mapped));
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) mapped[i][d] += start_velocity_[i][d];
  }
  constrain(t, mapped);
  PetscFunctionReturn(0);
}

/// Supports and bases hold the places in every stage; what they take from the velocity is taken once, by `drag` after
/// the step.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::rates(double t, const double *u, const double *v, double *du, double *dv) {
  PetscFunctionBeginUser;
  PetscCall(acceleration(t, u, v, dv));
  const int nodes = grid_.node_count(), all = nodes * velocity_fields<Phases>;
  Vec<dim> *held = scratch_.data(), *mapped = reinterpret_cast<Vec<dim> *>(du),
           *change = reinterpret_cast<Vec<dim> *>(dv);
  std::copy_n(reinterpret_cast<const Vec<dim> *>(v), all, held);
  constrain(t, held);
  if (relaxes()) {
    PetscCall(back_and_forth(held, mapped));
    const double own = relaxed(t);
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) {
        change[i][d] -= (held[i][d] - mapped[i][d]) / relaxation_time_;
        mapped[i][d] += own * mapped_start_[i][d];
      }
  } else {  // the same sum, mapped once
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) held[i][d] -= start_velocity_[i][d];
    PetscCall(back_and_forth(held, mapped));
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) mapped[i][d] += start_velocity_[i][d];
  }
  constrain(t, mapped);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
double SoilMotion<dim, Phases>::seen_square(const double *x) const {
  double sum = 0;
  for (int f = 0; f < velocity_fields<Phases>; ++f) {
    const Vec<dim> *field = reinterpret_cast<const Vec<dim> *>(x) + f * grid_.node_count();
    for (int c = 0; c < grid_.cell_count(); ++c) {
      const auto &node = grid_.shape[c].node;
      const auto &matrix = grid_.mass_matrix[c];
      for (int d = 0; d < dim; ++d)
        for (int k = 0, pair = dim + 1; k <= dim; ++k) {
          const double xk = field[node[k]][d];
          sum += matrix[k] * xk * xk;
          for (int l = k + 1; l <= dim; ++l, ++pair) sum += 2 * matrix[pair] * xk * field[node[l]][d];
        }
    }
  }
  return sum;
}

}  // namespace talus
