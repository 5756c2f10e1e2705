#include "simulation/pore_integration.h"

#include "base/rounded.h"
#include "physics/phase_models.h"
#include "scene/reader.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"
#include "solvers/integrators.h"

namespace talus {

std::optional<PoreRefusal> implicit_pressure_refused(const Scene &scene) {
  const PhaseTraits phases = phase_traits(scene.phases);
  DeferredTable table = scene.integrator;
  if (!phases.liquid)
    return PoreRefusal{"water.pressure",
                       "can be \"implicit\" only where pore water moves: take phases = \"saturated\" or "
                       "\"unsaturated\", or leave it out"};
  if (phases.gas)
    return PoreRefusal{"water.pressure",
                       "must be \"explicit\" with phases = \"three-phase\", where waves in the gas bound the step too; "
                       "leave it out, or take phases = \"unsaturated\", whose gas is at rest"};
  if (!std::holds_alternative<EulerSettings>(read_integrator(table, phases.liquid)))
    return PoreRefusal{"water.pressure",
                       "can be \"implicit\" only with integrator.kind = \"euler\": an implicit pressure is of first "
                       "order in time, whatever the integrator; take that, or leave it out"};
  if (scene.water->storage == PoreStorage::rate)
    return PoreRefusal{"water.storage", "must be \"mass\" with water.pressure = \"implicit\"; leave it out"};
  if (scene.water->drag == PoreDrag::at_start)
    return PoreRefusal{"water.drag", "must be \"implicit\" with water.pressure = \"implicit\"; leave it out"};
  if (!scene.transfer->average_stress)
    return PoreRefusal{
        "transfer.average_stress",
        "must be true with water.pressure = \"implicit\": water is shared by the particles of a cell; leave it out"};
  if (scene.transfer->pore_smoothing == PoreSmoothing::none)
    return PoreRefusal{"transfer.pore_smoothing",
                       "must be \"nodal\" with water.pressure = \"implicit\", which is one of nodes; leave it out"};
  if (phases.suction && scene.transfer->locking == Locking::nodal)
    return PoreRefusal{"transfer.locking",
                       "must be \"patches\" or \"none\" with water.pressure = \"implicit\" and phases = "
                       "\"unsaturated\"; leave it out"};
  return {};
}

/// Friction acts after the pressure is found: it would squeeze pores whose water no longer gives way in the step.
std::optional<PoreRefusal> implicit_pressure_refused(const std::vector<NamedBoundary> &boundaries) {
  for (const NamedBoundary &source : boundaries)
    if (source.kind.in_motion == OnSoil::contact)
      return PoreRefusal{
          "boundary." + source.name + ".kind",
          "rubs on the soil after its pore pressures are found, which water.pressure = \"implicit\" does "
          "not allow: take fixed, roller or tied, or water.pressure = \"explicit\""};
  return {};
}

PoreIntegrationChoice choose_pore_integration(const Scene &scene, const std::vector<NamedBoundary> &boundaries,
                                              double explicit_step, double implicit_step) {
  // of a step over an explicit one: of `talus bench`; of moving soil that may dry, docs/gallery/implicit_pressure
  const double cost = phase_traits(scene.phases).suction ? 30 : 3;
  const std::string chosen[] = {"pore pressure is explicit in time (water.pressure = \"auto\"): ",
                                "pore pressure is implicit in time (water.pressure = \"auto\"): "};
  auto refusal = implicit_pressure_refused(scene);
  if (!refusal) refusal = implicit_pressure_refused(boundaries);
  if (refusal) return {false, chosen[0] + refusal->key + " " + refusal->text};
  const bool pays = implicit_step > cost * explicit_step;
  return {pays, chosen[pays] + "critical steps are " + rounded(explicit_step) + " s with explicit and " +
                    rounded(implicit_step) + " s with implicit pressure, which takes " + rounded(cost) +
                    " times as long per step"};
}

}  // namespace talus
