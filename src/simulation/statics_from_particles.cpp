// What finite elements take over from particles after motion: stress and history, pore pressure, displacement.
#include <algorithm>
#include <cmath>
#include <limits>

#include "output/together.h"
#include "scene/scene.h"
#include "simulation/statics.h"

namespace talus {

/// The other way after a dynamic stage: Gauss points take the mean of the particles in their cell, weighted by volume;
/// cells that have none keep what they had.
template <int dim>
void Statics<dim>::to_gauss_points() {
  problem_->bases().release();
  if (world_.motion->gathered()) require(world_.release(clock_.time));
  check_places();
  find_what_moved();
  pressure_from_particles();
  displacement_from_particles();
  for (size_t b = 0; b < world_.bodies.size(); ++b) {
    const ParticleArrays<dim> &p = world_.bodies[b]->particles();
    GaussPoints<dim> &points = problem_->soil().points()[b];
    const int memory = world_.bodies[b]->history_count(), width = stress_size<dim> + memory;
    std::vector<double> sums(static_cast<size_t>(world_.mesh.cell_count()) * width, 0),
        volume(world_.mesh.cell_count(), 0);
    for (int i = 0; i < p.count; ++i) {
      double *s = &sums[static_cast<size_t>(p.cell[i]) * width];
      volume[p.cell[i]] += p.volume[i];
      for (int k = 0; k < stress_size<dim>; ++k) s[k] += p.volume[i] * p.stress[i * stress_size<dim> + k];
      for (int k = 0; k < memory; ++k) s[stress_size<dim> + k] += p.volume[i] * p.history[i * memory + k];
    }
    for (int q = 0; q < points.count(); ++q) {
      const int cell = points.cell[q];
      if (volume[cell] == 0) continue;
      const double *s = &sums[static_cast<size_t>(cell) * width];
      for (int k = 0; k < stress_size<dim>; ++k) points.stress[q * stress_size<dim> + k] = s[k] / volume[cell];
      for (int k = 0; k < memory; ++k) points.history[q * memory + k] = s[stress_size<dim> + k] / volume[cell];
    }
  }
}

/// Finite elements have soil in the cells of its region alone.
template <int dim>
void Statics<dim>::check_places() const {
  std::string body;
  Vec<dim> where{};
  for (size_t b = 0; b < world_.bodies.size() && body.empty(); ++b) {
    const ParticleArrays<dim> &p = world_.bodies[b]->particles();
    for (int i = 0; i < p.count && body.empty(); ++i)
      if (problem_->soil().body_of(p.cell[i]) != static_cast<int>(b))
        body = world_.bodies[b]->name(), where = p.position[i];
  }
  const std::string place = place_of_first<dim>(world_.comm, !body.empty(), where);
  if (!place.empty())
    throw RunFailure("body." + text_of_first(world_.comm, !body.empty(), body) + " has soil at " + place +
                     ", outside of its region: finite elements compute soil at its place at the start, so a stage of "
                     "theirs can follow a motion only as long as the soil stays in its region; leave the stage out, or "
                     "end the motion earlier");
}

/// Means over the particles around the nodes of the flow, weighted by volume and shape function; not a number where
/// there are none.
template <int dim>
struct Statics<dim>::AroundNodes {
  std::vector<double> pressure;  ///< [Pa]
  /// How much of what a node knew beyond this mean still holds: all of it in soil that has stayed where it was at the
  /// last state of finite elements, nothing where soil has moved by half a cell.
  std::vector<double> stayed;
};

template <int dim>
template <int count, class Value>
std::vector<double> Statics<dim>::mean_of_particles(const ElementNodes<dim> &nodes, Value &&value) const {
  std::vector<double> sum(static_cast<size_t>(nodes.count()) * count, 0), weight = sum;
  for (const auto &body : world_.bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const int cell = p.cell[i];
      if (!problem_->soil().active(cell)) continue;
      const Barycentric<dim> l = barycentric(world_.mesh.cells[cell], p.position[i]);
      const std::array<double, count> own = value(*body, i);
      for (int a = 0; a <= dim; ++a)
        for (int k = 0; k < count; ++k) {
          const int n = nodes.of_cell(cell)[a] * count + k;
          weight[n] += p.volume[i] * l[a], sum[n] += p.volume[i] * l[a] * own[k];
        }
    }
  }
  for (std::vector<double> *all : {&sum, &weight}) require(nodes.sum(*all));
  for (size_t n = 0; n < sum.size(); ++n)
    sum[n] = weight[n] > 0 ? sum[n] / weight[n] : std::numeric_limits<double>::quiet_NaN();
  return sum;
}

template <int dim>
typename Statics<dim>::AroundNodes Statics<dim>::around_nodes() {
  require(world_.motion->begin(clock_.time));
  AroundNodes around;
  around.pressure = mean_of_particles<1>(flow_->nodes(), [this](const Body<dim> &body, int i) {
    return std::array{world_.motion->pores(body, i).liquid};
  });
  around.stayed = mean_of_particles<1>(flow_->nodes(), [this](const Body<dim> &body, int i) {
    const Vec<dim> way = moved_since(body.particles(), i);
    return std::array{std::sqrt(dot<dim>(way, way)) / element_size<dim>(world_.mesh.volume[body.particles().cell[i]])};
  });
  constexpr double half_a_cell = 0.5;
  for (double &moved : around.stayed) moved = std::isnan(moved) ? 0 : std::max(0., 1 - moved / half_a_cell);
  return around;
}

/// Displacement of a particle since finite elements had it.
template <int dim>
Vec<dim> Statics<dim>::moved_since(const ParticleArrays<dim> &p, int i) const {
  Vec<dim> way = problem_->soil().displacement(p.cell[i], barycentric(world_.mesh.cells[p.cell[i]], p.position[i]));
  for (int d = 0; d < dim; ++d) way[d] = p.position[i][d] - p.reference[i][d] - way[d];
  return way;
}

/// Nodes move on by the mean of the particles around them, so that displacement counts through all stages.
template <int dim>
void Statics<dim>::displacement_from_particles() {
  std::vector<double> way = mean_of_particles<dim>(
      problem_->soil().nodes(), [this](const Body<dim> &body, int i) { return moved_since(body.particles(), i); });
  spread(way);
  problem_->soil().add_displacement(way);
}

/// Vertices without particles around them take the mean of those beside them, from the soil on outwards. Collective.
template <int dim>
void Statics<dim>::spread(std::vector<double> &way) const {
  const SoilElements<dim> &soil = problem_->soil();
  const ElementNodes<dim> &nodes = soil.nodes();
  for (int found = 1; found;) {
    std::vector<double> sum(way.size(), 0), weight = sum;
    for (int c = 0; c < world_.mesh.cell_count(); ++c)
      for (int a = 0; a <= dim && soil.active(c); ++a)
        for (int b = 0; b <= dim; ++b)
          for (int d = 0; d < dim; ++d)
            if (const double w = way[nodes.of_cell(c)[a] * dim + d]; !std::isnan(w))
              sum[nodes.of_cell(c)[b] * dim + d] += w, weight[nodes.of_cell(c)[b] * dim + d] += 1;
    for (std::vector<double> *all : {&sum, &weight}) require(nodes.sum(*all));
    found = 0;
    for (size_t n = 0; n < way.size(); ++n)
      if (std::isnan(way[n]) && weight[n] > 0) way[n] = sum[n] / weight[n], found = 1;
    MPI_Allreduce(MPI_IN_PLACE, &found, 1, MPI_INT, MPI_MAX, world_.comm);
  }
  for (double &w : way) w = std::isnan(w) ? 0 : w;  // middles of edges, which follow from their ends
}

template <int dim>
void Statics<dim>::find_what_moved() {
  Moved found;
  std::vector<char> filled(world_.mesh.cell_count(), 0);
  for (const auto &body : world_.bodies) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const Vec<dim> way = moved_since(p, i), &v = p.velocity[i];
      filled[p.cell[i]] = 1;
      found.way = std::max(found.way, std::sqrt(dot<dim>(way, way)));
      found.speed = std::max(found.speed, std::sqrt(dot<dim>(v, v)));
    }
  }
  double largest[2] = {found.way, found.speed}, volume[2] = {};
  for (int c = 0; c < world_.mesh.cell_count(); ++c)
    if (problem_->soil().active(c))
      volume[0] += world_.mesh.volume[c], volume[1] += filled[c] ? 0 : world_.mesh.volume[c];
  MPI_Allreduce(MPI_IN_PLACE, largest, 2, MPI_DOUBLE, MPI_MAX, world_.comm);
  MPI_Allreduce(MPI_IN_PLACE, volume, 2, MPI_DOUBLE, MPI_SUM, world_.comm);
  found.way = largest[0], found.speed = largest[1], found.emptied = volume[0] > 0 ? volume[1] / volume[0] : 0;
  moved_ = found;
}

template <int dim>
void Statics<dim>::remember_nodes() {
  if (!world_.phases.liquid) return;
  const AroundNodes around = around_nodes();
  for (size_t i = 0; i < around.pressure.size(); ++i)
    flow_->above_mean[i] = std::isnan(around.pressure[i]) ? 0 : flow_->accepted[i] - around.pressure[i];
}

template <int dim>
void Statics<dim>::forget_nodes() {
  if (flow_) std::fill(flow_->above_mean.begin(), flow_->above_mean.end(), 0.);
}

template <int dim>
void Statics<dim>::reset_displacement() {
  if (!problem_) return;
  if (!current_ && world_.phases.liquid) {
    const AroundNodes around = around_nodes();
    for (size_t i = 0; i < around.stayed.size(); ++i) flow_->above_mean[i] *= around.stayed[i];
  }
  problem_->soil().reset_displacement();
  problem_->soil().displacement_is_taken();  // particles count anew too
}

/// Nodes take the mean of the particles around them, and keep by how much they were above it before soil moved: the
/// mean alone would flatten every front, and lose the water that it leaves out, docs/theory/seepage.md section 4.
template <int dim>
void Statics<dim>::pressure_from_particles() {
  if (!world_.phases.liquid) return;
  const AroundNodes around = around_nodes();
  for (size_t i = 0; i < around.pressure.size(); ++i)
    if (!std::isnan(around.pressure[i]))
      flow_->accepted[i] = flow_->pressure[i] = around.pressure[i] + around.stayed[i] * flow_->above_mean[i];
}

template void Statics<2>::to_gauss_points();
template void Statics<2>::remember_nodes();
template void Statics<2>::forget_nodes();
template void Statics<2>::reset_displacement();
template void Statics<3>::to_gauss_points();
template void Statics<3>::remember_nodes();
template void Statics<3>::forget_nodes();
template void Statics<3>::reset_displacement();

}  // namespace talus
