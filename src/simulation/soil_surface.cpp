// The surface of the soil at the start, as the doubts about a scene look at it.
#include <algorithm>
#include <map>
#include <numeric>
#include <type_traits>

#include "scene/boundary_source.h"
#include "scene/scene.h"
#include "simulation/world.h"
#include "solvers/quasi_static/element_nodes.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {
namespace {

using Corners = std::array<std::array<double, 3>, 3>;

/// The faces of all ranks, one rank's after the other's. Collective.
std::vector<SoilFace> gathered(MPI_Comm comm, const std::vector<SoilFace> &mine) {
  static_assert(std::is_trivially_copyable_v<SoilFace>);
  int ranks;
  MPI_Comm_size(comm, &ranks);
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  const int bytes = static_cast<int>(mine.size() * sizeof(SoilFace));
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  std::vector<SoilFace> all(starts[ranks] / sizeof(SoilFace));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), counts.data(), starts.data(), MPI_BYTE, comm);
  return all;
}

Corners sorted(Corners corner) {
  std::sort(corner.begin(), corner.end());
  return corner;
}

}  // namespace

template <int dim>
std::vector<SoilFace> World<dim>::surface() const {
  const std::vector<int> body_of = bodies_of_cells(mesh, scene);
  const std::vector<char> there = present_at_start();
  const auto has_soil = [&](int cell) { return body_of[cell] >= 0 && there[body_of[cell]]; };
  struct Given {
    bool acts = false, bounded = false, held = false;
    int water = -1;
  };
  std::map<std::pair<int, int>, Given> given;  // by cell and face: what boundaries do there
  for (const std::vector<Source> *sources : {&conditions.sources(), &seepage_sources})
    for (const Source &source : *sources) {
      const bool acts = !source.kind.fluids_only() || source.kind.open_water;
      if (!acts && !source.kind.fluid_face()) continue;
      const bool holds = !source.kind.fluids_only() && source.kind.in_motion != OnSoil::load;
      const auto named = std::ranges::find(scene.boundary, source.name, &BoundarySource::name);
      for (const std::string &group : source.groups)
        for (const Facet<dim> &facet : mesh.has_group(group) ? mesh.facets(group) : std::vector<Facet<dim>>{}) {
          Given &at = given[{facet.cell, facet.face}];
          at.acts |= acts, at.held |= holds, at.bounded |= !source.kind.fluids_only();
          if (source.kind.fluid_face()) at.water = static_cast<int>(named - scene.boundary.begin());
        }
    }
  std::vector<SoilFace> mine, inside;  // `inside`: on faces between ranks
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (!has_soil(c)) continue;
    const auto gradient = barycentric_gradients<dim>(mesh.cells[c]);
    for (int k = 0; k <= dim; ++k) {
      const int beyond = mesh.cells[c].neighbour[k];
      if (beyond >= 0 && has_soil(beyond)) continue;
      SoilFace face;
      face.body = body_of[c], face.ends_mesh = beyond == boundary;
      const double size = map<dim>(gradient[k]).norm();
      face.area = dim * mesh.volume[c] * size;
      for (int a = 0, n = 0; a <= dim; ++a)
        if (a != k) std::copy_n(mesh.position[mesh.cells[c].node[a]].begin(), dim, face.corner[n++].begin());
      for (int d = 0; d < dim; ++d) face.normal[d] = -gradient[k][d] / size;
      const auto found = given.find({c, k});
      if (found != given.end()) {
        const Given &at = found->second;
        face.conditioned = at.acts, face.held = at.held, face.water = at.water, face.bounded = at.bounded;
      }
      (beyond < boundary ? inside : mine).push_back(face);
    }
  }
  // a face between ranks that both sides have is inside the soil
  inside = gathered(comm, inside);
  std::map<Corners, int> sides;
  for (const SoilFace &face : inside) ++sides[sorted(face.corner)];
  std::vector<SoilFace> all = gathered(comm, mine);
  for (const SoilFace &face : inside)
    if (sides[sorted(face.corner)] == 1) all.push_back(face);
  return all;
}

template <int dim>
std::vector<std::array<double, 3>> World<dim>::downhill(const std::vector<std::string> &groups) const {
  const std::vector<int> body_of = bodies_of_cells(mesh, scene);
  std::vector<SoilFace> mine;
  for (const std::string &group : groups)
    for (const Facet<dim> &facet : mesh.has_group(group) ? mesh.facets(group) : std::vector<Facet<dim>>{}) {
      SoilFace face;
      face.body = body_of[facet.cell];
      for (int a = 0, n = 0; a <= dim; ++a)
        if (a != facet.face)
          std::copy_n(mesh.position[mesh.cells[facet.cell].node[a]].begin(), dim, face.corner[n++].begin());
      mine.push_back(face);
    }
  const std::vector<SoilFace> all = gathered(comm, mine);
  std::vector<std::array<double, 3>> middle(all.size(), std::array<double, 3>{});
  std::map<std::array<double, 3>, std::vector<std::size_t>> beside;  // of a corner: the facets that meet there
  std::vector<std::size_t> reached;
  std::vector<char> seen(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (int a = 0; a < dim; ++a) {
      beside[all[k].corner[a]].push_back(k);
      for (int d = 0; d < dim; ++d) middle[k][d] += all[k].corner[a][d] / dim;
    }
    if (all[k].body >= 0) reached.push_back(k), seen[k] = 1;
  }
  for (std::size_t next = 0; next < reached.size(); ++next)  // grows as it goes downhill
    for (int a = 0; a < dim; ++a)
      for (const std::size_t other : beside[all[reached[next]].corner[a]])
        if (!seen[other] && middle[other][scene.vertical()] < middle[reached[next]][scene.vertical()])
          reached.push_back(other), seen[other] = 1;
  std::vector<std::array<double, 3>> places;
  for (const std::size_t k : reached) places.push_back(middle[k]);
  return places;
}

template std::vector<SoilFace> World<2>::surface() const;
template std::vector<std::array<double, 3>> World<2>::downhill(const std::vector<std::string> &) const;
template std::vector<std::array<double, 3>> World<3>::downhill(const std::vector<std::string> &) const;
template std::vector<SoilFace> World<3>::surface() const;

}  // namespace talus
