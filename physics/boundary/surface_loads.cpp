#include "physics/boundary/surface_loads.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/room.h"
#include "meshes/locate.h"
#include "scene/body_source.h"

namespace talus {
namespace {

/// Points of second order on a facet, in its barycentric coordinates; equal weights.
template <int dim>
std::array<std::array<double, dim>, dim> facet_points() {
  constexpr double near = dim == 2 ? 0.78867513459481288 : 2. / 3;  // (1 + 1 / sqrt 3) / 2; 2/3
  std::array<std::array<double, dim>, dim> points;
  for (int k = 0; k < dim; ++k) points[k].fill((1 - near) / (dim - 1)), points[k][k] = near;
  return points;
}

/// Normals follow by Nanson's formula, n ~ F^-T N; their length stays.
template <int dim>
Vec<dim> carried_normal(const Square<dim> &f, const Vec<dim> &normal) {
  Vec<dim> result;
  map<dim>(result) = f.inverse().transpose() * map<dim>(normal);
  const double length = map<dim>(result).norm();
  if (length > 0) map<dim>(result) *= map<dim>(normal).norm() / length;
  return result;
}

/// Deformation gradient of a cell since the remap.
template <int dim>
Square<dim> deformation(const Cell<dim> &cell, const std::array<int, dim + 1> &node, const Vec<dim> *position) {
  Square<dim> f = Square<dim>::Zero();
  for (int k = 0; k < dim; ++k)
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) f(i, j) += (position[node[k + 1]][i] - position[node[0]][i]) * cell.gradient[k][j];
  return f;
}

/// Looks across facets into the cells of a set, also those of other ranks.
template <int dim>
class CellsBeyond {
 public:
  /// `set` [local cells]. Collective.
  CellsBeyond(const BackgroundMesh<dim> &mesh, const std::vector<char> &set)
      : mesh_(mesh), set_(set), across_(mesh.across(set)) {}
  /// Is the cell on the other side of a facet in the set?
  bool operator()(const Facet<dim> &f) const {
    const int across = mesh_.cells[f.cell].neighbour[f.face];
    if (across >= boundary) return across >= 0 && set_[across];
    return across_[-2 - across] != 0;
  }

 private:
  const BackgroundMesh<dim> &mesh_;
  const std::vector<char> &set_;
  const std::vector<char> across_;  // by partition face
};

}  // namespace

template <int dim>
void SurfaceLoads<dim>::share(const BackgroundMesh<dim> &mesh, const std::vector<char> &filled) {
  const CellsBeyond<dim> beyond(mesh, filled);
  for (Face &face : faces_)
    for (const Facet<dim> &f : face.facets) face.share.push_back(beyond(f) ? 0.5 : 1);
}

template <int dim>
int SurfaceLoads<dim>::find_cancelled(const BackgroundMesh<dim> &mesh, const std::vector<char> &soil) const {
  const CellsBeyond<dim> beyond(mesh, soil);
  std::vector<int> open(face_count(), 0);  // facets that bear their load, or may come to bear it
  for (int k = 0; k < face_count(); ++k)
    for (const Facet<dim> &f : faces_[k].facets) open[k] += !faces_[k].follows || !soil[f.cell] || !beyond(f);
  if (face_count()) MPI_Allreduce(MPI_IN_PLACE, open.data(), face_count(), MPI_INT, MPI_SUM, mesh.comm());
  const auto found = std::find(open.begin(), open.end(), 0);
  return found == open.end() ? -1 : faces_[found - open.begin()].source;
}

template <int dim>
void SurfaceLoads<dim>::seed(Body<dim> &body, const BackgroundMesh<dim> &mesh) const {
  ParticleArrays<dim> &p = body.particles();
  const int faces = face_count();
  if (!faces) return;
  std::fill_n(p.surface.data(), static_cast<size_t>(p.count) * faces, SurfacePiece<dim>{});
  std::unordered_map<int, int> first;  // particles of a cell stand together
  for (int i = p.count - 1; i >= 0; --i) first[p.cell[i]] = i;
  const auto &displacement = body.source().displacement;
  for (int k = 0; k < faces; ++k)
    for (size_t j = 0; j < faces_[k].facets.size(); ++j) {
      const Facet<dim> &f = faces_[k].facets[j];
      const auto found = first.find(f.cell);
      if (found == first.end()) continue;
      for (const auto &point : facet_points<dim>()) {
        Vec<dim> place{};
        for (int a = 0; a < dim; ++a)
          for (int d = 0; d < dim; ++d) place[d] += point[a] * mesh.position[f.node[a]][d];
        int host = found->second;
        double nearest = 1e300;
        for (int i = host; i < p.count && p.cell[i] == f.cell; ++i) {
          const SurfacePiece<dim> &present = p.surface[i * faces + k];
          const bool around_a_corner = present.area > 0 && map<dim>(present.normal).dot(map<dim>(f.normal)) <
                                                               0.999;  // one mean place would not do
          const double distance =
              (map<dim>(p.reference[i]) - map<dim>(place)).squaredNorm() + (around_a_corner ? 1e100 : 0);
          if (distance < nearest * (1 - 1e-9)) nearest = distance, host = i;
        }
        // several points of one host are one piece at their mean
        SurfacePiece<dim> &piece = p.surface[host * faces + k];
        const double area = faces_[k].share[j] * f.area / dim, before = piece.area;
        piece.area += area;
        for (int d = 0; d < dim; ++d) {
          piece.normal[d] = (before * piece.normal[d] + area * f.normal[d]) / piece.area;
          piece.place[d] = (before * piece.place[d] + area * place[d]) / piece.area;
        }
      }
    }
  for (int i = 0; i < p.count; ++i)
    for (int k = 0; k < faces; ++k) {
      SurfacePiece<dim> &piece = p.surface[i * faces + k];
      if (piece.area == 0) continue;
      Vec<dim> now = piece.place;
      if (!displacement.empty()) {
        const Vec<dim> &x = piece.place;
        for (int d = 0; d < dim; ++d) now[d] += displacement[d](x[0], x[1], dim == 3 ? x[dim - 1] : 0, 0);
        piece.normal = carried_normal<dim>(
            displacement_gradient<dim>(displacement, x, 1e-5 * mesh.mean_edge[mesh.cells[p.cell[i]].node[0]]),
            piece.normal);
      }
      map<dim>(piece.offset) = map<dim>(now) - map<dim>(p.position[i]);
    }
}

template <int dim>
int SurfaceLoads<dim>::find_idle(MPI_Comm comm, const std::vector<std::unique_ptr<Body<dim>>> &bodies) const {
  const int faces = face_count();
  std::vector<double> area(faces, 0);
  for (const auto &body : bodies)
    for (int i = 0; i < body->particles().count * faces; ++i) area[i % faces] += body->particles().surface[i].area;
  if (faces) MPI_Allreduce(MPI_IN_PLACE, area.data(), faces, MPI_DOUBLE, MPI_SUM, comm);
  for (int k = 0; k < faces; ++k)
    if (area[k] == 0) return faces_[k].source;
  return -1;
}

template <int dim>
void SurfaceLoads<dim>::begin(const std::vector<std::unique_ptr<Body<dim>>> &bodies, const FilledGrid<dim> &grid) {
  constexpr double farthest = -1;  // a piece farther out has lost its soil, which has come apart: it is drawn in
  const int faces = face_count();
  active_.clear();
  if (!faces) return;
  for (const auto &body : bodies) {
    ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i)
      for (int k = 0; k < faces; ++k) {
        SurfacePiece<dim> &piece = p.surface[i * faces + k];
        if (piece.area == 0) continue;
        const Cell<dim> &cell = grid.mesh().cells[p.cell[i]];
        Active a{&piece, k, p.cell[i], grid.shape[grid.find_cell(p.cell[i])].node, {}, {}};
        for (int attempt = 0; attempt < 2; ++attempt) {
          Vec<dim> x;
          map<dim>(x) = map<dim>(p.position[i]) + map<dim>(piece.offset);
          a.coordinate = barycentric(cell, x);
          const double outside = *std::min_element(a.coordinate.begin(), a.coordinate.end());
          if (outside >= farthest) break;
          for (double &component : piece.offset) component *= farthest / (outside - 1);
        }
        active_.push_back(a);
      }
  }
}

template <int dim>
void SurfaceLoads<dim>::add(double t, const FilledGrid<dim> &grid, const Vec<dim> *position, Vec<dim> *force) {
  for (Active &a : active_) {
    const Face &face = faces_[a.face];
    if (face.follows) {
      Vec<dim> x{}, normal;
      for (int k = 0; k <= dim; ++k)
        for (int d = 0; d < dim; ++d) x[d] += a.coordinate[k] * position[a.node[k]][d];
      normal = carried_normal<dim>(deformation<dim>(grid.mesh().cells[a.mesh_cell], a.node, position), a.piece->normal);
      a.force = face.load(normal, x, t);
    } else {
      a.force = face.load({}, a.piece->place, t);
    }
    for (double &component : a.force) component *= a.piece->area;
    for (int k = 0; k <= dim; ++k)
      for (int d = 0; d < dim; ++d) force[a.node[k]][d] += a.coordinate[k] * a.force[d];
  }
}

template <int dim>
void SurfaceLoads<dim>::add_work(const Vec<dim> *u, std::vector<double> &work) const {
  for (const Active &a : active_)
    for (int k = 0; k <= dim; ++k)
      for (int d = 0; d < dim; ++d) work[faces_[a.face].source] += a.coordinate[k] * a.force[d] * u[a.node[k]][d];
}

template <int dim>
PetscErrorCode SurfaceLoads<dim>::end(FilledGrid<dim> &grid, const std::vector<double> &weight) {
  PetscFunctionBeginUser;
  constexpr int square = dim * dim, width = square + 1;
  if (faces_.empty()) PetscFunctionReturn(0);
  if (nodal_.empty()) make_room(nodal_, static_cast<size_t>(grid.mesh().node_count()) * width);
  std::fill_n(nodal_.begin(), grid.node_count() * width, 0.);
  for (int c = 0; c < grid.cell_count(); ++c) {
    const Square<dim> f =
        weight[c] * deformation<dim>(grid.mesh().cells[grid.mesh_cell[c]], grid.shape[c].node, grid.position.data());
    for (const int i : grid.shape[c].node) {
      Eigen::Map<Square<dim>>(&nodal_[i * width]) += f;
      nodal_[i * width + square] += weight[c];
    }
  }
  PetscCall(grid.sum(nodal_.data(), width));
  for (const Active &a : active_) {
    Square<dim> f = Square<dim>::Zero();
    double sum = 0;
    for (int k = 0; k <= dim; ++k) {
      const double *node = &nodal_[a.node[k] * width], part = std::max(0., a.coordinate[k]);
      f += part / node[square] * Eigen::Map<const Square<dim>>(node), sum += part;
    }
    f /= sum;
    map<dim>(a.piece->offset) = (f * map<dim>(a.piece->offset)).eval();
    a.piece->normal = carried_normal<dim>(f, a.piece->normal);
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode SurfaceLoads<dim>::mean_displacements(const FilledGrid<dim> &grid, std::vector<Vec<dim>> &mean) const {
  PetscFunctionBeginUser;
  constexpr int width = dim + 1;
  std::vector<double> sums(faces_.size() * width, 0);
  for (const Active &a : active_) {
    sums[a.face * width + dim] += a.piece->area;
    for (int d = 0; d < dim; ++d) {
      double x = -a.piece->place[d];
      for (int k = 0; k <= dim; ++k) x += a.coordinate[k] * grid.position[a.node[k]][d];
      sums[a.face * width + d] += a.piece->area * x;
    }
  }
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, grid.mesh().comm()));
  for (size_t k = 0; k < faces_.size(); ++k)
    for (int d = 0; d < dim; ++d) {
      const double area = sums[k * width + dim];  // none where the soil behind the face has been removed
      mean[faces_[k].source][d] = area > 0 ? sums[k * width + d] / area : 0;
    }
  PetscFunctionReturn(0);
}

template class SurfaceLoads<2>;
template class SurfaceLoads<3>;

}  // namespace talus
