#pragma once
/// The component for host programs: find_package(Talus), link Talus::talus, include <talus/talus.h>.
///
///     talus::Scene scene = talus::parse_host_scene(text, "slope");
///     talus::RunOptions options;
///     options.plex = plex;  // simplices, interpolated, distributed with overlap 0; Talus keeps a reference
///     auto simulation = talus::make_simulation(comm, scene, options);
///     simulation->advance_to(t);
///     simulation->nodal_field("velocity", [&](PetscInt vertex, const double *v) { ... });
///
/// Body regions and boundary groups of the scene are labels of the DMPlex by name: a region is a label on cells, a
/// group one on facets, each point with any value. Let the simulation go before PetscFinalize. PETSc's options database
/// is neither read nor changed.
#include <string>

#include "scene/scene.h"
#include "simulation.h"

namespace talus {

/// Reads a scene (TOML text) whose mesh the host brings, so without [mesh]; `name` stands for the file in complaints.
/// Throws std::invalid_argument that says line, key and what is allowed.
Scene parse_host_scene(const std::string &text, const std::string &name);

}  // namespace talus
