#include "meshes/complaints.h"

#include <sstream>
#include <stdexcept>

#include "meshes/simplex.h"
#include "meshes/soundness.h"

namespace talus {
namespace {

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

template <int dim>
std::string complaint_about_cells(const std::string &source, const Simplices<dim> &cells, const CellTree<dim> &tree,
                                  const Regions &regions, Names names) {
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
  if (const auto [one, other] = overlapping_cells<dim>(cells, tree); one >= 0)
    return complain(one, "overlaps " + describe(cells, regions, other) +
                             ", which shares no side with it: parts of the mesh lie in one place; fragment the "
                             "geometry (Gmsh: BooleanFragments), or leave one part out");
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

template std::string complaint_about_cells(const std::string &, const Simplices<2> &, const CellTree<2> &,
                                           const Regions &, Names);
template std::string complaint_about_cells(const std::string &, const Simplices<3> &, const CellTree<3> &,
                                           const Regions &, Names);

}  // namespace talus
