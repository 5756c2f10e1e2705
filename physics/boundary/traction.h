#pragma once
#include <string>
#include <vector>

#include "base/units.h"
#include "base/vec.h"
#include "scene/function.h"

namespace talus {

/// Traction on a face: a vector, or a pressure that pushes against the face. Acts on the facets whose cell holds soil.
struct Traction {
  static constexpr const char *name = "traction";
  std::vector<Function> traction;
  Function pressure;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.functions("traction", traction, pascal, "traction, one function of x, y, z, t per component");
    v.function("pressure", pressure, pascal, {-1e12, 1e12}, "pressure against the face, function of x, y, z, t");
  }
  std::string problem() const {
    return traction.empty() == !pressure.given() ? "give either traction or pressure" : "";
  }

  template <int dim>
  Vec<dim> load(const Vec<dim> &normal, const Vec<dim> &x, double t) const {
    const double z = dim == 3 ? x[2] : 0;
    Vec<dim> force;
    for (int d = 0; d < dim; ++d)
      force[d] = traction.empty() ? -pressure(x[0], x[1], z, t) * normal[d] : traction[d](x[0], x[1], z, t);
    return force;
  }
};

}  // namespace talus
