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

/// Pores that dry and conduct as if they were full, and such whose permeability is gone with the first water.
void doubt_permeability(const Scene &scene, std::vector<std::string> &sentences) {
  constexpr double first = 1e-3, steep = 0.5;
  if (std::ranges::none_of(scene.stage, [](const Stage &s) { return water_flows(s.kind); })) return;
  constexpr double coarse = 150, dry = 1e8;  // [Pa]: coarse sand keeps half of its water beyond that; no soil this
  for (const BodySource &body : scene.body) {
    if (!body.retention.reader) continue;
    const SoilPores own(body, scene.water.density, scene.water.viscosity);
    if (saturation(own.retention(), coarse) < (1 + saturation(own.retention(), dry)) / 2)
      sentences.push_back("body." + body.name + " loses half of its water at a suction below " + rounded(coarse) +
                          " Pa, a column of " + rounded(coarse / (scene.water.density * 9.81) * 1e3) +
                          " mm, as gravel does and no sand. Is the suction of its retention curve in kPa?");
    if (!body.relative_permeability.reader) {
      sentences.push_back("body." + body.name +
                          " has a retention curve and no relative_permeability: it conducts water as if its pores were "
                          "full, however dry they are. Give [body." +
                          body.name + ".relative_permeability], such as van_genuchten_mualem");
      continue;
    }
    const double left = own.at(first).liquid;
    if (left < steep)
      sentences.push_back(
          "body." + body.name + " conducts " + rounded(100 * left) +
          " % of what it conducts in full when a thousandth of its pores has dried: where water reaches "
          "such soil, seepage may find no flow however short its steps are. A larger shape of "
          "van_genuchten_mualem (0.2 or more), or a curve of another kind, is found");
  }
}

}  // namespace

void doubt_pores(const Scene &scene, std::vector<std::string> &sentences) {
  doubt_permeability(scene, sentences);
  if (scene.phases == PhaseModel::drained) doubt_early_suction(scene, sentences);
}

}  // namespace talus
