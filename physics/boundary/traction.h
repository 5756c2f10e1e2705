#pragma once
#include <string>
#include <vector>

#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// Load on a face of soil, which it follows: force per undeformed area at the undeformed place (a dead load), or a
/// pressure against the face as it is now, where it is now. Acts on the facets that have soil behind them at the start,
/// docs/theory (6.4), (6.5).
struct Traction {
  static constexpr const char *name = "traction";
  static constexpr OnSoil in_motion = OnSoil::load, quasi_static = OnSoil::load;
  static constexpr OnWater water = OnWater::surface;
  static constexpr OnGas gas = OnGas::surface;
  std::vector<Function> traction;
  Function pressure;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.functions("traction", traction, pascal, of::place_and_time,
                "force per undeformed area, one function of the undeformed x, y, z and of t per component");
    v.function("pressure", pressure, pascal, {-1e12, 1e12, {-1e8, 1e8}}, of::place_and_time,
               "pressure normal to the deformed face, function of x, y, z, t");
  }
  std::string problem() const {
    return traction.empty() == !pressure.given() ? "give either traction or pressure" : "";
  }

  /// A pressure follows the face; a traction stays what it was on the undeformed one.
  bool follows() const { return traction.empty(); }
  /// Force per area on a face with normal n at x [Pa].
  template <int dim>
  Vec<dim> load(const Vec<dim> &normal, const Vec<dim> &x, double t) const {
    const double z = dim == 3 ? x[dim - 1] : 0;
    Vec<dim> force;
    for (int d = 0; d < dim; ++d)
      force[d] = follows() ? -pressure(x[0], x[1], z, t) * normal[d] : traction[d](x[0], x[1], z, t);
    return force;
  }
};

}  // namespace talus
