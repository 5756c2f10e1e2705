#include <algorithm>
#include <cstdio>

#include "commands/commands.h"
#include "doubts/doubts.h"
#include "mesh_source.h"
#include "meshes/mesh_options.h"
#include "physics/laws/laws.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "solvers/critical_step.h"

namespace talus {
namespace {

struct MeshArguments {
  std::function<MeshRequest()> request;
  std::string file, format = "4.1";
  std::string young_modulus = "10 MPa", poisson_ratio = "0.3", density = "2000";  // a soft soil
};

double quantity_within(const char *option, const std::string &text, Unit unit, Range range) {
  const double value = quantity(option, text, unit) / unit.si;
  if (range.low <= value && value <= range.high) return value * unit.si;
  throw SceneError(std::string(option) + " " + text + " must be from " + shortest(range.low) + " to " +
                   shortest(range.high) + " " + unit.name);
}

/// `up` is the axis along which elevations count.
template <int dim>
void report_mesh(const MeshArguments &arguments, const LinearElastic &soil, double density, int up) {
  const auto mesh = BackgroundMesh<dim>::read(PETSC_COMM_SELF, arguments.file, {});
  const Law law = soil;
  CriticalStep<dim> critical(mesh, law, density);
  int slowest = 0;
  for (int cell = 1; cell < mesh.cell_count(); ++cell)
    if (critical(cell) < critical(slowest)) slowest = cell;
  const double speed = std::sqrt(constrained_modulus(law) / density);
  std::printf(
      "critical step %.4g s (2 / omega_max of all cells) in soil with E = %.4g MPa, nu = %s, density %.4g kg/m3, where "
      "c_p = %.4g "
      "m/s\n",
      critical(slowest), soil.young_modulus / 1e6, arguments.poisson_ratio.c_str(), density, speed);
  std::printf("set by the cell at (");
  for (int d = 0; d < dim; ++d) {
    double centre = 0;
    for (int node : mesh.cells[slowest].node) centre += mesh.position[node][d] / (dim + 1);
    std::printf("%s%.4g", d ? ", " : "", centre);
  }
  const MeshReport report = mesh.report();
  std::printf(") m; smallest altitude over wave speed is %.4g s\n", report.smallest_altitude / speed);
  for (const std::string &remark : report.remarks) std::printf("warning: %s\n", remark.c_str());
  double low = mesh.position[0][up], high = low;
  for (const auto &x : mesh.position) low = std::min(low, x[up]), high = std::max(high, x[up]);
  if (const Relation height = unusual_height(high - low); height.holds)
    std::printf("warning: %s\n", height.sentence.c_str());
}

int make_mesh(const MeshArguments &arguments) {
  const LinearElastic soil{
      {.young_modulus = quantity_within("--young-modulus", arguments.young_modulus, pascal, {1, 1e13}),
       .poisson_ratio = quantity_within("--poisson-ratio", arguments.poisson_ratio, one, {0, 0.4999})}};
  const double density = quantity_within("--density", arguments.density, kilogram_per_cubic_metre, {1, 1e5});
  const MeshRequest request = arguments.request();
  const MeshRun run = run_talus_mesh(request, arguments.file, arguments.format);
  std::fputs(run.output.c_str(), run.status ? stderr : stdout);
  if (run.status) return run.status;
  if (request.dimension == 2)
    report_mesh<2>(arguments, soil, density, 1);
  else
    report_mesh<3>(arguments, soil, density, request.mesh.section.empty() ? 2 : 1);
  return 0;
}

}  // namespace

Action add_mesh(CLI::App &app) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App *command = app.add_subcommand(
      "mesh", "make a mesh file of a section or of terrain, with a report on its quality and critical step");
  command->add_option("-o,--output", arguments->file, "mesh file to write (.msh)")->required();
  arguments->request = add_mesh_options(*command);
  command->add_option("--format", arguments->format, "format of the mesh file: 2.2 or 4.1 (default 4.1)")
      ->check(CLI::IsMember({"2.2", "4.1"}));
  command->add_option("--young-modulus", arguments->young_modulus,
                      "Young's modulus of the soil, for the critical step (default 10 MPa)");
  command->add_option("--poisson-ratio", arguments->poisson_ratio, "Poisson's ratio of the soil (default 0.3)");
  command->add_option("--density", arguments->density, "density of the soil (default 2000 kg/m3)");
  return [arguments] {
    int rank, status = 0;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    if (rank == 0) status = make_mesh(*arguments);
    return status;
  };
}

}  // namespace talus
