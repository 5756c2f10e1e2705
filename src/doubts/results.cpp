// Doubts about the state at the end of a run.
#include "base/rounded.h"
#include "doubts/doubts.h"
#include "physics/pores/fluids.h"
#include "scene/scene.h"

namespace talus {
namespace {

constexpr double visible_share = 0.01;  // of the volume of a body
/// How much of a body has a value beyond a limit.
struct Beyond {
  double share = 0;  ///< of its volume
  double most = 0;   ///< of all values
};

/// Of each body, for the values of a column times `sign`; nothing where the state lacks the column. Collective.
std::vector<Beyond> find_beyond(MPI_Comm comm, std::size_t bodies, const Snapshot &state, const char *name, double sign,
                                double limit) {
  const auto column = [&](const char *of) -> const std::vector<double> * {
    for (const Column &one : state.columns)
      if (one.name == of) return &one.values;
    return nullptr;
  };
  const auto *value = column(name), *volume = column("volume");
  if (!value || !volume) return {};  // of all ranks
  std::vector<Beyond> found(bodies);
  for (std::size_t b = 0; b < bodies; ++b) {
    double sums[2]{}, all[2], mine = 0;
    for (std::size_t i = 0; i < state.body.size(); ++i) {
      if (state.body[i] != static_cast<int>(b)) continue;
      sums[0] += (*volume)[i];
      if (!(sign * (*value)[i] > limit)) continue;
      sums[1] += (*volume)[i], mine = std::max(mine, sign * (*value)[i]);
    }
    MPI_Allreduce(sums, all, 2, MPI_DOUBLE, MPI_SUM, comm);
    MPI_Allreduce(&mine, &found[b].most, 1, MPI_DOUBLE, MPI_MAX, comm);
    found[b].share = all[0] > 0 ? all[1] / all[0] : 0;
  }
  return found;
}

}  // namespace

std::vector<std::string> doubts_about_end(const Scene &scene, MPI_Comm comm, const std::vector<BodyReport> &bodies,
                                          const Snapshot &state) {
  constexpr double large = 10;         // plastic strain
  constexpr double nearly_all = 0.95;  // of the suction at which water cavitates; smoothing takes a little of it
  Doubts doubts(scene);
  const std::vector<Beyond> sheared = find_beyond(comm, bodies.size(), state, "plastic_strain", 1, large);
  for (std::size_t b = 0; b < sheared.size(); ++b)
    if (sheared[b].share > visible_share)
      doubts.say(
          "plastic_strain",
          rounded(100 * sheared[b].share) + " % of body." + bodies[b].name + " has a plastic strain above " +
              rounded(100 * large) + " %, up to " + rounded(100 * sheared[b].most) +
              " %: that is slip over the width of a cell or two, and no strain of a soil; look at displacements");
  if (scene.phases != PhaseModel::saturated) return doubts.sentences();
  const std::vector<Beyond> torn =
      find_beyond(comm, bodies.size(), state, "pore_pressure", -1, -nearly_all * cavitation_pressure);
  for (std::size_t b = 0; b < torn.size(); ++b)
    if (torn[b].share > visible_share)
      doubts.say("cavitation", "the water in " + rounded(100 * torn[b].share) + " % of body." + bodies[b].name +
                                   " cavitates at the end, at " + rounded(cavitation_pressure / 1e3) +
                                   " kPa: where air comes in instead, less suction holds the soil together");
  return doubts.sentences();
}

}  // namespace talus
