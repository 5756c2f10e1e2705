// talus-mesh: from a section or terrain to a Gmsh mesh with named groups. A program of its own, since Gmsh is GPL.
#include <gmsh.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>

#include "meshes/drawing.h"
#include "meshes/gmsh_elements.h"
#include "meshes/grid.h"
#include "meshes/mesh_options.h"
#include "meshes/section_mesh.h"
#include "meshes/simplex.h"
#include "meshes/terrain_mesh.h"

namespace talus {
namespace {

constexpr double most_cells = 2e7;  // Gmsh makes them on one core, in an hour and in 20 GB

/// What is asked for.
struct Job {
  MeshRequest request;
  std::string file;  ///< to write
  std::string format = "4.1";
  std::string grid;                   ///< whose values are written, instead of a mesh
  std::string projection;             ///< as well-known text, that this grid must have ...
  std::string terrain_of_projection;  ///< ... as this file has

  const std::string &source() const {
    return request.mesh.section.empty() ? request.mesh.terrain.file : request.mesh.section;
  }
};

[[noreturn]] void complain(const std::string &text) { throw std::invalid_argument(text); }

MeshOptions section_options(const MeshRequest &request) {
  const MeshSource &mesh = request.mesh;
  MeshOptions options{mesh.size, request.dimension, mesh.thickness, mesh.layers, mesh.cuts, {}};
  for (const RefineBox &box : mesh.refine)
    options.boxes.push_back({{box.from[0], box.from[1]}, {box.to[0], box.to[1]}, box.size});
  return options;
}

Ellipsoid ellipsoid_of(const EllipsoidSource &e) {
  const auto &[a, b, c] = std::tie(e.semi_axes[0], e.semi_axes[1], e.semi_axes[2]);
  if (!(a > 0 && b > 0 && c > 0)) complain("--ellipsoid needs semi-axes a, b and c above 0 m");
  if (!(e.dip >= 0 && e.dip < 90 * degree.si)) complain("--ellipsoid needs a dip from 0 to 90 degrees");
  return {{e.centre[0], e.centre[1], e.centre[2]}, {a, b, c}, e.dip, e.dip_direction};
}

TerrainOptions terrain_options(const MeshSource &mesh) {
  const TerrainSource &t = mesh.terrain;
  if (t.air < 0) complain("--air must not be below 0 m");
  if (t.outline.empty() && t.depth != 0) complain("--depth and --depth-shape belong to an --outline");
  if (t.way.empty() && t.way_width != 0) complain("--way-width belongs to a --way");
  TerrainOptions o;
  o.file = t.file, o.size = mesh.size, o.far_size = t.far_size, o.halvings = mesh.halvings;
  o.window = t.window, o.step = t.step, o.air = t.air;
  if (!t.base.empty()) o.base = t.base[0];
  o.slip_surface = t.slip_surface, o.outline = t.outline;
  if (t.ellipsoid.given) o.ellipsoid = ellipsoid_of(t.ellipsoid);
  o.depth = t.depth, o.bowl = t.depth_shape == DepthShape::bowl;
  for (const LayerSource &layer : t.layer) o.layers.push_back({layer.name, layer.file});
  for (const std::vector<double> &point : t.way) o.way.insert(o.way.end(), point.begin(), point.end());
  o.way_width = t.way_width;
  return o;
}

Section section_in(const std::string &source) {
  const auto doubted = [&](Section section) {
    for (const std::string &doubt : section.doubts()) std::cout << "warning: " << doubt << "\n";
    if (section.unit.metres == 1 && !section.unit_stated.empty())
      std::cout << source << ": all numbers are in metres (" << section.unit_stated << ")\n";
    return section;
  };
  if (!is_drawing(source)) return doubted(read_section(source));
  const Drawing drawing = read_drawing(source);
  for (const std::string &doubt : drawing.doubts) std::cout << "warning: " << doubt << "\n";
  return doubted(section_of(drawing.rows, source, true));
}

/// Cells of one size over an area: triangles, tetrahedra in layers, or free ones through the thickness.
double cells_over(double area, double size, const MeshOptions &o) {
  const double triangles = area / (0.43 * size * size);
  if (o.dimension == 2) return triangles;
  const double thickness = o.thickness > 0 ? o.thickness : o.size;
  return 3 * triangles *
         (o.layers > 0 ? o.layers * (static_cast<double>(o.cuts.size()) + 1) : std::max(1., thickness / size));
}

/// The whole section in cells of --size and, beside these, its boxes in theirs as far as they lie in it.
double estimated_cells(const Section &section, const MeshOptions &o) {
  double cells = cells_over(section.area(), o.size, o);
  Vec<2> low = section.outline.points[0], high = low;
  for (const Vec<2> &x : section.domain())
    for (int d = 0; d < 2; ++d) low[d] = std::min(low[d], x[d]), high[d] = std::max(high[d], x[d]);
  for (const std::vector<RefinedBox> *boxes : {&section.boxes, &o.boxes})
    for (const RefinedBox &box : *boxes) {
      double area = 1;
      for (int d = 0; d < 2; ++d) area *= std::max(0., std::min(box.to[d], high[d]) - std::max(box.from[d], low[d]));
      if (box.size < o.size) cells += cells_over(std::min(area, section.area()), box.size, o);
    }
  return cells;
}

void check(const MeshOptions &o, const Section &section) {
  const double extent = section.largest_extent();
  if (!(o.size > 0)) complain("--size must be above 0 m");
  if (o.size > extent) {
    std::ostringstream text;
    text << "--size " << o.size << " m is larger than the section " << section.file << ", which measures " << extent
         << " m; take a smaller size";
    complain(text.str());
  }
  for (const RefinedBox &box : o.boxes)
    if (!(box.size > 0)) complain("--refine x0 y0 x1 y1 h needs a cell size h above 0 m");
  if (const double cells = estimated_cells(section, o); cells > most_cells) {
    std::ostringstream text;
    text << "the cell sizes would give about " << cells << " cells, more than " << most_cells << ", in a section of "
         << extent << " m; "
         << (section.unit_stated.empty() ? "coordinates count in metres, are these in millimetres? " +
                                               (section.drawn ? std::string("Set the unit in the drawing ($INSUNITS)")
                                                              : "State it in the header, part,x [mm],y [mm]") +
                                               ". Otherwise take"
                                         : "take")
         << " a larger --size, or larger "
            "cells in the boxes of --refine and refine_SIZE";
    complain(text.str());
  }
  if (o.thickness < 0) complain("--thickness must be above 0 m");
  if (o.layers < 0) complain("--layers must be 1 or more, or 0 for free tetrahedra");
  if (!o.cuts.empty() && o.dimension == 2) complain("--cuts part the thickness of a 3D body; give --dimension 3");
  for (std::size_t i = 0; i < o.cuts.size(); ++i)
    if (!(o.cuts[i] > (i ? o.cuts[i - 1] : 0) && o.cuts[i] < o.thickness))
      complain("--cuts must ascend between 0 and the thickness of " + std::to_string(o.thickness) + " m");
}

/// Measure of a simplex: length, area or volume.
template <int dim, int space>
double measure(const std::array<Vec<space>, dim + 1> &corner) {
  Eigen::Matrix<double, space, dim> edges;
  for (int k = 0; k < dim; ++k) edges.col(k) = map<space>(corner[k + 1]) - map<space>(corner[0]);
  return std::sqrt((edges.transpose() * edges).determinant()) / (dim == 3 ? 6 : dim);
}

template <int dim, int space>
void report_group(int group, const std::string &name, const char *what) {
  std::vector<int> tags;
  gmsh::model::getEntitiesForPhysicalGroup(dim, group, tags);
  std::size_t count = 0;
  double total = 0;
  for (int tag : tags)
    for (const auto &corner : corners_of<dim, space>(tag)) ++count, total += measure<dim, space>(corner);
  static const char *const units[] = {"", "m", "m2", "m3"};
  std::cout << "  " << what << " " << name << ": " << count << (dim == space ? " cells, " : " facets, ") << total << " "
            << units[dim] << "\n";
}

template <int dim>
std::string text_of(const Vec<dim> &x) {
  std::ostringstream text;
  for (int d = 0; d < dim; ++d) text << (d ? ", " : "(") << x[d];
  return text.str() + ")";
}

template <int dim>
void report_mesh() {
  Shape worst{1e300, 1};
  Vec<dim> flattest{}, worst_place{};  // centres of the cells with the smallest altitude and the worst quality
  double quality = 0;
  std::size_t count = 0;
  for (const auto &corner : corners_of<dim>(-1)) {
    const Shape one = shape<dim>(corner, Simplex<dim>(corner).gradient);
    Vec<dim> centre{};
    for (const Vec<dim> &x : corner)
      for (int d = 0; d < dim; ++d) centre[d] += x[d] / (dim + 1);
    if (one.altitude < worst.altitude) worst.altitude = one.altitude, flattest = centre;
    if (one.quality < worst.quality) worst.quality = one.quality, worst_place = centre;
    quality += one.quality, ++count;
  }
  std::vector<std::size_t> nodes;
  std::vector<double> x, parametric;
  gmsh::model::mesh::getNodes(nodes, x, parametric);
  std::cout << "cells " << count << ", nodes " << nodes.size() << ", smallest altitude " << worst.altitude << " m at "
            << text_of<dim>(flattest) << ", quality " << worst.quality << " at least, at " << text_of<dim>(worst_place)
            << ", " << quality / static_cast<double>(count) << " on average\n";
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups);
  for (int of : {dim, dim - 1})
    for (const auto &[dimension, group] : groups) {
      std::string name;
      gmsh::model::getPhysicalName(dimension, group, name);
      if (dimension != of) continue;
      if (of == dim)
        report_group<dim, dim>(group, name, "region");
      else
        report_group<dim - 1, dim>(group, name, "group");
    }
}

void check_writable(const std::string &file) {
  if (std::filesystem::path(file).extension() != ".msh") complain("--output " + file + " must end in .msh");
  if (!std::ofstream(file, std::ios::app))
    throw std::runtime_error(file + ": cannot be written; check the folder and its permissions");
}

/// Calls use(tag) for the entities of a group; for none where there is no such group.
template <class Use>
void each_entity(int dim, const std::string &name, Use &&use) {
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups, dim);
  for (const auto &[dimension, group] : groups) {
    std::string found;
    gmsh::model::getPhysicalName(dimension, group, found);
    std::vector<int> tags;
    gmsh::model::getEntitiesForPhysicalGroup(dimension, group, tags);
    for (const int tag : tags)
      if (found == name) use(tag);
  }
}

/// Volume of a group of cells; 0 where there is none [m3].
double volume_of(const std::string &name) {
  double volume = 0;
  each_entity(3, name, [&](int tag) {
    for (const auto &corner : corners_of<3>(tag)) volume += measure<3, 3>(corner);
  });
  return volume;
}

/// Area of a group of facets on which cells of a group stand [m2].
double area_under(const std::string &cells, const std::string &facets) {
  using Face = std::array<std::size_t, 3>;
  const auto nodes_of = [](int type, int tag) {
    std::vector<std::size_t> elements, nodes;
    gmsh::model::mesh::getElementsByType(type, elements, nodes, tag);
    return nodes;
  };
  const auto sorted = [](Face face) {
    std::ranges::sort(face);
    return face;
  };
  std::vector<Face> faces;
  each_entity(3, cells, [&](int tag) {
    const auto nodes = nodes_of(4, tag);
    for (std::size_t c = 0; c < nodes.size(); c += 4)
      for (const auto &[i, j, k] : {Face{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}})
        faces.push_back(sorted({nodes[c + i], nodes[c + j], nodes[c + k]}));
  });
  std::ranges::sort(faces);
  double area = 0;
  each_entity(2, facets, [&](int tag) {
    const auto nodes = nodes_of(2, tag);
    const auto corners = corners_of<2, 3>(tag);
    for (std::size_t f = 0; f < corners.size(); ++f)
      if (std::ranges::binary_search(faces, sorted({nodes[3 * f], nodes[3 * f + 1], nodes[3 * f + 2]})))
        area += measure<2, 3>(corners[f]);
  });
  return area;
}

/// Of several polygons of an outline one may have no cells though their sum has its volume.
void report_parts(const Terrain &terrain) {
  constexpr double much = 0.3;
  const auto &parts = terrain.parts();
  if (parts.size() < 2) return;
  std::vector<double> volume(parts.size(), 0);
  each_entity(3, "slide", [&](int tag) {
    for (const auto &corner : corners_of<3>(tag)) {
      Vec<3> middle{};
      for (const Vec<3> &x : corner)
        for (int d = 0; d < 3; ++d) middle[d] += x[d] / 4;
      volume[terrain.part_at(middle[0], middle[1])] += measure<3, 3>(corner);
    }
  });
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (!(parts[k].volume > 0) || std::abs(volume[k] / parts[k].volume - 1) < much) continue;
    std::cout << "warning: " << terrain.name_of(parts[k]) << ", has ";
    if (volume[k] > 0)
      std::cout << "cells of " << volume[k] << " m3, and " << parts[k].volume << " m3";
    else
      std::cout << "no cells, and " << parts[k].volume << " m3 of soil";
    std::cout << " between slip surface and ground. Take a smaller --size\n";
  }
}

/// Before anything is printed, and before the mesh is written.
void check_slide(const Terrain &terrain) {
  if (terrain.slides() && volume_of("slide") == 0)
    complain("the slide is thinner than its cells, and none has its centre in it; take a smaller --size");
}

void report_terrain(const Terrain &terrain) {
  if (terrain.slides()) {
    const double cells = volume_of("slide"), exact = terrain.slide_volume();
    std::cout << "slide " << exact << " m3 between slip surface and ground, " << exact / terrain.slide_area()
              << " m thick on average; its cells hold " << cells << " m3 (" << std::showpos << 100 * (cells / exact - 1)
              << std::noshowpos << " %)\n";
    constexpr double much = 0.05;  // more than other uncertainties of a volume that slides
    if (cells > 0 && std::abs(cells / exact - 1) > much)
      std::cout << "warning: the cells of the slide hold " << cells << " m3, and between slip surface and ground are "
                << exact << " m3: a cell belongs to the slide if its centre does. Take a smaller --size\n";
    if (!terrain.options().base && cells > 0) {
      const double surface = terrain.slip_surface_area(), stands = area_under("slide", "base");
      std::cout << "slip surface " << surface << " m2 under the slide; its cells stand on " << stands << " m2 ("
                << std::showpos << 100 * (stands / surface - 1) << std::noshowpos << " %)\n";
      if (std::abs(stands / surface - 1) > much)
        std::cout << "warning: the cells of the slide stand on " << stands << " m2 of the slip surface, which measures "
                  << surface << " m2 under the slide: friction does not depend on it, and adhesion of the base acts on "
                  << "so much " << (stands < surface ? "less" : "more") << ". Take a smaller --size\n";
    }
  }
  report_parts(terrain);
  const auto &layers = terrain.options().layers;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const auto &[name, file] = layers[k];
    if (volume_of(name) > 0) continue;
    std::cout << "warning: layer " << name << " has no cells: ";
    if (const std::string above = terrain.layer_above(static_cast<int>(k)); !above.empty())
      std::cout << "its surface, " << file << ", lies below that of layer " << above
                << ", which is given after it, everywhere. Give the surfaces from top to bottom\n";
    else
      std::cout << "no cell of the ground has its centre below " << file << " and above the next layer\n";
  }
  for (const std::string &doubt : terrain.doubts()) std::cout << "warning: " << doubt << "\n";
}

void check(const Terrain &terrain) {
  const TerrainOptions &o = terrain.options();
  if (!(o.size > 0)) complain("--size must be above 0 m");
  const double height = o.air + (o.base ? terrain.ground()[0] - *o.base : 0), cells_per_volume = 8.5;
  const double area = terrain.slides() ? terrain.slide_area() : terrain.width() * terrain.depth(),
               cells = cells_per_volume * area * height / std::pow(o.size, 3);
  if (cells > most_cells) {
    std::ostringstream text;
    text << "the cell size would give about " << cells << " cells, more than " << most_cells
         << "; take a larger --size, or a smaller window";
    complain(text.str());
  }
}

/// "cells of 2 m, in boxes of 0.5 m".
std::string sizes(const MeshSource &mesh, const std::optional<Section> &section) {
  std::ostringstream text;
  text << "cells of " << mesh.size << " m";
  if (!section) {
    if (mesh.terrain.far_size > 0) text << ", and of " << mesh.terrain.far_size << " m far away";
    return text.str();
  }
  std::set<double> refined;
  for (const RefinedBox &box : section->boxes) refined.insert(box.size);
  for (const RefineBox &box : mesh.refine) refined.insert(box.size);
  for (const double size : refined) text << (size == *refined.begin() ? ", in boxes of " : ", ") << size;
  if (!refined.empty()) text << " m";
  return text.str();
}

void write_grid(const Job &job) {
  const Grid grid = read_grid(job.grid);
  check_same_projection(location_of(grid), job.projection, job.terrain_of_projection);
  for (const std::string &remark : grid.remarks) std::cout << "warning: " << remark << "\n";
  write_values(grid, job.file);
}

void make_mesh(const Job &job) {
  const MeshRequest &request = job.request;
  std::optional<Section> section;
  std::optional<Terrain> terrain;
  const MeshOptions options = section_options(request);
  if (!request.mesh.section.empty())
    check(options, section.emplace(section_in(request.mesh.section)));
  else
    check(terrain.emplace(terrain_options(request.mesh)));
  const bool existed = std::filesystem::exists(job.file);
  check_writable(job.file);
  gmsh::initialize();
  try {
    section ? mesh_section(*section, options) : mesh_terrain(*terrain);
    if (terrain) check_slide(*terrain);
    gmsh::option::setNumber("Mesh.MshFileVersion", job.format == "2.2" ? 2.2 : 4.1);
    gmsh::write(job.file);
    std::cout << job.file << " from " << job.source() << ", in " << sizes(request.mesh, section) << "\n";
    if (section && request.dimension == 2)
      report_mesh<2>();
    else
      report_mesh<3>();
    if (terrain) {
      report_terrain(*terrain);
      std::filesystem::path origin = job.file;
      std::ofstream(origin.replace_extension(".origin.json")) << terrain->origin_document();
      std::cout << "origin of x and y for maps: " << origin.string() << "\n";
    }
  } catch (...) {
    gmsh::finalize();
    if (!existed) std::filesystem::remove(job.file);
    throw;
  }
  gmsh::finalize();
}

std::string text_in(const std::string &file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Talus itself begins with --request or --values. Returns 0, or the exit status + 1 where nothing is to be done.
int parse(int argc, char **argv, Job &job) {
  CLI::App app(
      "Meshes a cross-section (CSV rows part,x,y, or a DXF drawing) or terrain (a grid of elevations) for "
      "Talus.",
      "talus-mesh");
  const std::string first = argc > 1 ? argv[1] : "";
  std::string file;
  std::function<MeshRequest()> request = [&] { return mesh_request_in(text_in(file)); };
  app.add_option("-o,--output", job.file, "mesh file to write")->required();
  if (first == "--values") {
    app.add_option("--values", job.grid, "write the values of this grid for Talus to read, and no mesh");
    app.add_option("--projection", job.projection, "well-known text of the projection to compare with");
    app.add_option("--projection-of", job.terrain_of_projection, "the file that has this projection");
  } else if (first == "--request") {
    app.add_option("--request", file, "what the mesh is made from, see meshes/mesh_request.h");
  } else {
    request = add_mesh_options(app);
  }
  app.add_option("--format", job.format, "of the mesh file: 2.2 or 4.1")->check(CLI::IsMember({"2.2", "4.1"}));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError &error) {
    return app.exit(error) ? 3 : 1;
  }
  if (job.grid.empty()) job.request = request();
  return 0;
}

}  // namespace
}  // namespace talus

/// Exit status 0: a mesh was written; 2: bad input; 1: anything else.
int main(int argc, char **argv) {
  talus::Job job;
  try {
    if (const int status = talus::parse(argc, argv, job)) return status - 1;
    job.grid.empty() ? talus::make_mesh(job) : talus::write_grid(job);
  } catch (const std::invalid_argument &error) {
    std::cerr << "talus-mesh: " << error.what() << "\n";
    return 2;
  } catch (const std::bad_alloc &) {
    std::cerr
        << "talus-mesh: the memory of this machine, or a limit of it (ulimit -v), does not suffice: take a larger "
           "--size\n";
    return 1;
  } catch (const std::exception &error) {
    std::cerr << "talus-mesh: " << error.what() << "\n";
    return 1;
  } catch (const std::string &error) {
    std::cerr << "talus-mesh: Gmsh: " << error << "\n";
    if (error.find("PLC Error") != std::string::npos)
      std::cerr << "talus-mesh: two surfaces of the mesh cross; where a cliff is higher than the free space above the "
                   "ground, more --air keeps them apart, else a smaller --size\n";
    return 1;
  }
  return 0;
}
