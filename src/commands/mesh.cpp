#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "commands/commands.h"
#include "doubts/doubts.h"
#include "mesh_source.h"
#include "physics/laws/laws.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "solvers/critical_step.h"

namespace talus {
namespace {

struct MeshArguments {
  std::string source, file, size, dimension, thickness, layers, format, step, base, air, far_size, slip_surface,
      outline, depth, depth_shape, way_width;
  std::vector<std::string> cuts, boxes, window, ellipsoid, soil_layers, way;
  std::string young_modulus = "10 MPa", poisson_ratio = "0.3", density = "2000";  // a soft soil
};

double in_unit_of(const char *option, const std::string &text, Unit unit) {
  try {
    return in_unit(text, unit);
  } catch (const std::invalid_argument &error) {
    throw SceneError(std::string(option) + " " + text + ": " + error.what());
  }
}

double quantity(const char *option, const std::string &text, Unit unit, Range range) {
  const double value = in_unit_of(option, text, unit);
  if (range.low <= value && value <= range.high) return value * unit.si;
  throw SceneError(std::string(option) + " " + text + " must be from " + shortest(range.low) + " to " +
                   shortest(range.high) + " " + unit.name);
}

/// For talus-mesh, which takes metres and checks what they are good for.
std::vector<std::string> options_of(const MeshArguments &a) {
  std::vector<std::string> options{a.source, "-o", a.file};
  const auto metres = [](const char *option, const std::string &text) {
    return shortest(in_unit_of(option, text, metre));
  };
  for (const auto &[name, value] : {std::pair{"--size", a.size},
                                    {"--thickness", a.thickness},
                                    {"--base", a.base},
                                    {"--air", a.air},
                                    {"--far-size", a.far_size},
                                    {"--depth", a.depth},
                                    {"--way-width", a.way_width}})
    if (!value.empty()) options.insert(options.end(), {name, metres(name, value)});
  for (const auto &[name, value] : {std::pair{"--dimension", a.dimension},
                                    {"--layers", a.layers},
                                    {"--format", a.format},
                                    {"--step", a.step},
                                    {"--slip-surface", a.slip_surface},
                                    {"--outline", a.outline},
                                    {"--depth-shape", a.depth_shape}})
    if (!value.empty()) options.insert(options.end(), {name, value});
  for (const std::string &cut : a.cuts) options.insert(options.end(), {"--cuts", metres("--cuts", cut)});
  for (std::size_t i = 0; i < a.boxes.size(); ++i) {
    if (i % 5 == 0) options.push_back("--refine");
    options.push_back(metres("--refine", a.boxes[i]));
  }
  for (std::size_t i = 0; i < a.window.size(); ++i) {
    if (i == 0) options.push_back("--window");
    options.push_back(metres("--window", a.window[i]));
  }
  for (std::size_t i = 0; i < a.soil_layers.size(); ++i) {
    if (i % 2 == 0) options.push_back("--layer");
    options.push_back(a.soil_layers[i]);
  }
  for (std::size_t i = 0; i < a.way.size(); ++i) {
    if (i % 2 == 0) options.push_back("--way");
    options.push_back(metres("--way", a.way[i]));
  }
  for (std::size_t i = 0; i < a.ellipsoid.size(); ++i) {
    if (i == 0) options.push_back("--ellipsoid");
    options.push_back(i < 6 ? metres("--ellipsoid", a.ellipsoid[i])
                            : shortest(in_unit_of("--ellipsoid", a.ellipsoid[i], degree)));
  }
  return options;
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
  if (const std::string sentence = unlikely_height(high - low); !sentence.empty())
    std::printf("warning: %s\n", sentence.c_str());
}

bool is_section(const MeshArguments &arguments) {
  const std::string kind = std::filesystem::path(arguments.source).extension();
  return kind == ".csv" || kind == ".dxf" || kind == ".DXF";
}

int make_mesh(const MeshArguments &arguments) {
  const LinearElastic soil{{.young_modulus = quantity("--young-modulus", arguments.young_modulus, pascal, {1, 1e13}),
                            .poisson_ratio = quantity("--poisson-ratio", arguments.poisson_ratio, one, {0, 0.4999})}};
  const double density = quantity("--density", arguments.density, kilogram_per_cubic_metre, {1, 1e5});
  const MeshRun run = run_talus_mesh(options_of(arguments));
  std::fputs(run.output.c_str(), run.status ? stderr : stdout);
  if (run.status) return run.status;
  if (!is_section(arguments))  // terrain
    report_mesh<3>(arguments, soil, density, 2);
  else
    arguments.dimension == "3" ? report_mesh<3>(arguments, soil, density, 1)
                               : report_mesh<2>(arguments, soil, density, 1);
  return 0;
}

}  // namespace

Action add_mesh(CLI::App &app) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App *command = app.add_subcommand(
      "mesh", "make a mesh file of a section or of terrain, with a report on its quality and critical step");
  command->add_option("SOURCE", arguments->source, "section: CSV or DXF; or terrain: ESRI ASCII or GeoTIFF")
      ->required();
  command->add_option("-o,--output", arguments->file, "mesh file to write (.msh)")->required();
  command->add_option("--size", arguments->size, "cell size, such as 0.5 or \"50 cm\"")->required();
  command->add_option("--dimension", arguments->dimension, "of a section, 2: triangles, 3: tetrahedra (default 2)");
  command->add_option("--thickness", arguments->thickness, "thickness of a 3D slice (default: one cell size)");
  command->add_option("--layers", arguments->layers,
                      "element layers over the thickness; 0: unstructured tetrahedra (default 1)");
  command->add_option("--cuts", arguments->cuts,
                      "z values that divide the thickness into regions with the endings _1, _2, ...");
  command->add_option("--refine", arguments->boxes, "x0 y0 x1 y1 h: cells of size h in a box; may be repeated")
      ->type_size(5)
      ->expected(-1);
  command->add_option("--window", arguments->window, "terrain: west south east north (default: all of it)")
      ->expected(4);
  command->add_option("--step", arguments->step, "terrain: every so many-th row and column is used (default 1)");
  command->add_option(
      "--base", arguments->base,
      "terrain: elevation of a flat base (default: the mesh is the space above the ground or slip surface)");
  command->add_option("--air", arguments->air, "terrain: height of the free space above the ground");
  command->add_option("--far-size", arguments->far_size,
                      "terrain: cell size far from the slide and the ground (default: --size)");
  command->add_option("--slip-surface", arguments->slip_surface, "terrain: a grid of the elevations of a slip surface");
  command
      ->add_option("--ellipsoid", arguments->ellipsoid,
                   "terrain: slip surface by an ellipsoid, x y z of its centre, half lengths down the dip, along the "
                   "strike and normal, dip, dip direction (azimuth towards which it dips)")
      ->expected(8);
  command->add_option("--outline", arguments->outline,
                      "terrain: slip surface by the outline of the slide, polygons of a Shapefile or GeoPackage");
  command->add_option("--depth", arguments->depth, "terrain: largest depth of the slip surface in the outline");
  command->add_option("--depth-shape", arguments->depth_shape,
                      "terrain: depth in the outline, bowl (default: 0 at the outline) or constant");
  command
      ->add_option("--layer", arguments->soil_layers,
                   "terrain: NAME FILE, a group of the cells below a grid of elevations; from top to bottom")
      ->type_size(2)
      ->expected(-1);
  command
      ->add_option("--way", arguments->way,
                   "terrain: x y, a point of the line along which cells measure --size; may be repeated")
      ->type_size(2)
      ->expected(-1);
  command->add_option("--way-width", arguments->way_width,
                      "terrain: width of the strip of small cells along the line --way");
  command->add_option("--format", arguments->format, "format of the mesh file: 2.2 or 4.1 (default 4.1)");
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
