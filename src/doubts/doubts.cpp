#include "doubts/doubts.h"

#include "base/rounded.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/usual.h"
#include "simulation/softening.h"

namespace talus {

void Doubts::add(const Doubt &doubt) {
  if (!scene_.acknowledges(doubt.name)) sentences_.push_back(doubt.text());
}

void Doubts::say(DoubtName name, const std::string &sentence) { add({std::string(name.name), sentence}); }

void Doubts::say_unusual(DoubtName name, const std::string &what, double value, Unit unit, const Usual &usual) {
  if (!is_usual(value, usual)) say(name, what + " = " + rounded(value) + in(unit) + "; usual " + text_of(usual, unit));
}

std::string Span::text(int axis) const {
  return std::string(1, axis_names[axis]) + " = " + rounded(from) + (to > from ? " to " + rounded(to) : "") + " m";
}

std::vector<std::string> doubts_about(const Start &start) {
  Doubts doubts(start.scene);
  for (const auto &[path, doubt] : start.scene.root->unusual()) doubts.add(doubt);
  for (const std::string &sentence : brittle_soils(start.scene, start.laws, start.bodies))
    doubts.say("brittle", sentence);
  doubt_stages(start.scene, doubts);
  doubt_soil(start, doubts);
  if (start.scene.gravity_size() == 0 || start.height() < 0) return doubts.sentences();  // later stages add all soil
  constexpr double lowest = 0.01;                                                        // [m], a test on a table
  if (const std::string sentence = unlikely_height(start.height()); !sentence.empty())
    doubts.say("mesh_units", sentence);
  if (start.height() < lowest)
    doubts.say("mesh_units", "the soil is " + rounded(start.height()) + " m high; is the mesh in kilometres?");
  doubt_water(start, doubts);
  doubt_water_boundaries(start, doubts);
  doubt_open_water(start, doubts);
  doubt_ends(start, doubts);
  return doubts.sentences();
}

std::string unlikely_height(double height) {
  constexpr double highest = 5000;  // [m], a mountain
  if (height <= highest) return "";
  return "the mesh is " + rounded(height) + " m high; coordinates count in metres: is it in millimetres or feet?";
}

void say_doubts(RunOptions &options, const Scene &scene) {
  options.doubts_at_start = [&scene](AnySimulation &run) { return doubts_about(Start(scene, run)); };
  options.doubts_at_end = [&scene](AnySimulation &run) {
    return doubts_about_end(scene, PETSC_COMM_WORLD, run.bodies(), run.snapshot());
  };
}

}  // namespace talus
