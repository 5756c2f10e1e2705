#include "simulation/rigid_checks.h"

#include "physics/boundary/rigid_bodies.h"
#include "scene/boundary_source.h"
#include "scene/output_source.h"
#include "scene/reader.h"
#include "scene/rigid_source.h"
#include "scene/stage.h"
#include "simulation/dynamics.h"

namespace talus {
namespace {

constexpr double allowed_overlap = 0.2;  // of the cell size

void check_components(const Scene &scene, const std::string &path, const RigidSource &source) {
  for (const auto &[key, count] : {std::pair{"velocity", source.velocity.size()},
                                   {"force", source.force.size()},
                                   {"centre", source.centre.size()},
                                   {"initial_velocity", source.initial_velocity.size()}})
    if (count != 0 && count != static_cast<std::size_t>(scene.dimension))
      scene.complain(path + "." + key, "must have " + std::to_string(scene.dimension) + " components");
}

/// Results name bodies, boundaries and points alike.
void check_name(const Scene &scene, const std::string &path, const std::string &name) {
  const auto is_taken = [&](const auto &list) {
    return std::ranges::any_of(list, [&](const auto &one) { return one.name == name; });
  };
  const char *other = is_taken(scene.boundary)        ? "boundary."
                      : is_taken(scene.output->point) ? "output.point."
                                                      : nullptr;
  if (other)
    scene.complain(path, std::string("has the name of ") + other + name +
                             ", and both have columns in history.csv; give one of them another name");
}

/// What rigid bodies do not know yet.
void check_scope(const Scene &scene, const std::string &path) {
  if (scene.dimension != 2) scene.complain(path, "needs dimension = 2: rigid bodies are those of plane strain");
  if (scene.phases != PhaseModel::dry)
    scene.complain("phases", "must be \"dry\" beside " + path +
                                 ": rigid bodies rub with total stress, and no pore water "
                                 "acts on them");
  if (!std::holds_alternative<EulerSettings>(choose_integrator(scene)))
    scene.complain("integrator.kind", "must be \"euler\" beside " + path + ", which acts once in a step");
  for (std::size_t k = 0; k < scene.stage.size(); ++k)
    if (scene.stage[k].is_static())
      scene.complain("stage." + std::to_string(k) + ".kind",
                     "must be \"dynamic\" beside " + path +
                         ": finite elements do not know rigid bodies; a dynamic stage with damping finds the stress at "
                         "rest");
  for (const BoundarySource &source : scene.boundary)
    if (read_boundary(source.kind).in_motion == OnSoil::tied)
      scene.complain("boundary." + source.name + ".kind",
                     "cannot be \"tied\" beside " + path + ", which would meet one of two sides that move alike");
}

}  // namespace

void check_rigid_bodies(const Scene &scene) {
  for (const RigidSource &source : scene.rigid) {
    const std::string path = "rigid." + source.name, problem = problem_of_polygon(source.polygon);
    check_scope(scene, path);
    if (!problem.empty()) scene.complain(path + ".polygon", problem);
    check_components(scene, path, source);
    check_name(scene, path, source.name);
  }
}

template <int dim>
void check_rigid_overlap(const World<dim> &world) {
  const RigidBodies<dim> *bodies = world.conditions.rigid_bodies();
  if (!bodies) return;
  int body = 0;
  Vec<dim> where{};
  const bool found = bodies->find_overlap(allowed_overlap, &body, &where);
  const std::string place = place_of_first<dim>(world.comm, found, where);
  const std::string name = text_of_first(world.comm, found, found ? world.scene.rigid[body].name : "");
  if (!place.empty())
    world.scene.complain("rigid." + name + ".polygon",
                         "must not reach into soil at the start by more than a fifth of a cell, as it does near " +
                             place + ": move it, or leave the place of the body out of the regions of the soil");
}

template void check_rigid_overlap(const World<2> &);
template void check_rigid_overlap(const World<3> &);

}  // namespace talus
