/// Talus inside a host program that owns MPI, PETSc, its options, a distributed DMPlex and fields on it. The host hands
/// over the plex, advances the soil in steps of its own and reads nodal fields back into its own vectors. Claims:
///  1. a soil column under gravity settles to u_y = -rho g (H y - y^2 / 2) / E_c, E_c the constrained modulus;
///  2. a block in free fall, through the ranks' boundaries, has v_y = -g t and one displacement at all its nodes;
///  3. ranks that share a vertex read the same values;
///  4. the host's options are as before, and the plex lives on when the simulation is gone.
#include <petscdmplex.h>
#include <talus/talus.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "host_mesh.h"

namespace {

constexpr double gravity = 9.81, density = 2000, height = 1;  // [m/s2], [kg/m3], [m]
constexpr double young_modulus = 10e6, poisson_ratio = 0.2;   // [Pa], [-]
constexpr double constrained_modulus =
    young_modulus * (1 - poisson_ratio) / (1 + poisson_ratio) / (1 - 2 * poisson_ratio);

const std::string material = R"(
density = 2000
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.2
)";

const std::string column = R"(gravity = 9.81
[body.column]
region = "soil")" + material +
                           R"(
[boundary.base]
kind = "roller"
[boundary.sides]
kind = "roller"
group = ["left", "right"]
[[stage]]
name = "settling"
duration = 10
damping = 0.5
)";

const std::string fall = R"(gravity = 9.81
[body.block]
region = "block")" + material +
                         R"(
[[stage]]
name = "fall"
duration = 10
)";

/// A field of two components at the vertices, by the host's own section.
struct HostField {
  DM dm = nullptr;
  Vec local = nullptr, global = nullptr;
};

PetscErrorCode create(DM plex, HostField *field) {
  PetscSection section;
  PetscInt begin, end, first, last;
  PetscFunctionBeginUser;
  PetscCall(DMClone(plex, &field->dm));
  PetscCall(DMPlexGetChart(plex, &begin, &end));
  PetscCall(DMPlexGetDepthStratum(plex, 0, &first, &last));
  PetscCall(PetscSectionCreate(PetscObjectComm(reinterpret_cast<PetscObject>(plex)), &section));
  PetscCall(PetscSectionSetChart(section, begin, end));
  for (PetscInt vertex = first; vertex < last; ++vertex) PetscCall(PetscSectionSetDof(section, vertex, 2));
  PetscCall(PetscSectionSetUp(section));
  PetscCall(DMSetLocalSection(field->dm, section));
  PetscCall(PetscSectionDestroy(&section));
  PetscCall(DMCreateLocalVector(field->dm, &field->local));
  PetscCall(DMCreateGlobalVector(field->dm, &field->global));
  PetscFunctionReturn(0);
}

PetscErrorCode destroy(HostField *field) {
  PetscFunctionBeginUser;
  PetscCall(VecDestroy(&field->local));
  PetscCall(VecDestroy(&field->global));
  PetscCall(DMDestroy(&field->dm));
  PetscFunctionReturn(0);
}

PetscErrorCode read_back(talus::AnySimulation &soil, const char *name, HostField *field) {
  PetscSection section;
  PetscScalar *values;
  PetscFunctionBeginUser;
  PetscCall(DMGetLocalSection(field->dm, &section));
  PetscCall(VecSet(field->local, 0));
  PetscCall(VecGetArray(field->local, &values));
  soil.nodal_field(name, [&](PetscInt vertex, const double *value) {
    PetscInt offset;
    PetscCallAbort(PETSC_COMM_SELF, PetscSectionGetOffset(section, vertex, &offset));
    values[offset] = value[0], values[offset + 1] = value[1];
  });
  PetscCall(VecRestoreArray(field->local, &values));
  PetscCall(DMLocalToGlobal(field->dm, field->local, INSERT_VALUES, field->global));
  PetscFunctionReturn(0);
}

/// Largest difference between what this rank read and what the owner of the vertex read, over all ranks.
PetscErrorCode disagreement(const HostField &field, PetscReal *difference) {
  Vec owners;
  PetscFunctionBeginUser;
  PetscCall(VecDuplicate(field.local, &owners));
  PetscCall(DMGlobalToLocal(field.dm, field.global, INSERT_VALUES, owners));
  PetscCall(VecAXPY(owners, -1, field.local));
  PetscCall(VecNorm(owners, NORM_INFINITY, difference));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, difference, 1, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD));
  PetscCall(VecDestroy(&owners));
  PetscFunctionReturn(0);
}

/// Largest distance of the field from `exact(x, y)` [component] over all vertices of all ranks.
PetscErrorCode error(const HostField &field, const std::function<void(double, double, bool, double *)> &exact,
                     PetscReal *largest) {
  Vec coordinates;
  PetscSection at, section;
  const PetscScalar *x, *values;
  PetscInt first, last;
  PetscFunctionBeginUser;
  PetscCall(DMGetCoordinatesLocal(field.dm, &coordinates));
  PetscCall(DMGetCoordinateSection(field.dm, &at));
  PetscCall(DMGetLocalSection(field.dm, &section));
  PetscCall(DMPlexGetDepthStratum(field.dm, 0, &first, &last));
  PetscCall(VecGetArrayRead(coordinates, &x));
  PetscCall(VecGetArrayRead(field.local, &values));
  *largest = 0;
  for (PetscInt vertex = first; vertex < last; ++vertex) {
    PetscInt place, offset;
    double expected[2] = {0, 0};
    PetscCall(PetscSectionGetOffset(at, vertex, &place));
    PetscCall(PetscSectionGetOffset(section, vertex, &offset));
    const bool has_soil = values[offset] != 0 || values[offset + 1] != 0;
    exact(x[place], x[place + 1], has_soil, expected);
    for (int d = 0; d < 2; ++d) *largest = std::max(*largest, std::abs(values[offset + d] - expected[d]));
  }
  PetscCall(VecRestoreArrayRead(field.local, &values));
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 1, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

int failures = 0;

void claim(const char *what, double found, double allowed) {
  const bool holds = found <= allowed;
  if (!holds) ++failures;
  PetscCallAbort(PETSC_COMM_WORLD, PetscPrintf(PETSC_COMM_WORLD, "%-62s %10.3e  (at most %.0e)  %s\n", what, found,
                                               allowed, holds ? "ok" : "FAILED"));
}

std::unique_ptr<talus::AnySimulation> hand_over(DM plex, talus::Scene &scene) {
  talus::RunOptions options;
  options.plex = plex;
  options.screen = false;
  return talus::make_simulation(PETSC_COMM_WORLD, scene, options);
}

long long particles_here(talus::AnySimulation &soil) { return static_cast<long long>(soil.snapshot().id.size()); }

PetscErrorCode settle(DM plex, HostField *field) {
  PetscReal off, apart;
  PetscFunctionBeginUser;
  talus::Scene scene = talus::parse_host_scene(column, "column");
  const auto soil = hand_over(plex, scene);
  claim("mass of the column, relative error", std::abs(soil->mass() / (density * height) - 1), 1e-12);
  for (int step = 1; step <= 10; ++step) soil->advance_to(0.1 * step);  // host's own steps; 18 periods of the column
  claim("the clock stops where the host says [s]", std::abs(soil->time() - 1), 1e-12);
  PetscCall(read_back(*soil, "displacement", field));
  const double most = density * gravity * height * height / 2 / constrained_modulus;
  PetscCall(error(
      *field,
      [=](double, double y, bool, double *u) {
        if (y < height * (1 + 1e-6)) u[1] = -density * gravity * (height * y - y * y / 2) / constrained_modulus;
      },
      &off));
  PetscCall(disagreement(*field, &apart));
  claim("settled column: displacement, error over settlement", off / most, 0.02);
  claim("ranks agree on the displacement of shared vertices [m]", apart, 0);
  PetscFunctionReturn(0);
}

PetscErrorCode fall_freely(DM plex, HostField *field) {
  PetscReal off, apart, apart_after, fastest, farthest;
  PetscFunctionBeginUser;
  talus::Scene scene = talus::parse_host_scene(fall, "fall");
  const auto soil = hand_over(plex, scene);
  const long long here = particles_here(*soil);
  const double t = 0.4;  // falls 0.78 m, eight cells
  for (int step = 1; step <= 4; ++step) soil->advance_to(t * step / 4);
  PetscCall(read_back(*soil, "velocity", field));
  PetscCall(error(
      *field, [=](double, double, bool has_soil, double *v) { v[1] = has_soil ? -gravity * t : 0; }, &off));
  PetscCall(disagreement(*field, &apart));
  PetscCall(VecNorm(field->global, NORM_INFINITY, &fastest));
  claim("free fall: the block is there, relative error of its speed", std::abs(fastest / (gravity * t) - 1), 1e-10);
  claim("free fall: velocity of every node, error over g t", off / (gravity * t), 1e-10);
  PetscCall(read_back(*soil, "displacement", field));
  PetscCall(disagreement(*field, &apart_after));
  apart = std::max(apart, apart_after);
  PetscCall(VecNorm(field->global, NORM_INFINITY, &farthest));
  const double fallen = gravity * t * t / 2;  // Euler falls g t dt / 2 further, with a step that varies
  PetscCall(error(
      *field, [=](double, double, bool has_soil, double *u) { u[1] = has_soil ? -farthest : 0; }, &off));
  claim("free fall: displacement, differences over g t^2 / 2", off / fallen, 1e-10);
  claim("free fall: displacement, relative error", std::abs(farthest / fallen - 1), 2e-3);
  claim("ranks agree on velocity and displacement of shared vertices", apart, 0);
  long long moved = std::abs(particles_here(*soil) - here);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &moved, 1, MPI_LONG_LONG, MPI_MAX, PETSC_COMM_WORLD));
  int ranks;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "  (%lld particles, %lld remaps, %lld more or fewer particles on some rank)\n",
                        soil->particles(), soil->remaps(), moved));
  claim("particles crossed cells and, on several ranks, their boundary",
        soil->remaps() >= 8 && (moved > 0 || ranks == 1) ? 0 : 1, 0);
  PetscFunctionReturn(0);
}

PetscErrorCode all_options(std::string *text) {
  char *copy;
  PetscFunctionBeginUser;
  PetscCall(PetscOptionsGetAll(nullptr, &copy));
  *text = copy;
  PetscCall(PetscFree(copy));
  PetscFunctionReturn(0);
}

PetscErrorCode run() {
  DM plex;
  HostField field;
  std::string before, after;
  PetscInt references;
  PetscFunctionBeginUser;
  PetscCall(PetscOptionsInsertString(nullptr, "-host_ksp_type cg -host_steps 10"));
  PetscCall(make_host_mesh(PETSC_COMM_WORLD, &plex));
  PetscCall(create(plex, &field));
  PetscCall(PetscObjectGetReference(reinterpret_cast<PetscObject>(plex), &references));
  PetscCall(all_options(&before));
  PetscCall(settle(plex, &field));
  PetscCall(fall_freely(plex, &field));
  PetscCall(all_options(&after));
  claim("PETSc options changed", before == after ? 0 : 1, 0);
  PetscInt left;
  PetscCall(PetscObjectGetReference(reinterpret_cast<PetscObject>(plex), &left));
  claim("references to the plex left behind", std::abs(static_cast<double>(left - references)), 0);
  PetscCall(destroy(&field));
  PetscCall(DMDestroy(&plex));
  PetscFunctionReturn(0);
}

}  // namespace

int main(int argc, char **argv) {
  if (PetscInitialize(&argc, &argv, nullptr, nullptr)) return 1;
  try {
    if (run()) failures = 1;
  } catch (const std::exception &problem) {
    std::fprintf(stderr, "host: %s\n", problem.what());
    MPI_Abort(PETSC_COMM_WORLD, 1);
  }
  if (PetscFinalize()) return 1;
  return failures ? 1 : 0;
}
