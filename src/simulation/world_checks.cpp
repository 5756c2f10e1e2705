// What only mesh, soil or particles can tell is wrong with a scene: complaints before the first step.
#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/boundary/pore_conditions.h"
#include "physics/boundary/prescribed_directions.h"
#include "scene/body_source.h"
#include "scene/mesh_source.h"
#include "scene/output_source.h"
#include "scene/quasi_static_source.h"
#include "scene/reader.h"
#include "scene/rigid_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/water_source.h"
#include "scene/words.h"
#include "simulation/drains.h"
#include "simulation/world.h"

namespace talus {

template <int dim>
void World<dim>::check_bodies() const {
  const auto check_lattice = [&](const std::string &path, int count) {
    if (lattice<dim>(count).empty())
      scene.complain(path + ".particles_per_cell",
                     std::string("has no lattice of that many points; take ") +
                         (dim == 2 ? "1, 3, 4, 6, 9, 10, 12, 15 or 16" : "1, 4, 8, 10 or 20"));
  };
  std::vector<int> owner(mesh.cell_count(), -1);
  for (int b = 0; b < static_cast<int>(scene.body.size()); ++b) {
    const BodySource &body = scene.body[b];
    const std::string path = "body." + body.name;
    int other = -1;
    for (const std::string &region : body.region) {
      if (!mesh.has_region(region))
        scene.complain(path + ".region", "must name groups of cells; the mesh has no \"" + region + "\"; " +
                                             suggestion(region, mesh.region_names()));
      for (int cell : mesh.region(region)) {
        if (owner[cell] >= 0 && owner[cell] != b) other = owner[cell];
        owner[cell] = b;
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, &other, 1, MPI_INT, MPI_MAX, comm);
    if (other >= 0)
      scene.complain(path + ".region",
                     "fills cells that body." + scene.body[other].name + " fills too; give each cell to one body");
    if (!phases.prescribed && !phases.suction && reads_suction(laws[b]))
      scene.complain(path + ".law", std::string("takes strength from suction, and `phases = \"") + phases.name +
                                        "\"` has none; model the water (`phases = \"drained\"` and a [water] excess "
                                        "below zero), or leave out the "
                                        "keys suction_...");
    if (body.damping_ratio > 0 && rate_dependent(laws[b]))
      scene.complain(path + ".damping_ratio",
                     std::string("must be 0 where law = \"") + law_name(laws[b]) +
                         "\", whose stress depends on the rate of strain already: its viscosity takes energy");
    check_lattice(path, particles_per_cell<dim>(body));
    for (size_t k = 0; k < body.dense.size(); ++k)
      check_lattice(path + ".dense." + std::to_string(k), body.dense[k].particles_per_cell);
  }
  check_boxes();
}

template <int dim>
void World<dim>::check_earthquake() const {
  for (std::size_t k = 0; k < scene.stage.size(); ++k)
    if (scene.stage[k].shakes() && scene.stage[k].duration < shaking.duration() * (1 - 1e-9))
      scene.complain("stage." + std::to_string(k) + ".duration",
                     "must not be shorter than the motion of the ground, " + rounded(shaking.duration()) +
                         " s; earthquake.begin and end take a part of a record");
}

/// Sides at which ground goes on stand upright, and free ground at rest knows no pore fluid that moves.
template <int dim>
void World<dim>::check_sides(const std::vector<Source> &sources) const {
  constexpr double upright = 1e-6;  // vertical component of the normal
  for (const Source &source : sources) {
    if (source.kind.in_motion != OnSoil::tied && !source.kind.has_column) continue;
    const std::string path = "boundary." + source.name;
    if (source.kind.has_column && phases.liquid)
      scene.complain(path + ".kind", std::string("does not know pore fluids that move (phases = \"") + phases.name +
                                         "\"): take phases = \"dry\" or \"drained\", or kind = \"tied\" where both "
                                         "sides have one height");
    for (std::size_t k = 0; k < scene.stage.size(); ++k)
      if (scene.stage[k].shakes() && scene.stage[k].hold_loads)
        scene.complain("stage." + std::to_string(k) + ".hold_loads",
                       "must be false in an earthquake: " + path + " would be a roller in this stage");
    double steepest = 0;
    for (const std::string &group : source.groups)
      for (const Facet<dim> &f : mesh.facets(group))
        steepest = std::max(steepest, std::abs(f.normal[scene.vertical()]));
    MPI_Allreduce(MPI_IN_PLACE, &steepest, 1, MPI_DOUBLE, MPI_MAX, comm);
    if (steepest > upright)
      scene.complain(path + ".group", "must be upright, and one of its facets is inclined by " +
                                          rounded(std::asin(std::min(1., steepest)) / degree.si) +
                                          " degrees; let the mesh end in upright planes");
  }
}

/// Boxes in which there is nothing.
template <int dim>
void World<dim>::check_boxes() const {
  const auto refuse_empty = [&](const std::string &path, int found, const std::string &why) {
    MPI_Allreduce(MPI_IN_PLACE, &found, 1, MPI_INT, MPI_MAX, comm);
    if (!found) scene.complain(path, why);
  };
  for (size_t k = 0; k < scene.mesh->refine.size(); ++k) {
    const RefineBox &box = scene.mesh->refine[k];
    int found = 0;  // cells are refined by x and y, for all z
    for (const Cell<dim> &cell : mesh.cells) {
      bool overlaps = true;
      for (int d = 0; d < 2; ++d) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const int node : cell.node)
          low = std::min(low, mesh.position[node][d]), high = std::max(high, mesh.position[node][d]);
        overlaps = overlaps && low < box.to[d] && high > box.from[d];
      }
      found |= overlaps;
    }
    refuse_empty("mesh.refine." + std::to_string(k), found,
                 "is a box in which the mesh has no cell: move it into the section, or leave it out");
  }
  for (const BodySource &body : scene.body)
    for (size_t k = 0; k < body.dense.size(); ++k) {
      int found = 0;
      for (const std::string &region : body.region)
        for (const int c : mesh.region(region)) {
          bool inside = true;
          for (int d = 0; d < dim; ++d) {
            double centre = 0;
            for (const int node : mesh.cells[c].node) centre += mesh.position[node][d] / (dim + 1);
            inside = inside && body.dense[k].from[d] <= centre && centre <= body.dense[k].to[d];
          }
          found |= inside;
        }
      refuse_empty("body." + body.name + ".dense." + std::to_string(k), found,
                   "is a box in which no cell of the body has its centre: move it into the body, make it larger than a "
                   "cell, or leave it out");
    }
}

/// Soil on which nothing acts is at rest from the start, which nobody wants to know.
template <int dim>
void World<dim>::check_something_acts(const std::vector<Source> &sources) const {
  const bool moved = std::ranges::any_of(scene.body, [](const BodySource &b) {
    return !b.velocity.empty() || !b.displacement.empty() || !b.stress.empty() || !b.body_acceleration.empty();
  });
  const bool pushed = std::ranges::any_of(sources, [](const Source &source) {
    return source.kind.in_motion == OnSoil::load || source.kind.template on_soil<dim>().speed ||
           source.kind.fluid_face();
  });
  if (moved || pushed || scene.gravity_size() > 0 || !scene.rigid.empty() || scene.water->given || scene.gas->given)
    return;
  for (size_t k = 0; k < scene.stage.size(); ++k)
    if (scene.stage[k].stop().waits_for_loads)
      scene.complain("stage." + std::to_string(k) + ".until",
                     "waits for soil on which nothing acts: give gravity, or a boundary that loads or moves the soil");
}

/// Boundaries of which one has no effect, since another one decides on the same group. Loads on one group add up; a
/// support and a boundary of the pores stand side by side.
template <int dim>
void World<dim>::check_one_of_two(const std::vector<Source> &sources) const {
  const auto refuse = [&](const Source &one, const std::string &what, const std::string &group, const Source &other) {
    scene.complain("boundary." + one.name + ".kind", what + " group \"" + group + "\", where boundary." + other.name +
                                                         " does so too: leave one of the two out, or give each a "
                                                         "group of its own");
  };
  for (size_t s = 0; s < sources.size(); ++s)
    for (size_t other = 0; other < sources.size(); ++other) {
      const Boundary &mine = sources[s].kind, &others = sources[other].kind;
      const auto directions = mine.template on_soil<dim>().directions;
      const auto of_other = others.template on_soil<dim>().directions;
      for (const std::string &group : sources[s].groups) {
        if (other == s || !std::count(sources[other].groups.begin(), sources[other].groups.end(), group)) continue;
        const bool contrary = mine.decides_on_liquid() && others.decides_on_liquid() &&
                              (mine.fluid_face() || others.fluid_face());  // two walls agree
        if (other < s && contrary && mine.needs_gas() == others.needs_gas())
          refuse(sources[s], "decides on the pore fluids at", group, sources[other]);
        if (!mesh.has_group(group)) continue;  // such as free_surface
        int clash = 0, held = 0;               // the same direction twice; all directions by the other
        for (const Facet<dim> &facet : mesh.facets(group)) {
          PrescribedDirections<dim> prescribed;
          int wanted = 0;
          if (of_other)
            for (const Vec<dim> &direction : of_other(facet.normal)) prescribed.add(direction, 0), ++wanted;
          held |= prescribed.count == dim;
          if (directions)
            for (const Vec<dim> &direction : directions(facet.normal)) prescribed.add(direction, 1), ++wanted;
          clash |= directions && of_other && prescribed.count < wanted;
        }
        int found[] = {clash, held};
        MPI_Allreduce(MPI_IN_PLACE, found, 2, MPI_INT, MPI_MAX, comm);
        if (other < s && found[0]) refuse(sources[s], "prescribes the motion of", group, sources[other]);
        if (found[1] && !directions && !mine.fluids_only())
          scene.complain("boundary." + sources[s].name + ".kind",
                         "has no effect on group \"" + group + "\", which boundary." + sources[other].name +
                             " holds in all directions: leave one of the two out, or give each a group of its own");
      }
    }
}

/// Refuses bases that finite elements cannot rest on.
template <int dim>
void World<dim>::check_quasi_static_base(const std::string &path) const {
  if (phases.liquid)
    scene.complain(path + ".kind", std::string("has no quasi-static form where pore fluids move (phases = \"") +
                                       phases.name + "\"): take roller or fixed, or a dynamic stage");
  if (dim == 3 && scene.quasi_static->elements == Elements::quadratic)
    scene.complain("quasi_static.elements",
                   "must be \"patches\" or \"linear\" in 3D with " + path +
                       ", a base with friction: the corners of facets of second order bear nothing");
}

/// Refuses quasi-static stages on a base that an earlier motion has changed: finite elements take it fresh and cold.
template <int dim>
void World<dim>::check_fresh_base(const std::string &path) const {
  const Stage *changes = nullptr;
  for (const Stage &stage : scene.stage) {
    if (!stage.is_static() && stage.softening) changes = &stage;
    if (stage.reset_displacement) changes = nullptr;
    if (changes && stage.settles_soil())
      scene.complain(path + ".kind", "depends on the slip of the base, which finite elements do not know: stage " +
                                         stage.name + " cannot follow the motion of stage " + changes->name +
                                         "; put it before, set softening = false or reset_displacement = true there, "
                                         "or take friction that does not depend on slip");
  }
}

template <int dim>
void World<dim>::check_boundaries(const std::vector<Source> &sources) const {
  check_something_acts(sources);
  const bool quasi_static =
      std::any_of(scene.stage.begin(), scene.stage.end(), [](const Stage &stage) { return stage.is_static(); });
  for (const auto &source : sources) {
    const std::string path = "boundary." + source.name;
    std::vector<std::string> groups = mesh.group_names();
    if (source.kind.fluids_only()) groups.emplace_back(free_surface);
    for (const std::string &group : source.groups)
      if (std::ranges::count(groups, group) == 0)
        scene.complain(path + ".group",
                       "must name groups of facets; the mesh has no \"" + group + "\"; " + suggestion(group, groups));
    for (const OutputPoint &point : scene.output->point)
      if (point.name == source.name && source.kind.in_motion == OnSoil::load)
        scene.complain("output.point." + point.name,
                       "has the name of boundary." + source.name +
                           ", and both have columns of displacement in history.csv; give one of them another name");
    if (source.kind.water == OnWater::wall && phases.gas &&
        std::ranges::count(source.groups, std::string(free_surface)))
      scene.complain(path + ".kind",
                     "would have to stop gas, which goes freely through group = \"free_surface\"; take kind = \"flux\" "
                     "with inflow = 0 there, which stops water");
    if (source.kind.fluids_only() && !phases.liquid)
      scene.complain(path, std::string("is a boundary of moving pore water, but phases = \"") + phases.name +
                               "\" has none" +
                               (phases.prescribed ? " but in stages of seepage: give the scene one (in a run from "
                                                    "which another starts too), or "
                                                  : "; ") +
                               "set phases = \"saturated\", \"unsaturated\" or \"three-phase\"");
    if (source.kind.needs_gas() && !phases.gas)
      scene.complain(path + ".kind", std::string("is a boundary of moving pore gas, but phases = \"") + phases.name +
                                         "\" has none; set phases = \"three-phase\"");
    if (quasi_static && source.kind.quasi_static == OnSoil::refused)
      scene.complain(path + ".kind", "has no quasi-static form; take fixed, roller, velocity or traction");
    if (quasi_static && source.kind.quasi_static == OnSoil::contact) check_quasi_static_base(path);
    if (quasi_static && source.kind.remembers) check_fresh_base(path);
    if (source.kind.in_motion == OnSoil::contact && phases.prescribed && !scene.water->open_water_load)
      scene.complain(path + ".kind",
                     "rubs with effective stress, which it does not know with water.open_water_load = false; leave "
                     "open_water_load at true, and where no open water shall rest on a face let the water table of the "
                     "soil come down to it");
    for (const auto &[key, components] : source.kind.vectors)
      if (components != dim) scene.complain(path + "." + key, "must have " + std::to_string(dim) + " components");
  }
  check_sides(sources);
  check_one_of_two(sources);
  check_one_of_two(seepage_sources);
  check_drains<dim>(mesh, scene);
}

/// What the functions of place made of a body's particles. Collective.
template <int dim>
void World<dim>::check_seeded(const Body<dim> &body, const std::string &path) const {
  const ParticleArrays<dim> &p = body.particles();
  const auto check = [&](const char *key, auto &&finite) {
    int bad = 0;
    while (bad < p.count && finite(bad)) ++bad;
    const std::string where = place_of_first<dim>(comm, bad < p.count, bad < p.count ? p.reference[bad] : Vec<dim>{});
    if (!where.empty()) scene.complain(path + "." + key, "is no number at " + where);
  };
  const auto all_finite = [](const double *x, int count) {
    return std::all_of(x, x + count, [](double value) { return std::isfinite(value); });
  };
  check("velocity", [&](int i) { return all_finite(p.velocity[i].data(), dim); });
  check("stress", [&](int i) { return all_finite(p.stress + i * stress_size<dim>, stress_size<dim>); });
  check("displacement", [&](int i) { return all_finite(p.position[i].data(), dim) && p.volume[i] > 0; });
}

template void World<2>::check_bodies() const;
template void World<3>::check_bodies() const;
template void World<2>::check_boundaries(const std::vector<Source> &) const;
template void World<3>::check_boundaries(const std::vector<Source> &) const;
template void World<2>::check_earthquake() const;
template void World<3>::check_earthquake() const;
template void World<2>::check_seeded(const Body<2> &, const std::string &) const;
template void World<3>::check_seeded(const Body<3> &, const std::string &) const;

}  // namespace talus
