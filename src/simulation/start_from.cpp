#include "simulation/start_from.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "scene/changes.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/tables.h"
#include "scene/words.h"

namespace talus {
namespace {

using Words = std::vector<std::string>;

/// Why a key must be what it was in the other run; empty: it may be another.
std::string tie_of(const Words &words, PhaseModel phases) {
  const std::string &table = words[0], key = words.size() > 1 ? words[1] : "", last = words.size() > 2 ? words[2] : "";
  static const std::set<std::string> free{"title",
                                          "acknowledge",
                                          "start_from",
                                          "stage",
                                          "integrator",
                                          "gravity",
                                          "mesh",  // the state tells meshes apart, by whatever path they are named
                                          "factor_of_safety",
                                          "output"};
  static const std::set<std::string> free_transfer{"velocity", "relaxation", "pic_fraction", "remap_interval"};
  static const std::set<std::string> free_water{"table", "level", "excess", "suction", "open_water_load"};
  static const std::set<std::string> tied_body{"region",
                                               "law",
                                               "density",
                                               "unit_weight",
                                               "saturated_unit_weight",
                                               "porosity",
                                               "grain_density",
                                               "saturation",
                                               "pore_pressure_ratio",
                                               "retention",
                                               "particles_per_cell",
                                               "dense",
                                               "velocity",
                                               "displacement",
                                               "stress",
                                               "averaging_length",
                                               "contact_group"};
  if (free.count(table)) return "";
  if (table == "body") {
    if (last.empty()) return "its bodies are those of that run";
    return tied_body.count(last) ? "its particles bring regions, masses, pores, stress and kind of law from there" : "";
  }
  if (table == "boundary")
    return last.empty() || last == "kind" || last == "group" ? "its boundaries have contacts and reactions from there"
                                                             : "";
  if (table == "rigid")
    return last.empty() || last == "polygon" || last == "centre"
               ? "its rigid bodies have their shapes, places and contacts from there"
               : "";
  if (table == "grids") return "functions of place took their values from it";
  if (table == "transfer") return free_transfer.count(key) ? "" : "its stress points are those of that run";
  if (table == "quasi_static") return key == "elements" ? "its Gauss points are those of that run" : "";
  if (table == "water" && phases == PhaseModel::drained && free_water.count(key)) return "";
  if (table == "water" || table == "gas") return "its pore fluids bring their masses and pressures from there";
  return "that run was of another kind";
}

/// Names the keys by which the mesh became another one. Where there are none, its file has changed, as the state says
/// later.
void check_mesh(const Scene &scene, const std::vector<std::string> &changed) {
  Words keys;
  for (const std::string &path : changed)
    if (path == "dimension" ||
        (split(path)[0] == "mesh" && path != "mesh.leaving_particles" && path != "mesh.balance_ranks"))
      keys.push_back(path);
  if (keys.empty()) return;
  const std::string first = keys[0];
  keys.erase(keys.begin());
  scene.complain(first, "is not what it was in the run " + scene.start_from->folder +
                            " that start_from names, so that its mesh was another one" +
                            (keys.empty() ? "" : " (others too: " + join(keys) + ")") +
                            ", and its particles, stresses and contacts belong to the cells of that mesh; give it the "
                            "value that it has there, or run that scene again with this one");
}

/// Refuses a gravity of another size where a unit weight gives the density: the particles bring that of the other run.
void check_unit_weights(const Scene &scene, const std::string &values_there) {
  Scene there;
  TableReader::from_text(values_there, scene.start_from->folder).fill(there);
  const double before = there.gravity_size();
  if (std::abs(scene.gravity_size() - before) <= 1e-12 * before) return;
  for (const BodySource &body : scene.body) {
    if (body.unit_weight == 0 && body.saturated_unit_weight == 0) continue;
    scene.complain("gravity",
                   "is not the " + shortest(before) + " m/s2 of the run " + scene.start_from->folder +
                       " that start_from names, and with it the unit weights of " + body.name +
                       " stand for another density than that of its particles, which come from there; give density, or "
                       "porosity and grain_density, in place of unit weights, and run that scene again so");
  }
}

}  // namespace

std::vector<std::string> check_start(const Scene &scene, const CheckpointHeader &found, const CheckpointHeader &mine) {
  if (found.program != mine.program)
    throw std::invalid_argument("it is one of " + found.program + ", this is " + mine.program);
  std::vector<std::string> others;
  const std::vector<std::string> changed = changed_keys(found.scene, mine.scene);
  if (found.mesh != mine.mesh) check_mesh(scene, changed);
  for (const std::string &path : changed) {
    const Words words = split(path);
    if (const std::string tie = tie_of(words, scene.phases); !tie.empty())
      scene.complain(path, "is not what it was in the run " + scene.start_from->folder +
                               " that start_from names, and " + tie +
                               "; give it the value that it has there, or run that scene again with this one");
    if (words[0] == "gravity") check_unit_weights(scene, found.scene);
    if (words[0] == "body" || words[0] == "boundary" || words[0] == "water" || words[0] == "transfer" ||
        words[0] == "integrator" || words[0] == "gravity" || words[0] == "quasi_static")
      others.push_back(path);
  }
  if (found.stage < 0) throw std::invalid_argument("it has no state, since its first stage did not begin");
  return others;
}

void check_strength_by_place(const Scene &scene, const std::string &body, const std::vector<std::string> &changed) {
  for (const std::string &path : changed) {
    const Words words = split(path);
    if (words[0] != "body" || words[1] != body) continue;
    if (words[2].find("cohesion") != std::string::npos || words[2].find("friction_angle") != std::string::npos)
      scene.complain(path, "is not what it was in the run " + scene.start_from->folder +
                               " that start_from names, and strength that varies with place stays with the particles; "
                               "give it the value that it has there, or run that scene again with this one");
  }
}

}  // namespace talus
