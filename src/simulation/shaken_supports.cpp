#include "simulation/shaken_supports.h"

#include <algorithm>
#include <cmath>

#include "scene/body_source.h"
#include "scene/quasi_static_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "solvers/quasi_static/pore_flow.h"
#include "solvers/quasi_static/thin_bodies.h"

namespace talus {
namespace {

/// What a boundary does to soil that shall move along a direction.
struct Grip {
  int holds = 0;    ///< the soil along it
  int beneath = 0;  ///< lies under the soil and leaves it free along it
};

/// Collective.
template <int dim>
Grip grip_of(const World<dim> &world, const NamedBoundary &source, const std::array<double, 3> &motion) {
  constexpr double right_angle = 1e-3, under = -0.7;  // product of unit vectors; vertical component of the normal
  const auto &directions = source.kind.template on_soil<dim>().directions;
  const bool supports = source.kind.in_motion == OnSoil::support,
             other = source.kind.in_motion == OnSoil::contact || source.kind.in_motion == OnSoil::dashpot;
  Grip grip;
  for (const std::string &group : source.groups)
    for (const Facet<dim> &f : world.mesh.facets(group)) {
      double along = other ? 1 : 0;
      if (supports)
        for (const Vec<dim> &direction : directions(f.normal)) {
          double product = 0;
          for (int d = 0; d < dim; ++d) product += direction[d] * motion[d];
          along = std::max(along, std::abs(product));
        }
      grip.holds |= along > right_angle;
      grip.beneath |= supports && along <= right_angle && f.normal[world.scene.vertical()] < under;
    }
  int found[] = {grip.holds, grip.beneath};
  MPI_Allreduce(MPI_IN_PLACE, found, 2, MPI_INT, MPI_MAX, world.comm);
  return {found[0], found[1]};
}

/// Along a component of the motion. Collective.
template <int dim>
void check_component(const World<dim> &world, const std::vector<NamedBoundary> &sources, std::size_t component) {
  const std::string key = "earthquake." + std::to_string(component) + ".direction";
  const bool wave = std::ranges::any_of(sources, [](const NamedBoundary &one) { return one.kind.incoming_wave; });
  const bool weighs = world.scene.gravity_size() > 0;  // else it may be in flight
  bool held = false;
  for (const NamedBoundary &source : sources) {
    const std::string path = "boundary." + source.name + ".kind";
    const Grip grip = grip_of(world, source, world.shaking.components()[component].direction);
    held = held || grip.holds;
    const bool moves = static_cast<bool>(source.kind.template on_soil<dim>().speed);
    if (wave && grip.holds && source.kind.in_motion != OnSoil::dashpot && !moves)
      world.scene.complain(path, "holds the soil along " + key +
                                     ", while a wave comes in that moves the ground: take tied or free_field at sides "
                                     "and non_reflecting at the base, or leave incoming_wave out");
    if (!wave && grip.beneath && weighs)
      world.scene.complain(path, "lets the ground slide beneath the soil along " + key +
                                     ", so that it does not shake it: take fixed, or friction");
  }
  if (!wave && !held && weighs)
    world.scene.complain(key,
                         "is one in which no boundary takes the soil along: give it a base of kind = \"fixed\" or "
                         "\"friction\", or a non_reflecting one with incoming_wave = true");
}

/// Do finite elements find an equilibrium that a motion takes over?
bool hands_over(const Scene &scene) {
  bool settled = false;
  for (const Stage &stage : scene.stage) {
    if (settled && !stage.is_static()) return true;
    settled = settled || stage.settles_soil();
  }
  return false;
}

/// Of the forces in the soil when finite elements hand it over to the dashpots of a boundary. Collective.
template <int dim>
void check_balance(const World<dim> &world, const NamedBoundary &source) {
  const Scene &scene = world.scene;
  if (scene.quasi_static->elements != Elements::patches)
    scene.complain("quasi_static.elements",
                   "must be \"patches\" with boundary." + source.name +
                       ", whose dashpots do not hold the forces that other elements leave out of balance in motion: "
                       "soil would drift by millimetres");
  if (world.mesh.report().one_element_slice) return;
  const std::vector<char> thin = find_thin_bodies(world.mesh, bodies_of_cells(world.mesh, scene), scene.body.size());
  for (std::size_t b = 0; b < thin.size(); ++b)
    if (thin[b])
      scene.complain("boundary." + source.name + ".kind",
                     "needs soil in equilibrium before it moves, and the elements of first order that give it cannot "
                     "resolve body." +
                         scene.body[b].name + ", which is one element across: make its mesh finer, or mesh.layers 2");
}

}  // namespace

template <int dim>
void check_shaken_supports(const World<dim> &world, const std::vector<NamedBoundary> &sources) {
  if (hands_over(world.scene))
    for (const NamedBoundary &source : sources)
      if (source.kind.incoming_wave || source.kind.has_column) check_balance(world, source);
  if (std::ranges::none_of(world.scene.stage, [](const Stage &stage) { return stage.shakes(); })) return;
  for (std::size_t k = 0; k < world.shaking.components().size(); ++k) check_component(world, sources, k);
}

template void check_shaken_supports(const World<2> &, const std::vector<NamedBoundary> &);
template void check_shaken_supports(const World<3> &, const std::vector<NamedBoundary> &);

}  // namespace talus
