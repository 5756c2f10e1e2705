#include "solvers/quasi_static/loads.h"

#include <algorithm>

#include "physics/boundary/pore_conditions.h"
#include "physics/prescribed_pressure.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "solvers/quasi_static/unnamed_faces.h"

namespace talus {

template <int dim>
void Loads<dim>::activate() {
  facets_.clear();
  const BackgroundMesh<dim> &mesh = soil_.mesh();
  for (size_t s = 0; s < sources_.size(); ++s) {
    if (sources_[s].kind.quasi_static != OnSoil::load && !sources_[s].kind.open_water) continue;
    for (const std::string &group : sources_[s].groups)
      for (const Facet<dim> &facet : mesh.has_group(group) ? mesh.facets(group) : std::vector<Facet<dim>>{}) {
        if (!soil_.active(facet.cell)) continue;
        const int across = mesh.cells[facet.cell].neighbour[facet.face];
        facets_.push_back({facet, static_cast<int>(s), across >= 0 && soil_.active(across) ? 0.5 : 1.,
                           soil_.nodes().of_facet(facet.cell, facet.face)});
      }
  }
  const auto open = std::ranges::find_if(sources_, [](const Source &source) {
    return source.kind.open_water && std::ranges::count(source.groups, std::string(free_surface));
  });
  if (open == sources_.end()) return;
  for (const Facet<dim> &facet : unnamed_faces(mesh, soil_.active(), sources_))
    facets_.push_back(
        {facet, static_cast<int>(open - sources_.begin()), 1., soil_.nodes().of_facet(facet.cell, facet.face)});
}

template <int dim>
double Loads<dim>::pore_pressure(const Vec<dim> &x, double t, int soil) const {
  const double p = data_.pressure(x, t, soil);
  return soil_.suction_matters() ? std::max(0., p) : p;
}

/// Weight, pore pressure and body acceleration of a cell. With open water on submerged faces the common water acts by
/// -grad p, otherwise as a part of the stress. So does, in any case, the difference that water of the soil's own makes:
/// it may jump at the soil's border, across which total stress is continuous.
template <int dim>
void Loads<dim>::add_volume(int c, double t, bool only_weight, std::vector<double> &force) const {
  const BackgroundMesh<dim> &mesh = soil_.mesh();
  const int order = soil_.nodes().order(), per_cell = element_nodes<dim>(order);
  std::array<double, element_nodes<dim>(2)> shape;
  std::array<Vec<dim>, element_nodes<dim>(2)> gradient;
  const BodySource &source = scene_.body[soil_.body_of(c)];
  const int *node = soil_.nodes().of_cell(c);
  const auto add = [&](int a, double scale, const Vec<dim> &v) {
    for (int d = 0; d < dim; ++d) force[node[a] * dim + d] += scale * v[d];
  };
  std::array<double, dim + 1> stress{};  // at the vertices, linear between them as in the motion of particles
  Vec<dim> slope{};
  const auto of_l = barycentric_gradients<dim>(mesh.cells[c]);
  const int soil = soil_.body_of(c);
  const bool pressed = data_.pressure && !only_weight, apart = pressed && data_.apart(soil),
             in_stress = pressed && (apart || !data_.open_water_load);
  if (pressed)
    for (int a = 0; a <= dim; ++a) {
      const Vec<dim> &x = mesh.position[mesh.cells[c].node[a]];
      const double common = pore_pressure(x, t, common_water);
      if (apart) stress[a] = pore_pressure(x, t, soil) - common;
      if (!data_.open_water_load) stress[a] += common;
      for (int d = 0; d < dim && data_.open_water_load; ++d) slope[d] += common * of_l[a][d];
    }
  const Quadrature<dim> &rule = soil_.rule();
  for (size_t q = 0; q < rule.point.size(); ++q) {
    const double volume = mesh.volume[c] * rule.weight[q];
    double density = data_.density(source, place_in(mesh, c, rule.point[q]), t);
    if (data_.flow) density += data_.flow->water_density(c, rule.point[q]);
    shape_functions<dim>(order, rule.point[q], shape.data());
    if (in_stress) shape_gradients<dim>(order, rule.point[q], of_l, gradient.data());
    double here = 0;
    for (int a = 0; a <= dim; ++a) here += rule.point[q][a] * stress[a];
    for (int a = 0; a < per_cell; ++a) {
      add(a, density * volume * shape[a], acceleration);
      if (pressed && data_.open_water_load) add(a, -volume * shape[a], slope);
      if (in_stress) add(a, volume * here, gradient[a]);
    }
  }
  if (source.body_acceleration.empty() || only_weight) return;
  for (size_t q = 0; q < rule_.point.size(); ++q) {
    const Vec<dim> x = place_in(mesh, c, rule_.point[q]);
    Vec<dim> b;
    for (int d = 0; d < dim; ++d) b[d] = source.body_acceleration[d](x[0], x[1], dim == 3 ? x[dim - 1] : 0, t);
    shape_functions<dim>(order, rule_.point[q], shape.data());
    const double density =
        data_.density(source, x, t) + (data_.flow ? data_.flow->water_density(c, rule_.point[q]) : 0);
    const double mass = mesh.volume[c] * rule_.weight[q] * density;
    for (int a = 0; a < per_cell; ++a) add(a, mass * shape[a], b);
  }
}

template <int dim>
void Loads<dim>::add_load(const LoadedFacet &load, double t, std::vector<double> &force) const {
  const ElementNodes<dim> &nodes = soil_.nodes();
  std::array<double, element_nodes<dim>(2)> shape;
  for (size_t q = 0; q < facet_rule_.point.size(); ++q) {
    Vec<dim> x{};
    for (int a = 0; a < dim; ++a)
      for (int d = 0; d < dim; ++d) x[d] += facet_rule_.point[q][a] * nodes.position[load.node[a]][d];
    shape_functions<dim - 1>(nodes.order(), facet_rule_.point[q], shape.data());
    const Vec<dim> traction = traction_of(load, x, t);
    const double area = load.share * load.facet.area * facet_rule_.weight[q];
    for (size_t a = 0; a < load.node.size(); ++a)
      for (int d = 0; d < dim; ++d) force[load.node[a] * dim + d] += area * shape[a] * traction[d];
  }
}

template <int dim>
void Loads<dim>::force(double t, std::vector<double> &force, const std::function<bool(int cell)> &counts) const {
  force.assign(static_cast<size_t>(soil_.nodes().count()) * dim, 0);
  for (int c = 0; c < soil_.mesh().cell_count(); ++c)
    if (soil_.active(c) && (!counts || counts(c))) add_volume(c, t, false, force);
  for (const LoadedFacet &load : facets_)
    if (!counts || counts(load.facet.cell)) add_load(load, t, force);
}

template <int dim>
void Loads<dim>::weight(double t, std::vector<double> &force, const std::function<bool(int cell)> &counts) const {
  force.assign(static_cast<size_t>(soil_.nodes().count()) * dim, 0);
  for (int c = 0; c < soil_.mesh().cell_count(); ++c)
    if (soil_.active(c) && (!counts || counts(c))) add_volume(c, t, true, force);
}

template <int dim>
void Loads<dim>::load_of(int source, double t, std::vector<double> &force,
                         const std::function<bool(int cell)> &counts) const {
  force.assign(static_cast<size_t>(soil_.nodes().count()) * dim, 0);
  for (const LoadedFacet &load : facets_)
    if (load.source == source && (!counts || counts(load.facet.cell))) add_load(load, t, force);
}

/// Force per area of a boundary that loads, and of open water [Pa].
template <int dim>
Vec<dim> Loads<dim>::traction_of(const LoadedFacet &load, const Vec<dim> &x, double t) const {
  const Boundary &kind = sources_[load.source].kind;
  Vec<dim> traction{};
  if (kind.quasi_static == OnSoil::load) traction = kind.template on_soil<dim>().load(load.facet.normal, x, t);
  if (kind.open_water) {
    const double pressure =
        kind.outside(x[0], x[1], dim == 3 ? x[dim - 1] : 0, t, {data_.flow->unit_weight(), x[scene_.vertical()]});
    for (int d = 0; d < dim; ++d) traction[d] -= pressure * load.facet.normal[d];
  }
  return traction;
}

template <int dim>
PetscErrorCode Loads<dim>::mean_displacement(std::vector<Vec<dim>> &face) const {
  PetscFunctionBeginUser;
  const int count = static_cast<int>(sources_.size());
  const std::vector<double> &u = soil_.displacement();
  face.assign(count, Vec<dim>{});
  std::vector<double> area(count, 0);
  std::array<double, element_nodes<dim>(2)> shape;
  for (const LoadedFacet &load : facets_)
    for (size_t q = 0; q < facet_rule_.point.size(); ++q) {
      shape_functions<dim - 1>(soil_.nodes().order(), facet_rule_.point[q], shape.data());
      const double weight = load.share * load.facet.area * facet_rule_.weight[q];
      area[load.source] += weight;
      for (size_t a = 0; a < load.node.size(); ++a)
        for (int d = 0; d < dim; ++d) face[load.source][d] += weight * shape[a] * u[load.node[a] * dim + d];
    }
  if (count) {
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, face[0].data(), count * dim, MPI_DOUBLE, MPI_SUM, soil_.nodes().comm()));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, area.data(), count, MPI_DOUBLE, MPI_SUM, soil_.nodes().comm()));
  }
  for (int s = 0; s < count; ++s)
    for (double &component : face[s]) component = area[s] > 0 ? component / area[s] : 0;
  PetscFunctionReturn(0);
}

template class Loads<2>;
template class Loads<3>;

}  // namespace talus
