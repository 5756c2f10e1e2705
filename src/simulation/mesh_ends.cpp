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

/// What boundaries do to a face.
struct Group {
  bool has_boundary = false, slips = true;
};

/// Of each local face of a named group, by cell and face.
template <int dim>
std::map<std::pair<int, int>, Group> groups_of_faces(const World<dim> &world) {
  std::map<std::pair<int, int>, Group> group_of;
  for (const std::string &name : world.mesh.group_names()) {
    const bool bounded = std::any_of(
        world.scene.boundary.begin(), world.scene.boundary.end(),
        [&](const BoundarySource &boundary) { return std::count(boundary.group.begin(), boundary.group.end(), name); });
    const bool slips = std::ranges::none_of(world.conditions.sources(), [&](const auto &source) {
      if (!std::ranges::count(source.groups, name) || source.kind.fluids_only()) return false;
      if (source.kind.in_motion != OnSoil::support) return true;
      Vec<dim> normal{};
      normal[0] = 1;
      const auto &find = source.kind.template on_soil<dim>().directions;
      return !find || static_cast<int>(find(normal).size()) == dim;
    });
    for (const Facet<dim> &facet : world.mesh.facets(name)) {
      Group &group = group_of[{facet.cell, facet.face}];
      if (!group.has_boundary) group = {bounded, slips};
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
  std::fill_n(end_, planes, std::numeric_limits<double>::infinity());
  for (const Vec<dim> &x : world.mesh.position)
    for (int p = 0; p < planes; ++p) end_[p] = std::min(end_[p], -outward(p, x));
  MPI_Allreduce(MPI_IN_PLACE, end_, planes, MPI_DOUBLE, MPI_MIN, world.comm);
  const auto group_of = groups_of_faces(world);
  for (int c = 0; c < world.mesh.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k) {
      if (world.mesh.cells[c].neighbour[k] != boundary) continue;
      for (int p = 0; p < planes; ++p) {
        double face = 0, depth = 0;  // distances from the plane
        for (int a = 0; a <= dim; ++a) {
          const double distance = -end_[p] - outward(p, world.mesh.position[world.mesh.cells[c].node[a]]);
          (a == k ? depth : face) = std::max(a == k ? depth : face, distance);
        }
        if (face > 1e-6 * depth) continue;
        const auto named = group_of.find({c, k});
        const Group group = named == group_of.end() ? Group{} : named->second;
        if (!group.has_boundary && world.scene.mesh->leaving_particles == WhenOutside::remove) continue;  // it goes on
        if (p == bottom() && group.slips) continue;
        faces_.push_back({c, p, depth, group.slips});
      }
    }
}

template <int dim>
std::vector<std::string> MeshEnds<dim>::newly_reached(const std::string &stage) {
  constexpr long long none = std::numeric_limits<long long>::max();
  std::array<long long, planes> mine, first;  // the smallest number of a particle at each plane, here and of all ranks
  std::array<std::string, planes> place;
  mine.fill(none);
  for (const auto &body : world_.bodies) {
    const ParticleArrays<dim> &p = body->particles();
    auto begin = faces_.begin();
    for (int i = 0; i < p.count; ++i) {
      if (i > 0 && p.cell[i] < p.cell[i - 1]) begin = faces_.begin();  // particles of a cell stand together
      begin = std::lower_bound(begin, faces_.end(), p.cell[i], [](const Face &f, int cell) { return f.cell < cell; });
      for (auto face = begin; face != faces_.end() && face->cell == p.cell[i]; ++face) {
        const int plane = face->plane;
        if (plane == bottom() || p.id[i] >= mine[plane]) continue;  // soil lies on the bottom
        if (outward(plane, p.position[i]) - outward(plane, p.reference[i]) <= face->depth) continue;
        mine[plane] = p.id[i];
        std::string &text = place[plane] = "";
        for (int e = 0; e < dim; ++e) text += (e ? ", " : "(") + rounded(p.position[i][e]);
        text += ") m";
      }
    }
  }
  MPI_Allreduce(mine.data(), first.data(), planes, MPI_LONG_LONG, MPI_MIN, world_.comm);
  std::vector<std::string> all;
  for (int plane = 0; plane < planes; ++plane) {
    if (first[plane] == none || told_[plane]) continue;
    told_[plane] = 1;
    const std::string where = text_of_first(world_.comm, mine[plane] == first[plane], place[plane]);
    const bool top = plane == 2 * world_.scene.vertical() + 1;
    all.push_back("moving soil has come to the end of the mesh at " + name_of(plane) + ", near " + where +
                  ", in stage " + stage + ": from now on " + (top ? "its height" : "its run-out") +
                  " is that of the mesh. Give the mesh more free space " + (top ? "above" : "there") +
                  ", unless a wall stands there in nature [mesh_end]");
  }
  return acknowledged() ? std::vector<std::string>{} : all;
}

template <int dim>
double MeshEnds<dim>::shear_beside(const Soil &soil, int plane, double within, double thin) const {
  constexpr double few = 0.3;      // of the mean mass: parts with less of it are corners
  constexpr double bare = 0.05;    // of the bottom
  constexpr int most_parts = 100;  // along an axis
  int parts[dim], all = 1;         // of the plane, as long as the strip is wide
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
  std::vector<double> of(3 * static_cast<std::size_t>(all)), top(all, -std::numeric_limits<double>::infinity());
  double *mass = of.data(), *strain = mass + all, *faces = strain + all;
  soil([&](const Point &p) {
    const int part = part_at(p.start);
    top[part] = std::max(top[part], p.start[world_.scene.vertical()]);
    if (-end_[plane] - outward(plane, p.start) > within) return;
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
  double total = 0, largest = 0;
  int filled = 0, covered = 0, with_faces = 0;
  for (int k = 0; k < all; ++k) {
    total += mass[k], filled += mass[k] > 0;
    with_faces += faces[k] > 0, covered += faces[k] > 0 && mass[k] > 0;
    if (plane == bottom() && mass[k] > 0 && top[k] - end_[plane] < thin) return 0;
  }
  if (plane == bottom() && covered < (1 - bare) * with_faces) return 0;
  for (int k = 0; k < all; ++k)
    if (mass[k] > few * total / filled) largest = std::max(largest, strain[k] / mass[k]);
  return largest;
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
  constexpr double along = 0.5;    // cosine of way and normal, from which on a side is in front of a slide or behind it
  constexpr double strip = 0.2;    // of the height of the soil: of selborne, whatever its cells, a shear band and more
  constexpr double hardly = 0.01;  // strain of soil that slides without shearing
  const int up = world_.scene.vertical();
  std::array<double, planes> size{}, most{};  // largest cell at each plane that counts; largest displacement there [m]
  for (const Face &face : faces_)
    if (face.plane == bottom() || (face.slips && face.plane / 2 != up))
      size[face.plane] = std::max(size[face.plane], face.depth);
  MPI_Allreduce(MPI_IN_PLACE, size.data(), planes, MPI_DOUBLE, MPI_MAX, world_.comm);
  double greatest[3]{0, -1e300, -1e300};  // displacement, elevation, and minus elevation
  double sums[dim + 2]{};                 // mass times level way, strain and its square
  soil([&](const Point &p) {
    const double moved = std::sqrt(dot<dim>(p.way, p.way));
    greatest[0] = std::max(greatest[0], moved);
    greatest[1] = std::max(greatest[1], p.start[up]), greatest[2] = std::max(greatest[2], -p.start[up]);
    for (int d = 0; d < dim; ++d) sums[d] += d == up ? 0 : p.mass * p.way[d];
    sums[dim] += p.mass * p.strain, sums[dim + 1] += p.mass * p.strain * p.strain;
    for (int plane = 0; plane < planes; ++plane)
      if (-end_[plane] - outward(plane, p.start) <= size[plane]) most[plane] = std::max(most[plane], moved);
  });
  MPI_Allreduce(MPI_IN_PLACE, most.data(), planes, MPI_DOUBLE, MPI_MAX, world_.comm);
  MPI_Allreduce(MPI_IN_PLACE, greatest, 3, MPI_DOUBLE, MPI_MAX, world_.comm);
  MPI_Allreduce(MPI_IN_PLACE, sums, dim + 2, MPI_DOUBLE, MPI_SUM, world_.comm);
  const double largest = greatest[0], mean = sums[dim] > 0 ? sums[dim + 1] / sums[dim] : 0;
  double way = 0;
  for (int d = 0; d < dim; ++d) way = std::hypot(way, sums[d]);
  const std::string what = mechanism ? "mechanism" : "slide";
  const auto percent = [](double share) { return rounded(100 * share) + " %"; };
  std::vector<std::string> all;
  for (int plane = 0; plane < planes; ++plane) {
    if (size[plane] == 0 || (!mechanism && largest <= size[plane])) continue;
    const bool below = plane == bottom();
    const double ahead = (plane % 2 ? 1 : -1) * sums[plane / 2] / (way > 0 ? way : 1);
    if (!below && std::abs(ahead) < along) continue;
    const bool cuts = !below && most[plane] > (mechanism ? mechanism_share : cut_share) * largest;
    const double within = mechanism ? size[plane] : std::max(strip * (greatest[1] + greatest[2]), size[plane]);
    double strain = 0;
    if (!cuts && (mechanism || mean >= hardly))
      strain = shear_beside(soil, plane, within, mechanism ? 2 * size[plane] : 0);
    if (!cuts && strain <= reached_share * mean) continue;
    all.push_back(
        (cuts ? "the end of the mesh at " + name_of(plane) + " cuts the " + what +
                    " off: soil that lay there has moved by " + (mechanism ? "" : rounded(most[plane]) + " m, ") +
                    percent(most[plane] / largest) + " of the largest displacement"
              : "the " + what + " reaches the " + (below ? "fixed bottom" : "end") + " of the mesh at " +
                    name_of(plane) + ": soil within " + rounded(within) + " m of it shears by " +
                    percent(strain / mean) + " of the mean of what shears") +
        ", so that the " + (mechanism ? "factor of safety depends" : "load at failure and the run-out depend") +
        " on where the mesh ends. Extend the section " +
        (below ? "downwards, unless firm ground begins there in nature"
               : std::string(ahead < 0 ? "behind the crest" : "in front of the toe") +
                     ", unless the soil ends there in nature or this is a plane of symmetry") +
        " [mesh_end]");
  }
  return acknowledged() ? std::vector<std::string>{} : all;
}

template class MeshEnds<2>;
template class MeshEnds<3>;

}  // namespace talus
