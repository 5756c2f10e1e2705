#include "simulation/mesh_ends.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "scene/boundary_source.h"
#include "scene/mesh_source.h"
#include "scene/scene.h"
#include "simulation/failure.h"

namespace talus {
namespace {

/// A named group of faces: its number among all, and whether a boundary acts on it.
struct Group {
  int number = -1;
  bool has_boundary = false, slips = true;
};

/// Of each local face of a named group, by cell and face, its group; one with a boundary, where it has several.
template <int dim>
std::map<std::pair<int, int>, Group> groups_of_faces(const World<dim> &world) {
  std::map<std::pair<int, int>, Group> group_of;
  const std::vector<std::string> &names = world.mesh.group_names();
  for (std::size_t g = 0; g < names.size(); ++g) {
    const bool bounded =
        std::any_of(world.scene.boundary.begin(), world.scene.boundary.end(), [&](const BoundarySource &boundary) {
          return std::count(boundary.group.begin(), boundary.group.end(), names[g]);
        });
    const bool slips = std::ranges::none_of(world.conditions.sources(), [&](const auto &source) {
      if (!std::ranges::count(source.groups, names[g]) || source.kind.fluids_only()) return false;
      if (source.kind.in_motion != OnSoil::support) return true;
      Vec<dim> normal{};
      normal[0] = 1;
      const auto &find = source.kind.template on_soil<dim>().directions;
      return !find || static_cast<int>(find(normal).size()) == dim;
    });
    for (const Facet<dim> &facet : world.mesh.facets(names[g])) {
      Group &group = group_of[{facet.cell, facet.face}];
      if (group.number < 0 || (bounded && !group.has_boundary)) group = {static_cast<int>(g), bounded, slips};
    }
  }
  return group_of;
}

}  // namespace

template <int dim>
MeshEnds<dim>::MeshEnds(const World<dim> &world) : world_(world), told_(planes) {
  find_faces();
}

template <int dim>
void MeshEnds<dim>::serialize(Archive &archive) {
  archive.serialize("ends of the mesh", told_);
  if (archive.reading()) find_faces();
}

/// Faces of the cells that this rank has now.
template <int dim>
void MeshEnds<dim>::find_faces() {
  const World<dim> &world = world_;
  faces_.clear();
  constexpr double far = std::numeric_limits<double>::infinity();
  std::array<double, planes> end;  // against the outward normal of each plane
  end.fill(far);
  const auto outward = [](int plane, const Vec<dim> &x) { return plane % 2 ? x[plane / 2] : -x[plane / 2]; };
  for (const Vec<dim> &x : world.mesh.position)
    for (int p = 0; p < planes; ++p) end[p] = std::min(end[p], -outward(p, x));
  MPI_Allreduce(MPI_IN_PLACE, end.data(), planes, MPI_DOUBLE, MPI_MIN, world.comm);
  std::copy_n(end.begin(), planes, end_);
  const auto group_of = groups_of_faces(world);
  for (int c = 0; c < world.mesh.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k) {
      if (world.mesh.cells[c].neighbour[k] != boundary) continue;
      for (int p = 0; p < planes; ++p) {
        double face = 0, depth = 0;  // distances from the plane
        for (int a = 0; a <= dim; ++a) {
          const double distance = -end[p] - outward(p, world.mesh.position[world.mesh.cells[c].node[a]]);
          (a == k ? depth : face) = std::max(a == k ? depth : face, distance);
        }
        if (face > 1e-6 * depth) continue;
        const auto named = group_of.find({c, k});
        const Group group = named == group_of.end() ? Group{} : named->second;
        if (!group.has_boundary && world.scene.mesh->leaving_particles == WhenOutside::remove) continue;  // it goes on
        if (p == bottom() && group.slips) continue;
        faces_.push_back({c, p, group.number, depth, group.slips});
      }
    }
}

template <int dim>
std::vector<std::string> MeshEnds<dim>::newly_reached(const std::string &stage) {
  std::array<Found, planes> mine;
  for (const auto &body : world_.bodies) {
    const ParticleArrays<dim> &p = body->particles();
    auto first = faces_.begin();
    for (int i = 0; i < p.count; ++i) {
      if (i > 0 && p.cell[i] < p.cell[i - 1]) first = faces_.begin();  // particles of a cell stand together
      first = std::lower_bound(first, faces_.end(), p.cell[i], [](const Face &f, int cell) { return f.cell < cell; });
      for (auto face = first; face != faces_.end() && face->cell == p.cell[i]; ++face) {
        const int d = face->plane / 2;
        if (face->plane == bottom()) continue;  // soil lies on it
        const double moved = (face->plane % 2 ? 1 : -1) * (p.position[i][d] - p.reference[i][d]);
        Found &found = mine[face->plane];
        if (moved <= face->depth || (found.id >= 0 && found.id <= p.id[i])) continue;
        found.id = p.id[i], found.group = face->group;
        std::copy_n(p.position[i].begin(), dim, found.place);
      }
    }
  }
  int ranks;
  MPI_Comm_size(world_.comm, &ranks);
  std::vector<Found> all(static_cast<std::size_t>(ranks) * planes);
  MPI_Allgather(mine.data(), sizeof mine, MPI_BYTE, all.data(), sizeof mine, MPI_BYTE, world_.comm);
  std::vector<std::string> sentences;
  for (int plane = 0; plane < planes; ++plane) {
    const Found *first = nullptr;
    for (int rank = 0; rank < ranks; ++rank) {
      const Found &found = all[rank * planes + plane];
      if (found.id >= 0 && (!first || found.id < first->id)) first = &found;
    }
    if (!first || told_[plane]) continue;
    told_[plane] = 1;
    if (world_.scene.acknowledges("mesh_end")) continue;
    std::string place;
    for (int d = 0; d < dim; ++d) place += (d ? ", " : "") + rounded(first->place[d]);
    const bool top = plane == 2 * world_.scene.vertical() + 1;
    sentences.push_back("moving soil has come to the end of the mesh near (" + place + ") m, at " +
                        (first->group < 0
                             ? "a face that no group names"
                             : "the group " + world_.mesh.group_names()[static_cast<std::size_t>(first->group)]) +
                        ", in stage " + stage + ": from now on " + (top ? "its height" : "its run-out") +
                        " is that of the mesh. Give the mesh more free space " + (top ? "above" : "there") +
                        ", unless a wall stands there in nature [mesh_end]");
  }
  return sentences;
}

template <int dim>
typename MeshEnds<dim>::Sheared MeshEnds<dim>::sheared(const Soil &soil, const OfPlanes &size, bool mechanism) const {
  constexpr double strip = 0.2;    // of the height of the soil: of selborne, whatever its cells, a shear band and more
  constexpr double hardly = 0.01;  // strain of soil that slides without shearing
  constexpr double few = 0.3;      // of the mean mass: parts with less of it are corners
  constexpr double bare = 0.05;    // of the bottom
  constexpr double thin = 2;       // cells
  constexpr int most_parts = 100;  // along an axis
  const int up = world_.scene.vertical();
  constexpr double far = std::numeric_limits<double>::infinity();
  double range[2]{-far, -far}, sums[2]{};  // highest and lowest soil, the latter negative
  soil([&](const Point &p) {
    range[0] = std::max(range[0], p.start[up]), range[1] = std::max(range[1], -p.start[up]);
    sums[0] += p.mass * p.strain, sums[1] += p.mass * p.strain * p.strain;
  });
  MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_DOUBLE, MPI_MAX, world_.comm);
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, world_.comm);
  Sheared found;
  found.mean = sums[0] > 0 ? sums[1] / sums[0] : 0;
  if (!mechanism && found.mean < hardly) return found;
  for (int plane = 0; plane < planes; ++plane) {
    if (size[plane] == 0) continue;
    const double within = found.within[plane] =
        mechanism ? size[plane] : std::max(strip * (range[0] + range[1]), size[plane]);
    int parts[dim], all = 1;  // of the plane, as long as the strip is wide
    for (int d = 0; d < dim; ++d) {
      const double length = -end_[2 * d + 1] - end_[2 * d];
      parts[d] = d == plane / 2 ? 1 : std::clamp(static_cast<int>(length / within), 1, most_parts), all *= parts[d];
    }
    const auto part_at = [&](const Vec<dim> &x) {
      int part = 0;
      for (int d = 0; d < dim; ++d) {
        const double share = (x[d] - end_[2 * d]) / (-end_[2 * d + 1] - end_[2 * d]);
        part = part * parts[d] + std::clamp(static_cast<int>(share * parts[d]), 0, parts[d] - 1);
      }
      return part;
    };
    std::vector<double> of(3 * static_cast<std::size_t>(all));
    double *mass = of.data(), *strain = mass + all, *faces = strain + all;
    std::vector<double> top(all, -far);
    soil([&](const Point &p) {
      const int part = part_at(p.start);
      top[part] = std::max(top[part], p.start[up]);
      if (-end_[plane] - (plane % 2 ? 1 : -1) * p.start[plane / 2] > within) return;
      mass[part] += p.mass, strain[part] += p.mass * p.strain;
    });
    for (const Face &face : faces_) {
      if (face.plane != plane) continue;
      Vec<dim> middle{};
      for (const int node : world_.mesh.cells[face.cell].node)
        for (int d = 0; d < dim; ++d) middle[d] += world_.mesh.position[node][d] / (dim + 1);
      ++faces[part_at(middle)];
    }
    MPI_Allreduce(MPI_IN_PLACE, of.data(), static_cast<int>(of.size()), MPI_DOUBLE, MPI_SUM, world_.comm);
    MPI_Allreduce(MPI_IN_PLACE, top.data(), all, MPI_DOUBLE, MPI_MAX, world_.comm);
    double total = 0;
    bool ground = false;  // comes down to the bottom, which is then that of a slope on firm ground
    int filled = 0, covered = 0, with_faces = 0;
    for (int k = 0; k < all; ++k) {
      total += mass[k], filled += mass[k] > 0;
      with_faces += faces[k] > 0, covered += faces[k] > 0 && mass[k] > 0;
      ground = ground || (mechanism && mass[k] > 0 && top[k] - end_[bottom()] < thin * size[plane]);
    }
    if (plane == bottom() && (ground || covered < (1 - bare) * with_faces)) continue;
    for (int k = 0; k < all; ++k)
      if (mass[k] > few * total / filled) found.beside[plane] = std::max(found.beside[plane], strain[k] / mass[k]);
  }
  return found;
}

template <int dim>
std::vector<typename MeshEnds<dim>::Reached> MeshEnds<dim>::reached(const Soil &soil, bool mechanism) const {
  constexpr double along = 0.5;  // cosine of way and normal, from which on a side is in front of a slide or behind it
  const int up = world_.scene.vertical();
  OfPlanes size{}, most{};
  double largest = 0, slid[dim]{};
  int group[planes];
  std::fill_n(group, planes, -1);
  for (const Face &face : faces_)
    if (face.plane == bottom() || (face.slips && face.plane / 2 != up))
      size[face.plane] = std::max(size[face.plane], face.depth), group[face.plane] = face.group;
  MPI_Allreduce(MPI_IN_PLACE, size.data(), planes, MPI_DOUBLE, MPI_MAX, world_.comm);
  soil([&](const Point &p) {
    double square = 0;
    for (const double part : p.way) square += part * part;
    const double moved = std::sqrt(square);
    largest = std::max(largest, moved);
    for (int d = 0; d < dim; ++d)
      if (d != up) slid[d] += p.mass * p.way[d];
    for (int plane = 0; plane < planes; ++plane) {
      const double outward = (plane % 2 ? 1 : -1) * p.start[plane / 2];
      if (-end_[plane] - outward <= size[plane]) most[plane] = std::max(most[plane], moved);
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, most.data(), planes, MPI_DOUBLE, MPI_MAX, world_.comm);
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, world_.comm);
  MPI_Allreduce(MPI_IN_PLACE, slid, dim, MPI_DOUBLE, MPI_SUM, world_.comm);
  MPI_Allreduce(MPI_IN_PLACE, group, planes, MPI_INT, MPI_MAX, world_.comm);
  double way = 0;
  for (const double part : slid) way += part * part;
  const Sheared sheared = this->sheared(soil, size, mechanism);
  std::vector<Reached> ends;
  for (int plane = 0; plane < planes; ++plane) {
    if (size[plane] == 0 || (!mechanism && largest <= size[plane])) continue;
    const bool below = plane == bottom();
    const double outward = (plane % 2 ? 1 : -1) * slid[plane / 2] / std::sqrt(way > 0 ? way : 1);
    if (!below && std::abs(outward) < along) continue;
    const bool cuts = !below && most[plane] > (mechanism ? mechanism_share : cut_share) * largest;
    if (!cuts && sheared.beside[plane] <= reached_share * sheared.mean) continue;
    const std::string &name = group[plane] < 0 ? "" : world_.mesh.group_names()[static_cast<std::size_t>(group[plane])];
    ends.push_back(
        {below, cuts,
         name.empty() ? std::string(plane % 2 ? "at the largest " : "at the smallest ") + "xyz"[plane / 2] +
                            std::string(", which no group names,")
                      : "at the group " + name,
         most[plane], largest, sheared.beside[plane], sheared.mean, sheared.within[plane],
         std::string("Extend the section ") +
             (below ? "downwards, unless firm ground begins there in nature"
              : outward < 0
                  ? "behind the crest, unless the soil ends there in nature or this is a plane of symmetry"
                  : "in front of the toe, unless the soil ends there in nature or this is a plane of symmetry")});
  }
  return ends;
}

template <int dim>
std::vector<std::string> MeshEnds<dim>::cut_off() const {
  return sentences(
      [this](const std::function<void(const Point &)> &visit) {
        for (const auto &body : world_.bodies) {
          const ParticleArrays<dim> &p = body->particles();
          const int memory = body->history_count(), field = plastic_strain_field(body->law());
          for (int i = 0; i < p.count; ++i) {
            Point point{p.reference[i], {}, p.mass[i], 0};
            for (int d = 0; d < dim; ++d) point.way[d] = p.position[i][d] - p.reference[i][d];
            if (field >= 0) point.strain = p.history[static_cast<std::size_t>(i) * memory + field];
            visit(point);
          }
        }
      },
      false);
}

template <int dim>
std::vector<std::string> MeshEnds<dim>::sentences(const Soil &soil, bool mechanism) const {
  std::vector<std::string> all;
  if (world_.scene.acknowledges("mesh_end")) return all;
  const std::string what = mechanism ? "mechanism" : "slide";
  const auto percent = [](double share) { return rounded(100 * share) + " %"; };
  for (const Reached &end : reached(soil, mechanism))
    all.push_back(
        (end.cuts ? "the end of the mesh " + end.place + " cuts the " + what +
                        " off: soil that lay there has moved by " + (mechanism ? "" : rounded(end.moved) + " m, ") +
                        percent(end.moved / end.of) + " of the largest displacement"
                  : "the " + what + " reaches the " + (end.below ? "fixed bottom" : "end") + " of the mesh " +
                        end.place + ": soil within " + rounded(end.within) + " m of it shears by " +
                        percent(end.strain / end.mean) + " of the mean of what shears") +
        ", so that the " + (mechanism ? "factor of safety depends" : "load at failure and the run-out depend") +
        " on where the mesh ends. " + end.advice + " [mesh_end]");
  return all;
}

template class MeshEnds<2>;
template class MeshEnds<3>;

}  // namespace talus
