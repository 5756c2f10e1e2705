// Doubts about stages: what never acts in them, or is undone by them.
#include <algorithm>

#include "base/rounded.h"
#include "doubts/doubts.h"
#include "earthquake/sources.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/water_source.h"
#include "simulation/changing_loads.h"

namespace talus {

void doubt_stages(const Scene &scene, Doubts &doubts) {
  double end = 0;      // of the load time [s]
  std::string flowed;  // stage in which water has
  for (const Stage &stage : scene.stage) {
    const std::string name = "stage." + stage.name;
    if (!stage.hold_loads) end += stage.duration;
    if (stage.gravity_ramp() > stage.duration)
      doubts.say("gravity_ramp", name + ".gravity_ramp = " + rounded(stage.gravity_ramp()) +
                                     " s is longer than the stage: "
                                     "gravity does not come to its full value in it");
    const auto *fails = stage.motion() ? std::get_if<AtFailure>(&stage.motion()->until) : nullptr;
    if (fails && fails->failure_time > stage.duration)
      doubts.say("failure_time", name + ".failure_time = " + rounded(fails->failure_time) +
                                     " s is longer than the stage: "
                                     "it finds no failure");
    if (!stage.pore_flow && !stage.water_flows() && !flowed.empty())
      doubts.say("pore_flow", name + ".pore_flow = false gives the pores the pressure of [water] again: what stage." +
                                  flowed + " has brought is undone");
    if (stage.water_flows()) flowed = stage.name;
  }
  const auto shakes = [](const Stage &stage) { return stage.shakes(); };
  if (!scene.earthquake.empty() && std::ranges::none_of(scene.stage, shakes))
    doubts.say("idle_earthquake", "no stage has earthquake = true: the motion of [[earthquake]] acts in none");
  for (const EarthquakeSource &component : scene.earthquake)
    if (const std::string sentence = drift_of(read_motion(component)); !sentence.empty()) doubts.say("drift", sentence);
  for (const ChangingLoad &load : changing_loads(scene)) {
    const double begin = std::ranges::min_element(load.when, {}, &TimeSpan::begin)->begin;
    if (end == 0)
      doubts.say("late_load", load.key + " is a function of t, and all stages hold their loads: it acts as at t = 0");
    else if (begin >= end)
      doubts.say("late_load", load.key + " changes from t = " + rounded(begin) +
                                  " s on, and the loads of the stages end at t = " + rounded(end) +
                                  " s: it acts as at t = 0 in all of the run");
  }
  const auto flows = [](const Stage &stage) { return stage.water_flows(); };
  for (const BodySource &body : scene.body)
    if (std::ranges::any_of(scene.stage, flows) && body.retention.reader && !body.relative_permeability.reader)
      doubts.say("relative_permeability", "body." + body.name +
                                              " has a retention curve and no relative_permeability: it conducts "
                                              "water as if its pores were full");
  if (scene.phases == PhaseModel::drained && scene.water->suction.given() && has_seepage(scene) &&
      !scene.stage.front().seeps())
    doubts.say("early_suction", "water.suction acts from the first stage of seepage on: the soil of stage." +
                                    scene.stage.front().name +
                                    " has none; put a stage of seepage with hold_loads = true before it");
}

}  // namespace talus
