// Doubts about what pores hold and conduct.
#include "base/rounded.h"
#include "physics/boundary/boundary.h"
#include "physics/pores/soil_pores.h"
#include "simulation/unlikely_parts.h"

namespace talus {
namespace {

/// The suction of drained soil is where its seepage begins, and no stage before that sees it.
void doubt_early_suction(const Scene &scene, std::vector<std::string> &sentences) {
  const auto first = first_seepage(scene);
  if (scene.water.suction.given() && first != scene.stage.end() && first != scene.stage.begin())
    sentences.push_back("water.suction acts from the first stage of seepage on, " + first->name +
                        ": the soil of stage " + scene.stage.front().name +
                        " has none. If its strength depends on suction, put a stage of seepage with hold_loads = true "
                        "before it");
}

/// Pores that dry and conduct as if they were full.
void doubt_permeability(const Scene &scene, std::vector<std::string> &sentences) {
  if (std::ranges::none_of(scene.stage, [](const Stage &s) { return water_flows(s.kind); })) return;
  for (const BodySource &body : scene.body)
    if (body.retention.reader && !body.relative_permeability.reader)
      sentences.push_back("body." + body.name +
                          " has a retention curve and no relative_permeability: it conducts water as if its pores were "
                          "full, however dry they are. Give [body." +
                          body.name + ".relative_permeability], such as van_genuchten_mualem");
}

}  // namespace

void doubt_pores(const Scene &scene, std::vector<std::string> &sentences) {
  doubt_permeability(scene, sentences);
  if (scene.phases == PhaseModel::drained) doubt_early_suction(scene, sentences);
}

}  // namespace talus
