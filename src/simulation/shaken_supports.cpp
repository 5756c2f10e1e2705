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
  int beneath = 0;  ///< lies under the soil and leaves it free along a part of it
  int under = 0;    ///< lies under the soil
  int beside = 0;   ///< stands beside it
};

/// Of a motion along unit directions, at a right angle to each other: the largest share along one, and what is left.
template <int dim>
std::pair<double, double> held_of(const std::vector<Vec<dim>> &directions, const std::array<double, 3> &motion) {
  double along = 0, held = 0, whole = 0;
  for (const double m : motion) whole += m * m;
  for (const Vec<dim> &direction : directions) {
    double product = 0;
    for (int d = 0; d < dim; ++d) product += direction[d] * motion[d];
    along = std::max(along, std::abs(product)), held += product * product;
  }
  return {along, std::sqrt(std::max(0., whole - held))};
}

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
      const double up = f.normal[world.scene.vertical()];
      const auto [along, left] = supports ? held_of<dim>(directions(f.normal), motion) : std::pair(other ? 1. : 0., 0.);
      grip.holds |= along > right_angle, grip.beneath |= left > right_angle && up < under;
      grip.under |= up < under, grip.beside |= std::abs(up) < -under;
    }
  int found[] = {grip.holds, grip.beneath, grip.under, grip.beside};
  MPI_Allreduce(MPI_IN_PLACE, found, 4, MPI_INT, MPI_MAX, world.comm);
  return {found[0], found[1], found[2], found[3]};
}

/// Of a wave: nothing may hold or brake the ground that it moves.
template <int dim>
void check_beside_wave(const World<dim> &world, const NamedBoundary &source, const Grip &grip, const std::string &key,
                       bool from_below) {
  const std::string path = "boundary." + source.name + ".kind";
  const bool dashpot = source.kind.in_motion == OnSoil::dashpot,
             moves = static_cast<bool>(source.kind.template on_soil<dim>().speed);
  if (grip.holds && !dashpot && !moves)
    world.scene.complain(path, "holds the soil along " + key +
                                   ", while a wave comes in that moves the ground: take tied or free_field at sides "
                                   "and non_reflecting at the base, or leave incoming_wave out");
  if (from_below && dashpot && grip.beside && !source.kind.has_column && !source.kind.incoming_wave)
    world.scene.complain(path,
                         "has dashpots that stand still beside ground which a wave from below moves, and brake it: "
                         "take free_field, or tied");
}

/// Along a component of the motion. Collective.
template <int dim>
void check_component(const World<dim> &world, const std::vector<NamedBoundary> &sources, std::size_t component) {
  const std::string key = "earthquake." + std::to_string(component) + ".direction";
  const bool weighs = world.scene.gravity_size() > 0;  // else it may be in flight
  bool wave = false, from_below = false, held = false;
  std::vector<Grip> grips;
  for (const NamedBoundary &source : sources) {
    grips.push_back(grip_of(world, source, world.shaking.components()[component].direction));
    wave = wave || source.kind.incoming_wave, held = held || grips.back().holds;
    from_below = from_below || (source.kind.incoming_wave && grips.back().under);
  }
  for (std::size_t s = 0; s < sources.size(); ++s)
    if (wave)
      check_beside_wave(world, sources[s], grips[s], key, from_below);
    else if (grips[s].beneath && weighs)
      world.scene.complain("boundary." + sources[s].name + ".kind",
                           "lets the ground slide beneath the soil along " + key +
                               ", so that it does not shake it: take fixed, or friction");
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
