#pragma once
/// What a scene models, as it was read and meshed: bodies, boundaries with what they do at the start, water, stages,
/// named points. src/output/plots/talus_model.py draws it and writes it into the report.
#include <string>

#include "simulation/world.h"

namespace talus {

/// The model at the start as a JSON document on the first rank; elsewhere empty. Lengths are in metres, all other
/// values in the SI unit that stands beside them. It does not depend on the number of ranks. Collective.
///
///     title, dimension, phases, gravity, up
///     scene        the scene with its overrides, as TOML
///     keys         unit of each key of a scene, by table and kind
///     bodies       name; there: from the start
///     cells        corners and body (-1: free space): in plane strain the cells of the mesh, in 3D the faces of the
///                  soil beyond which there is none, with their outer normals
///     boundaries   name, groups; soil, water, gas: what it does to them; changes: with time; values at the start, from
///                  the least to the largest over the faces with soil; level of open water; faces: corners, normal, is
///                  there soil, load [Pa] or velocity [m/s] at the centre
///     water        line of pressure zero in the soil, in pieces; tables: body (empty: all), points at the start; in 3D
///                  surface: pieces, triangles, of tables that are functions of the place, over the ground of their
///                  soil
///     stages       keys as in the scene with their defaults, in SI; acceleration; integrator; changes: what changes
///                  with time in the stage
///     points, lines   name and place of what the scene follows
template <int dim>
std::string model_of(const World<dim> &world);

}  // namespace talus
