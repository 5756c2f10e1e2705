// What is unlikely of stages: loads that never act, gravity that never acts in full.
#include <algorithm>
#include <sstream>

#include "base/rounded.h"
#include "physics/boundary/boundary.h"
#include "simulation/changing_loads.h"
#include "simulation/unlikely.h"
#include "simulation/unlikely_parts.h"

namespace talus {
namespace {

/// Finite elements after soil has slid.
void doubt_elements_after_a_slide(const Scene &scene, std::vector<std::string> &sentences) {
  for (std::size_t s = 1; s < scene.stage.size(); ++s) {
    const Stage &stage = scene.stage[s], &before = scene.stage[s - 1];
    if (is_static(stage.kind) && !is_static(before.kind) && before.damping == 0)
      sentences.push_back("stage." + stage.name + " computes by finite elements, after the motion of stage." +
                          before.name +
                          ", what has the soil at its place at the start: where soil slides out of the region of its "
                          "body, the run ends there");
  }
}

/// Stages that prescribe the pressure of the table anew after water has flowed.
void doubt_water_undone(const Scene &scene, std::vector<std::string> &sentences) {
  std::string flowed;
  for (const Stage &stage : scene.stage) {
    if (!stage.pore_flow && !water_flows(stage.kind) && !flowed.empty())
      sentences.push_back("stage." + stage.name +
                          ".pore_flow = false gives the pores the pressure of [water] again: what stage." + flowed +
                          " has brought or taken is undone. Leave it out where water is to stay as it is");
    if (water_flows(stage.kind)) flowed = stage.name;
  }
}

}  // namespace

void doubt_stages(const Scene &scene, std::vector<std::string> &sentences) {
  double end = 0;  // of the load time [s]
  for (const Stage &stage : scene.stage) {
    if (!stage.hold_loads) end += stage.duration;
    if (stage.gravity_ramp > stage.duration)
      sentences.push_back("stage." + stage.name + ".gravity_ramp is " + rounded(stage.gravity_ramp) +
                          " s, longer than the duration of " + rounded(stage.duration) +
                          " s: gravity does not come to its full value in it");
    if (stage.until == StopWhen::failure && stage.failure_time > stage.duration)
      sentences.push_back("stage." + stage.name + ".failure_time is " + rounded(stage.failure_time) +
                          " s, longer than the duration of " + rounded(stage.duration) +
                          " s: no failure is found in it");
  }
  for (const ChangingLoad &load : changing_loads(scene)) {
    const auto first = std::ranges::min_element(load.when, {}, &TimeSpan::begin);
    if (end > 0 && first->begin < end) continue;
    std::ostringstream text;
    text << load.key;
    if (end > 0)
      text << " changes only from t = " << rounded(first->begin) << " s on, and the stages end at t = " << rounded(end)
           << " s: it acts as it does at t = 0 in all of the run. Give the stages more time";
    else
      text << " is a function of t, and all stages hold their loads: it acts as it does at t = 0 in all of the run. "
              "Give a stage without hold_loads";
    text << ", or leave the function out";
    sentences.push_back(text.str());
  }
  doubt_elements_after_a_slide(scene, sentences);
  doubt_water_undone(scene, sentences);
}

std::string one_element_across(const Scene &scene, const std::string &body) {
  // a base with friction has no quadratic elements in 3D
  const bool on_base = scene.dimension == 3 && std::ranges::any_of(scene.boundary, [](const BoundarySource &source) {
                         return read_boundary(source.kind).quasi_static == OnSoil::contact;
                       });
  return "body." + body +
         " is one element across, which elements of first order cannot resolve; refine the mesh there" +
         (on_base ? "" : ", or set quasi_static.elements = \"quadratic\"");
}

void doubt_thin_bodies(const Scene &scene, const std::vector<BodyReport> &bodies, std::vector<std::string> &sentences) {
  const auto first = std::ranges::find_if(scene.stage, [](const Stage &stage) { return is_static(stage.kind); });
  if (first == scene.stage.end() || scene.quasi_static.elements == Elements::quadratic) return;
  for (const BodyReport &body : bodies)
    if (body.one_element_across)
      sentences.push_back("stage." + first->name + " will end the run: " + one_element_across(scene, body.name));
}

}  // namespace talus
