#include "doubts/doubts.h"

#include <limits>

#include "base/rounded.h"
#include "physics/laws/strength_by_place.h"
#include "physics/pores/fluids.h"
#include "scene/body_source.h"
#include "scene/reader.h"
#include "scene/stage.h"
#include "scene/usual.h"
#include "simulation/softening.h"

namespace talus {

void Doubts::add(const Doubt &doubt) {
  if (!scene_.acknowledges(doubt.name)) sentences_.push_back(doubt.text());
}

void Doubts::say(const std::vector<Relation> &table) {
  for (const Relation &row : table)
    if (row.holds) add({std::string(row.name.name), row.sentence});
}

Relation unusual(DoubtName name, const std::string &what, double value, Unit unit, const Usual &usual) {
  return {name, !is_usual(value, usual), what + " = " + rounded(value) + in(unit) + "; usual " + text_of(usual, unit)};
}

Relation unusual_height(double height) {
  Relation row = unusual("mesh_units", "height of the mesh", height, metre, {0.01, 5000});  // a table, a mountain
  row.sentence += "; coordinates count in metres: are they in another unit?";
  return row;
}

std::string Span::text(int axis) const {
  return std::string(1, axis_names[axis]) + " = " + rounded(from) + (to > from ? " to " + rounded(to) : "") + " m";
}

Start::Start(const Scene &of, std::vector<BodyReport> there, std::vector<SoilFace> its_faces)
    : scene(of), bodies(std::move(there)), surface(std::move(its_faces)), up(of.vertical()) {
  constexpr double far = std::numeric_limits<double>::infinity();
  low.fill(far), high.fill(-far);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (b < scene.body.size()) take_largest(laws.emplace_back(read_law(scene.body[b].law)), bodies[b].strength);
    for (int d = 0; d < 3 && bodies[b].particles > 0; ++d)
      low[d] = std::min(low[d], bodies[b].low[d]), high[d] = std::max(high[d], bodies[b].high[d]);
  }
  depth = surface.empty() ? 0 : depth_of({}, height());
}

double Start::depth_of(std::optional<std::size_t> body, double greatest) const {
  double ground = 0, volume = 0;
  for (const SoilFace &face : surface)
    if (!body || face.body == static_cast<int>(*body)) ground += face.area * std::max(0., face.normal[up]);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (!body || b == *body) volume += bodies[b].volume;
  return ground > 0 ? std::min(greatest, 2 * volume / ground) : greatest;
}

bool has_seepage(const Scene &scene) {
  return std::ranges::any_of(scene.stage, [](const Stage &stage) { return stage.seeps(); });
}
bool has_flow_in_motion(const Scene &scene) {
  return fluids_move(scene.phases) &&
         std::ranges::any_of(scene.stage, [](const Stage &stage) { return !stage.is_static() && stage.pore_flow; });
}
double end_of_loads(const Scene &scene) {
  double end = 0;
  for (const Stage &stage : scene.stage) end += stage.hold_loads ? 0 : stage.duration;
  return end;
}

std::vector<std::string> doubts_about(const Start &start) {
  Doubts doubts(start.scene);
  for (const auto &[path, doubt] : start.scene.root->unusual()) doubts.add(doubt);
  for (const std::string &sentence : brittle_soils(start.scene, start.laws, start.bodies))
    doubts.say({{"brittle", true, sentence}});
  doubt_scene(start, doubts);
  if (start.scene.gravity_size() == 0 || start.height() < 0) return doubts.sentences();  // later stages add all soil
  doubts.say({unusual_height(start.height())});
  doubt_water(start, doubts);
  doubt_ends(start, doubts);
  return doubts.sentences();
}

std::vector<std::string> doubts_about_end(const Scene &scene, MPI_Comm comm, const std::vector<BodyReport> &bodies,
                                          const Snapshot &state) {
  constexpr double nearly_all = 0.95;  // of the suction at which water cavitates; smoothing takes a little of it
  constexpr double share = 0.01;       // of the volume of a body
  Doubts doubts(scene);
  const auto pressure = std::ranges::find(state.columns, "pore_pressure", &Column::name),
             volume = std::ranges::find(state.columns, "volume", &Column::name), none = state.columns.end();
  if (scene.phases != PhaseModel::saturated || pressure == none || volume == none) return doubts.sentences();
  std::vector<double> torn(2 * bodies.size());  // volume that cavitates and all volume, of each body [m3]
  for (std::size_t i = 0; i < state.body.size(); ++i) {
    double *of = torn.data() + 2 * static_cast<std::ptrdiff_t>(state.body[i]);
    of[1] += volume->values[i];
    if (pressure->values[i] < nearly_all * cavitation_pressure) of[0] += volume->values[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, torn.data(), static_cast<int>(torn.size()), MPI_DOUBLE, MPI_SUM, comm);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    doubts.say({{"cavitation", torn[2 * b] > share * torn[2 * b + 1],
                 "the water in " + rounded(100 * torn[2 * b] / torn[2 * b + 1]) + " % of body." + bodies[b].name +
                     " cavitates at the end, at " + rounded(cavitation_pressure / 1e3) +
                     " kPa: where air comes in instead, less suction holds the soil together"}});
  return doubts.sentences();
}

void say_doubts(RunOptions &options, const Scene &scene) {
  options.doubts_at_start = [&scene](AnySimulation &run) { return doubts_about(Start(scene, run)); };
  options.doubts_at_end = [&scene](AnySimulation &run) {
    return doubts_about_end(scene, PETSC_COMM_WORLD, run.bodies(), run.snapshot());
  };
}

}  // namespace talus
