#include "meshes/gmsh_file.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "meshes/simplex.h"

namespace talus {
namespace {

const char *kind_of_dimension(int dimension) {
  static const char *const kinds[] = {"points", "curves", "surfaces", "volumes"};
  return 0 <= dimension && dimension <= 3 ? kinds[dimension] : "entities of unknown dimension";
}

/// What a pass over the lines of a Gmsh file finds; blocks of binary numbers are lines like others.
struct Outline {
  std::string version;
  int file_type = 0;  ///< 0: text, 1: binary
  bool nodes = false, elements = false, named = false, bad_names = false;
  std::vector<PhysicalName> names;
};

bool read_names(std::istream &in, std::vector<PhysicalName> &names) {
  std::string line;
  int count;
  if (!(std::getline(in, line) && std::istringstream(line) >> count)) return false;
  for (int i = 0; i < count; ++i) {
    PhysicalName one;
    if (!(std::getline(in, line) && std::istringstream(line) >> one.dimension >> one.tag)) return false;
    const auto open = line.find('"'), close = line.rfind('"');
    if (open == close) return false;
    one.name = line.substr(open + 1, close - open - 1);
    names.push_back(one);
  }
  return true;
}

Outline outline_of(std::istream &in) {
  Outline outline;
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] != '$') continue;
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    if (line == "$MeshFormat" && std::getline(in, line))
      std::istringstream(line) >> outline.version >> outline.file_type;
    if (line == "$PhysicalNames") outline.named = true, outline.bad_names = !read_names(in, outline.names);
    if (line == "$EndNodes") outline.nodes = true;
    if (line == "$EndElements") outline.elements = true;
  }
  return outline;
}

std::string complaint_about_names(const std::vector<PhysicalName> &names, int dimension) {
  int highest = 0;
  for (const PhysicalName &one : names) {
    highest = std::max(highest, one.dimension);
    if (is_reserved_label(one.name))
      return "the group name '" + one.name + "' is taken by DMPlex; rename the physical group";
    if (one.name.empty()) return "a physical group has an empty name; name it in Gmsh";
  }
  if (highest == dimension) return "";
  std::ostringstream text;
  text << "its named groups are " << kind_of_dimension(highest) << " at most, but a mesh of dimension " << dimension
       << " needs named groups of " << kind_of_dimension(dimension) << "; ";
  if (highest > dimension) return text.str() + "mesh it in 2D, or set dimension = 3 in the scene";
  return text.str() + "add the physical groups in Gmsh (talus-mesh writes them), or change the scene's dimension";
}

/// Lets PETSc read the cells quietly, so that whatever it refuses becomes a complaint and not an abort.
std::string complaint_of_petsc(const GmshFile &file, int dimension) {
  Dm plex;
  PetscInt found = -1, first = 0, end = 0;
  if (PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr)) return "PETSc failed";
  const PetscErrorCode error = open_gmsh(PETSC_COMM_SELF, file, false, plex.create());
  if (PetscPopErrorHandler()) return "PETSc failed";
  if (error) {
    const char *text = nullptr;
    (void)PetscErrorMessage(error, &text, nullptr);
    return std::string("PETSc cannot read it (") + (text ? text : "unknown error") +
           "); save it again from Gmsh as format 2.2 or 4.1";
  }
  require(DMGetDimension(plex, &found));
  require(DMPlexGetHeightStratum(plex, 0, &first, &end));
  if (found != dimension || first == end)
    return "its cells are " + std::string(kind_of_dimension(static_cast<int>(found))) + ", but a mesh of dimension " +
           std::to_string(dimension) + " needs " + kind_of_dimension(dimension) + "; mesh it in " +
           std::to_string(dimension) + "D, or change the scene's dimension";
  for (PetscInt cell = first; cell < end; ++cell) {
    DMPolytopeType type;
    require(DMPlexGetCellType(plex, cell, &type));
    if (type != (dimension == 2 ? DM_POLYTOPE_TRIANGLE : DM_POLYTOPE_TETRAHEDRON))
      return "cell " + std::to_string(cell - first) + " is of type " + DMPolytopeTypes[type] + ", but Talus takes " +
             (dimension == 2 ? "triangles" : "tetrahedra") + " only; mesh without recombination";
  }
  return "";
}

template <int dim>
std::string describe(const Simplices<dim> &cells, const Regions &regions, int cell) {
  std::ostringstream text;
  text << "cell " << cell << " (centroid ";
  const auto corner = cells.corners(cell);
  for (int d = 0; d < dim; ++d) {
    double sum = 0;
    for (const auto &x : corner) sum += x[d];
    text << (d ? ", " : "") << sum / (dim + 1);
  }
  for (const std::string &name : regions.names[regions.combination[cell]]) text << ", in " << name;
  text << ")";
  return text.str();
}

/// Two cells that share a face must lie on its two sides.
template <int dim>
bool overlap(const Simplices<dim> &cells, int cell, int face) {
  const int other = cells.neighbour[cell][face];
  if (other < cell) return false;
  auto mirrored = cells.corners(cell);
  for (int k = 0; k <= dim; ++k)
    if (cells.neighbour[other][k] == cell) mirrored[face] = cells.position[cells.node[other][k]];
  return Simplex<dim>(mirrored).volume >= 0;
}

}  // namespace

std::string complaint_about_file(GmshFile &file, int dimension) {
  std::ifstream in(file.name, std::ios::binary);
  if (!in || in.peek() == std::ifstream::traits_type::eof())
    return file.name + ": cannot be read or is empty; check the path and its permissions";
  const Outline outline = outline_of(in);
  file.binary = outline.file_type != 0;
  file.entities = !outline.version.empty() && outline.version[0] == '4';
  file.groups = outline.names;
  std::string wrong;
  if (outline.version.empty())
    wrong = "is not a Gmsh mesh (no $MeshFormat); give a .msh file, format 2.2 or 4.1";
  else if (outline.version != "2.2" && outline.version != "4" && outline.version != "4.0" && outline.version != "4.1")
    wrong = "is of Gmsh format " + outline.version + "; save it as format 2.2 or 4.1";
  else if (!outline.named || outline.names.empty())
    wrong = "has no named groups ($PhysicalNames); add physical groups with names in Gmsh (talus-mesh writes them)";
  else if (outline.bad_names)
    wrong = "has a damaged $PhysicalNames section; save it again from Gmsh";
  else if (!outline.nodes || !outline.elements)
    wrong = "ends early (no $EndNodes or no $EndElements); save it again from Gmsh";
  if (wrong.empty()) wrong = complaint_about_names(outline.names, dimension);
  if (wrong.empty()) wrong = complaint_of_petsc(file, dimension);
  return wrong.empty() ? "" : file.name + ": " + wrong;
}

template <int dim>
std::string complaint_about_cells(const std::string &source, const Simplices<dim> &cells, const Regions &regions,
                                  Names names) {
  const auto complain = [&](int cell, const std::string &text) {
    return source + ": " + describe(cells, regions, cell) + " " + text;
  };
  if (cells.crowded >= 0)
    return complain(cells.crowded,
                    "shares a face with more than one other cell; a cell may be in the file twice (format 2.2 repeats "
                    "a cell for each of its groups: put it in one group, or save as 4.1)");
  for (int c = 0; c < static_cast<int>(cells.node.size()); ++c) {
    const auto corner = cells.corners(c);
    if (has_no_volume<dim>(corner, Simplex<dim>(corner).volume))
      return complain(c, dim == 2 ? "has no area; remesh, or move its nodes off one line"
                                  : "has no volume; remesh, or move its nodes off one plane");
    if (names == Names::required && regions.names[regions.combination[c]].empty())
      return complain(c, "is in no named group of cells; give every part of the mesh a physical group with a name");
  }
  for (int c = 0; c < static_cast<int>(cells.node.size()); ++c)
    for (int k = 0; k <= dim; ++k)
      if (overlap<dim>(cells, c, k))
        return complain(c, "overlaps " + describe(cells, regions, cells.neighbour[c][k]) +
                               ": one of them is inverted; remesh there");
  return "";
}

std::string complaint_about_plex(DM plex, int dimension) {
  PetscInt found, overlap, depth, first, end;
  require(DMGetDimension(plex, &found));
  require(DMPlexGetOverlap(plex, &overlap));
  require(DMPlexGetDepth(plex, &depth));
  if (found != dimension)
    return "the DMPlex is of dimension " + std::to_string(found) + ", not " + std::to_string(dimension);
  if (overlap > 0) return "the DMPlex has an overlap of cells; distribute it with overlap 0";
  require(DMPlexGetHeightStratum(plex, 0, &first, &end));
  if (first < end && depth != dimension) return "the DMPlex has no faces or edges; call DMPlexInterpolate first";
  for (PetscInt cell = first; cell < end; ++cell) {
    DMPolytopeType type;
    require(DMPlexGetCellType(plex, cell, &type));
    if (type != (dimension == 2 ? DM_POLYTOPE_TRIANGLE : DM_POLYTOPE_TETRAHEDRON))
      return "cell " + std::to_string(cell) + " of the DMPlex is of type " + DMPolytopeTypes[type] + ", not a simplex";
  }
  return "";
}

void agree(MPI_Comm comm, const std::string &complaint) {
  int rank, size, first;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &size);
  const int mine = complaint.empty() ? size : rank;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == size) return;
  int length = static_cast<int>(complaint.size());
  MPI_Bcast(&length, 1, MPI_INT, first, comm);
  std::string text = complaint;
  text.resize(length);
  MPI_Bcast(text.data(), length, MPI_CHAR, first, comm);
  throw std::invalid_argument(text);
}

void require(PetscErrorCode error) {
  if (!error) return;
  const char *text = nullptr;
  (void)PetscErrorMessage(error, &text, nullptr);
  throw std::runtime_error(std::string("PETSc: ") + (text ? text : "unknown error"));
}

template std::string complaint_about_cells(const std::string &, const Simplices<2> &, const Regions &, Names);
template std::string complaint_about_cells(const std::string &, const Simplices<3> &, const Regions &, Names);

}  // namespace talus
