#pragma once
#include <vector>

#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// Velocity prescribed as a function of place and time: the whole vector (a rough plate), or its component across the
/// face (a smooth one).
struct PrescribedVelocity {
  static constexpr const char *name = "velocity";
  static constexpr OnSoil in_motion = OnSoil::support, quasi_static = OnSoil::support;
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::wall;
  static constexpr int precedence = 0;
  std::vector<Function> velocity;
  bool smooth = false;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.functions("velocity", velocity, metre_per_second, of::place_and_time,
                "velocity, one function of x, y, z, t per component");
    v.flag("smooth", smooth, "prescribe only the component normal to the face");
  }
  std::string problem() const { return velocity.empty() ? "velocity must be given, one function per component" : ""; }

  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &normal) const {
    if (smooth) return {normal};
    return all_axes<dim>();
  }
  template <int dim>
  double speed(const Vec<dim> &direction, const Vec<dim> &x, double t) const {
    double sum = 0;
    for (int d = 0; d < dim; ++d) sum += direction[d] * velocity[d](x[0], x[1], dim == 3 ? x[2] : 0, t);
    return sum;
  }
};

}  // namespace talus
