// Doubts about the water table of the scene and its pressures.
#include "base/rounded.h"
#include "doubts/doubts.h"
#include "physics/phase_models.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/water_source.h"

namespace talus {
namespace {

/// The water table of [water], which lies level beyond its ends.
void doubt_table(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  const WaterTable &table = scene.water->table;
  if (!table.given()) return;
  const auto &points = table.points;
  if (points.size() > 1 && (points.front()[0] >= start.high[0] || points.back()[0] <= start.low[0]))
    doubts.say("water_table", "water.table runs from x = " + rounded(points.front()[0]) + " to " +
                                  rounded(points.back()[0]) + " m, beside the soil, which lies from " +
                                  rounded(start.low[0]) + " to " + rounded(start.high[0]) + " m");
  Span elevation;
  for (const auto &point : points) elevation.widen(point[1]);
  for (const SoilFace &face : start.surface)
    for (int a = 0; a < scene.dimension && points.empty(); ++a) elevation.widen(table_at(table, face.corner[a]));
  const double level = scene.water->level(0), top = start.high[start.up], bottom = start.low[start.up];
  if (elevation.from + level > top + 2 * start.height())
    doubts.say("water_table", "water.table stands " + rounded(elevation.from + level - top) +
                                  " m or more above the top of the soil, which is " + rounded(start.height()) +
                                  " m high");
  const bool lasts = !has_seepage(scene) && !scene.water->level.depends_on_time();
  if (lasts && scene.phases == PhaseModel::drained && elevation.to + level <= bottom)
    doubts.say("water_table", "water.table lies at " + rounded(elevation.to + level) + " m or lower, below all soil (" +
                                  rounded(bottom) + " m): it gives no pore pressure");
}

/// Soil counts as wet below a water table; an excess presses and fills no pores. Pores that are full everywhere have
/// one weight.
void doubt_excess_alone(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  const Function &excess = scene.water->excess;
  if (scene.phases != PhaseModel::drained || scene.water->table.given() || (excess.constant() && excess(0) == 0))
    return;
  for (const BodySource &body : scene.body)
    if (((body.saturation > 0 && body.saturation < 1) || body.saturated_unit_weight > 0) && !body.water_table.given() &&
        body.pore_pressure_ratio == 0)
      doubts.say("excess_alone", "water.excess is the only pore pressure of body." + body.name +
                                     ": without a water.table all of this soil has the weight above one");
}

/// The table is what pores begin with where their water moves, and no stage looks at it again unless it prescribes the
/// pressure.
void doubt_changing_table(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  if (!phase_traits(scene.phases).liquid ||
      std::ranges::any_of(scene.stage, [](const Stage &s) { return s.is_static() || !s.pore_flow; }))
    return;
  if (scene.water->level.depends_on_time() || scene.water->excess.depends_on_time())
    doubts.say("changing_table",
               "water.level or water.excess changes with time, and pore water moves in all stages: only its value at "
               "the start counts. Water that rises beside the soil is a boundary with kind = \"head\"");
}

}  // namespace

void doubt_water(const Start &start, Doubts &doubts) {
  doubt_table(start, doubts);
  doubt_excess_alone(start, doubts);
  doubt_changing_table(start, doubts);
}

}  // namespace talus
