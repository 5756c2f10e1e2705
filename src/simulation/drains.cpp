#include "simulation/drains.h"

#include <algorithm>

#include "physics/boundary/pore_conditions.h"
#include "scene/boundary_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "solvers/quasi_static/faces_inside.h"

namespace talus {
namespace {

/// Of each boundary of the scene: does it act on the water of soil on both sides of it? Collective.
template <int dim>
std::vector<char> find_drains(const BackgroundMesh<dim> &mesh, const Scene &scene) {
  const FacesInside<dim> inside(mesh, scene);
  std::vector<char> found(scene.boundary.size(), 0);
  for (size_t b = 0; b < found.size(); ++b) {
    const Boundary kind = read_boundary(scene.boundary[b].kind);
    if (!kind.fluids_only() || !kind.decides_on_liquid()) continue;
    for (const std::string &group : scene.boundary[b].group)
      for (const Facet<dim> &facet : mesh.has_group(group) ? mesh.facets(group) : std::vector<Facet<dim>>{})
        found[b] = found[b] || inside.holds(facet);
  }
  MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(found.size()), MPI_CHAR, MPI_MAX, mesh.comm());
  return found;
}

bool water_flows_in_elements(const Scene &scene) {
  return std::ranges::any_of(scene.stage, [](const Stage &stage) { return stage.water_flows(); });
}
bool water_moves_with_soil(const Scene &scene) {
  return fluids_move(scene.phases) &&
         std::ranges::any_of(scene.stage, [](const Stage &stage) { return !stage.is_static() && stage.pore_flow; });
}

}  // namespace

template <int dim>
void check_drains(const BackgroundMesh<dim> &mesh, const Scene &scene) {
  const std::vector<char> inside = find_drains(mesh, scene);
  for (size_t b = 0; b < inside.size(); ++b) {
    const Boundary kind = read_boundary(scene.boundary[b].kind);
    const std::string key = "boundary." + scene.boundary[b].name + ".kind";
    if (!inside[b]) continue;
    if (kind.water == OnWater::wall && water_flows_in_elements(scene))
      scene.complain(key,
                     "lies inside the soil, where stages of seepage and consolidation know no wall: draw a cut-off "
                     "as a slot without soil");
    if (kind.supply && !kind.open_water)
      scene.complain(key, "lies inside the soil, where no rain falls: take kind = \"flux\" for water that is let in");
    if (kind.fluid_face() && water_moves_with_soil(scene))
      scene.complain(key,
                     "lies inside the soil, where only stages of seepage and consolidation know drains and wells: "
                     "draw it as a slot without soil, or set pore_flow = false in the dynamic stages");
  }
}

template <int dim>
std::vector<std::string> water_without_soil(const World<dim> &world) {
  const Scene &scene = world.scene;
  std::vector<std::string> sentences;
  if (!water_moves_with_soil(scene) && !water_flows_in_elements(scene)) return sentences;
  const std::vector<char> inside = find_drains(world.mesh, scene);
  const std::vector<SoilFace> surface = world.surface();
  for (int b = 0; b < static_cast<int>(scene.boundary.size()); ++b) {
    const BoundarySource &boundary = scene.boundary[b];
    const bool on_ground = std::ranges::count(boundary.group, std::string(free_surface));
    if (!read_boundary(boundary.kind).fluid_face() || on_ground || inside[b] ||
        std::ranges::any_of(surface, [b](const SoilFace &face) { return face.water == b; }))
      continue;
    sentences.push_back("boundary." + boundary.name +
                        " decides on the water at faces of the mesh that no soil touches at the start, and brings or "
                        "takes none there. The surface of the soil has the group free_surface");
  }
  return sentences;
}

template void check_drains(const BackgroundMesh<2> &, const Scene &);
template void check_drains(const BackgroundMesh<3> &, const Scene &);
template std::vector<std::string> water_without_soil(const World<2> &);
template std::vector<std::string> water_without_soil(const World<3> &);

}  // namespace talus
