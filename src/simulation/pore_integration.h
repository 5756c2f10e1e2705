#pragma once
/// Whether pore pressure is explicit or implicit in time, docs/theory/pores.md section 8: what the scene asks for, or,
/// with `water.pressure = "auto"`, what takes less time.
#include <optional>
#include <string>
#include <vector>

#include "physics/boundary/boundary.h"
#include "scene/scene.h"

namespace talus {

struct PoreIntegrationChoice {
  bool implicit = false;
  std::string sentence;  ///< what was chosen and why; empty where nothing was to choose
};

/// What implicit pressure cannot bear: a key of the scene, and what is wrong with it.
struct PoreRefusal {
  std::string key, text;
};
std::optional<PoreRefusal> implicit_pressure_refused(const Scene &scene);
std::optional<PoreRefusal> implicit_pressure_refused(const std::vector<NamedBoundary> &boundaries);

/// The choice of `auto`, from the critical steps with explicit and with implicit pressure [s].
PoreIntegrationChoice choose_pore_integration(const Scene &scene, const std::vector<NamedBoundary> &boundaries,
                                              double explicit_step, double implicit_step);

}  // namespace talus
