#pragma once
/// What bounds the step of a run, docs/theory section 5.2: the fastest cell or the whole filled mesh.
#include <string>
#include <vector>

#include "physics/laws/law.h"
#include "scene/scene.h"
#include "simulation.h"
#include "solvers/integrators.h"

namespace talus {

struct StepBound {
  FrequencyBound by;  ///< cells or mesh
  std::string why;    ///< a clause for logs and pages
  std::string water;  ///< a sentence on pore pressure, or ""
  std::string sentence() const;
};

/// What `integrator.omega_max` stands for in this scene with these bodies, whose mesh may be a slice one cell thick.
/// `water`: what is to be said of pore pressure.
StepBound choose_step_bound(const Scene &scene, const std::vector<Law> &laws, const std::vector<BodyReport> &bodies,
                            const IntegratorSettings &settings, bool slice, const std::string &water);
/// The settings with that bound in the place of `automatic`.
IntegratorSettings with_bound(IntegratorSettings settings, FrequencyBound bound);

}  // namespace talus
