#pragma once
/// Drag between skeleton and fluids at a node, implicit and in closed form, docs/theory/pores.md (4.6).
namespace talus {

/// One fluid at a node: its partial mass [kg], M = sum w rho_l [kg] and Q = phi V / k, with k the mean conductivity k
/// k_r / mu [kg/s].
struct NodalFluid {
  double mass, whole_mass, resistance;
};

/// d of (4.6) over a step gamma [s].
inline double drag_number(double gamma, const NodalFluid &at) {
  return at.whole_mass > 0 ? gamma * at.resistance / at.whole_mass : 0;
}

/// The drag at a node over a step gamma [s].
template <int fluids>
class DragOverStep {
 public:
  DragOverStep(double gamma, double solid_mass, const NodalFluid *node) : solid_mass_(solid_mass), mass_(solid_mass) {
    for (int a = 0; a < fluids; ++a) {
      const double d = drag_number(gamma, node[a]);
      factor_[a] = d / (1 + d), taken_[a] = node[a].mass * factor_[a];
      mass_ += taken_[a];
    }
  }
  /// For one velocity component: `solid` and `fluid` go from their values without drag to those with it. Momentum is
  /// conserved to round-off; where the drag is large all move together, where it vanishes nothing changes. `supported`:
  /// a support prescribes the velocity of the solid and takes the drag on it.
  void resolve(double &solid, double *fluid, bool supported = false) const {
    double momentum = solid_mass_ * solid;
    for (int a = 0; a < fluids; ++a) momentum += taken_[a] * fluid[a];
    if (!supported) solid = momentum / mass_;
    for (int a = 0; a < fluids; ++a) fluid[a] += factor_[a] * (solid - fluid[a]);
  }

 private:
  double solid_mass_, mass_, factor_[fluids], taken_[fluids];
};

template <int fluids>
inline void resolve_drag(double gamma, double solid_mass, double &solid, const NodalFluid *node, double *fluid,
                         bool supported = false) {
  DragOverStep<fluids>(gamma, solid_mass, node).resolve(solid, fluid, supported);
}

}  // namespace talus
