#pragma once
/// A motion of soil of its own, beside the time loop, for tests that drive it by hand: one body out of the text of a
/// scene. The pores of drained soil are full; where fluids move on their own, particles have the mass of the grains.
#include <gtest/gtest.h>

#include "mesh_source.h"
#include "physics/soil_motion.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "soil_tables.h"

namespace talus {

template <int dim, class Phases = Dry>
struct Soil {
  Soil(const std::string &text, double relaxation_time)
      : scene(parse_scene(text, "soil")), weighing(scene), pressure(weighing), file(PETSC_COMM_WORLD, scene) {
    SoilTables tables = tables_of(scene, Phases::liquid);
    mesh = BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file.path(), {{tables.region, 5.}});
    pressure.set_regions(std::vector<int>(mesh.cell_count(), 0));
    EXPECT_EQ(conditions.setup(mesh, std::move(tables.boundaries)), 0);
    SurfaceLoads<dim> &loads = conditions.surface_loads();
    loads.share(mesh, std::vector<char>(mesh.cell_count(), 1));
    bodies.push_back(std::make_unique<Body<dim>>());
    EXPECT_EQ(bodies[0]->create(mesh.comm(), tables.body, tables.law, traits_of<Phases>.fluids(), loads.face_count()),
              0);
    seed<dim>(*bodies[0], mesh, 8, [&](const Vec<dim> &) { return tables.density; });
    loads.seed(*bodies[0], mesh);
    EXPECT_EQ(bodies[0]->sort(mesh.cell_count()), 0);
    double mass = 0;
    for (int i = 0; i < particles().count; ++i) mass += particles().mass[i];
    MPI_Allreduce(MPI_IN_PLACE, &mass, 1, MPI_DOUBLE, MPI_SUM, mesh.comm());
    motion = std::make_unique<SoilMotion<dim, Phases>>(
        MotionParts<dim>{mesh, bodies, conditions, scene, pressure, relaxation_time, mass, 1000});
    motion->loading.gravity[1] = scene.gravity[1];
    EXPECT_EQ(motion->setup_pores(true), 0);
  }
  ParticleArrays<dim> &particles() const { return bodies[0]->particles(); }

  Scene scene;
  /// The scene in which water weighs: tests set the gravity of the motion themselves.
  struct Weighing : Scene {
    explicit Weighing(const Scene &scene) : Scene(scene) { gravity.assign(dim, 0), gravity[1] = -9.81; }
  } weighing;
  PrescribedPressure<dim> pressure;
  MeshFile file;
  BackgroundMesh<dim> mesh;
  std::vector<std::unique_ptr<Body<dim>>> bodies;
  Conditions<dim> conditions;
  std::unique_ptr<SoilMotion<dim, Phases>> motion;
};

}  // namespace talus
