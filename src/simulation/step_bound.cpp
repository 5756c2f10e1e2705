#include "simulation/step_bound.h"

#include "physics/phase_models.h"
#include "scene/quantity.h"
#include "scene/scene.h"
#include "simulation/softening.h"

namespace talus {
namespace {

/// Why the frequency of the mesh is not the default here; empty where it is.
std::string objection(const Scene &scene, const std::vector<Law> &laws, const std::vector<BodyReport> &bodies,
                      const IntegratorSettings &settings, bool slice) {
  const StepRule rule = step_rule(settings);
  constexpr double largest_share = 0.8;  // the iteration comes from below, docs/theory section 5.2
  if (scene.dimension == 2 || slice) return "in plane strain such long steps change the time of failure";
  if (phase_traits(scene.phases).liquid) return "pore pressures of single cells scatter more in such long steps";
  if (rule.fixed > 0) return "integrator.step is fixed";
  if (rule.share > largest_share) return "integrator.fraction is above " + shortest(largest_share);
  for (const Law &law : laws)
    if (stiffens(law))
      return std::string("soil of the law ") + law_name(law) + " may become stiffer than its moduli at the start";
  if (!brittle_soils(scene, laws, bodies).empty())
    return "where softening is brittle such long steps change the load at failure";
  return "";
}

}  // namespace

StepBound choose_step_bound(const Scene &scene, const std::vector<Law> &laws, const std::vector<BodyReport> &bodies,
                            const IntegratorSettings &settings, bool slice, const std::string &water) {
  const FrequencyBound asked = step_rule(settings).bound;
  if (asked == FrequencyBound::cells) return {asked, "integrator.omega_max = \"cells\"", water};
  if (asked == FrequencyBound::mesh) return {asked, "integrator.omega_max = \"mesh\"", water};
  const std::string objection = talus::objection(scene, laws, bodies, settings, slice);
  if (objection.empty()) return {FrequencyBound::mesh, "integrator.omega_max = \"auto\", on tetrahedra", water};
  return {FrequencyBound::cells, "integrator.omega_max = \"auto\", and " + objection, water};
}

std::string StepBound::sentence() const {
  return std::string("the critical step is that of ") +
         (by == FrequencyBound::mesh ? "the whole filled mesh" : "the fastest filled cell") + " (" + why + ")" +
         (water.empty() ? "" : "; " + water);
}

IntegratorSettings with_bound(IntegratorSettings settings, FrequencyBound bound) {
  std::visit(
      [bound](auto &kind) {
        if constexpr (requires { kind.bound; }) kind.bound = bound;
      },
      settings);
  return settings;
}

}  // namespace talus
