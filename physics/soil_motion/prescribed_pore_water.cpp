#include "physics/soil_motion/prescribed_pore_water.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/room.h"
#include "meshes/locate.h"
#include "physics/laws/law.h"
#include "scene/body_source.h"

namespace talus {

template <int dim>
PrescribedPoreWater<dim>::PrescribedPoreWater(const BackgroundMesh<dim> &mesh, const Bodies &bodies,
                                              const PrescribedPressure<dim> &pressure)
    : mesh_(mesh), bodies_(bodies), pressure_(pressure) {
  make_room(extra_mass_, mesh.node_count());
  for (const auto &body : bodies) suction_matters_ = suction_matters_ || reads_suction(body->law());
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) apart_ = apart_ || pressure.apart(b);
}

template <int dim>
PetscErrorCode PrescribedPoreWater<dim>::begin(FilledGrid<dim> &grid, double time) {
  PetscFunctionBeginUser;
  PetscCall(measure(grid, time));
  sample_time_[1] = -std::numeric_limits<double>::infinity();
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode PrescribedPoreWater<dim>::advance_to(double time, FilledGrid<dim> &grid, const double *blend) {
  PetscFunctionBeginUser;
  sample(time, grid, blend), last_time_ = time;
  if (table_moves_) PetscCall(measure(grid, time));
  PetscFunctionReturn(0);
}

/// Mass by docs/theory (2.2) where a particle was at the last remap, less the particle's own.
template <int dim>
PetscErrorCode PrescribedPoreWater<dim>::measure(FilledGrid<dim> &grid, double time) {
  PetscFunctionBeginUser;
  table_moves_ = false;
  std::fill_n(extra_mass_.begin(), grid.node_count(), 0.);
  for (const auto &body : bodies_) {
    const BodySource &source = body->source();
    if (source.density > 0) continue;  // the same above and below the water table
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const double dry = source.grain_density * (1 - source.porosity);
      const double saturation = pressure_.saturation(source, p.position[i], time, pressure_.soil_of(p.cell[i]));
      const double extra = (dry + source.porosity * saturation * pressure_.density()) * p.initial_volume[i] - p.mass[i];
      if (std::abs(extra) <= 1e-12 * p.mass[i]) continue;
      const auto n = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
      const auto &node = grid.shape[grid.find_cell(p.cell[i])].node;
      for (int k = 0; k <= dim; ++k) extra_mass_[node[k]] += n[k] * extra;
    }
  }
  PetscCall(grid.sum(extra_mass_.data(), 1));
  PetscFunctionReturn(0);
}

/// Weight of vertex a in the mean of a linear function over the soil in a cell.
template <int dim>
double vertex_weight(const FilledGrid<dim> &grid, const double *blend, int c, int a) {
  double volume = 0;
  for (int k = 0; k <= dim; ++k) volume += grid.nodal_share[c][k];
  return blend[c] / (dim + 1) + (1 - blend[c]) * grid.nodal_share[c][a] / volume;
}

template <int dim>
void PrescribedPoreWater<dim>::sample(double time, const FilledGrid<dim> &grid, const double *blend) {
  constexpr double steps_ahead = 16;
  if (time >= sample_time_[0] && time <= sample_time_[1]) return;
  const double step = last_time_ < time ? time - last_time_ : 1e-6 * (1 + std::abs(time));
  const bool goes_on = sample_time_[1] < time && time < sample_time_[1] + steps_ahead * step;
  sample_time_[0] = goes_on ? sample_time_[1] : time, sample_time_[1] = time + steps_ahead * step;
  table_moves_ = pressure_.moves();
  if (goes_on) std::swap(sample_[0], sample_[1]);  // the later sample becomes the earlier one
  for (int k = goes_on ? 1 : 0; k < 2; ++k) {
    Sample &sample = sample_[k];
    const size_t nodes = mesh_.node_count(), cells = mesh_.cell_count();
    const auto all = [](auto &values, size_t count) {  // those of a checkpoint are as many as there was soil
      if (values.size() < count) make_room(values, count);
    };
    all(sample.nodal, nodes), all(sample.gradient, cells), all(sample.value, cells);
    if (suction_matters_) all(sample.suction, cells);
    if (apart_) all(sample.jump, cells);
    for (int i = 0; i < grid.node_count(); ++i)
      sample.nodal[i] = pressure_(mesh_.position[grid.mesh_node[i]], sample_time_[k], common_water);
    const auto in_cell = [&](int c, int node) {  // of the soil's own water
      const int soil = pressure_.soil_of(grid.mesh_cell[c]);
      return pressure_.apart(soil) ? pressure_(mesh_.position[grid.mesh_node[node]], sample_time_[k], soil)
                                   : sample.nodal[node];
    };
    if (suction_matters_) {
      for (int c = 0; c < grid.cell_count(); ++c) {
        sample.suction[c] = 0;
        for (int i : grid.shape[c].node) sample.suction[c] += std::max(0., -in_cell(c, i)) / (dim + 1);
      }
    }
    const auto stress_part = [this](double p) { return suction_matters_ ? std::max(0., p) : p; };
    if (apart_) std::fill_n(sample.jump.begin(), grid.cell_count(), 0.);
    for (int c = 0; apart_ && c < grid.cell_count(); ++c)
      for (int a = 0; a <= dim; ++a) {
        const int i = grid.shape[c].node[a];
        sample.jump[c] +=
            vertex_weight(grid, blend, c, a) * (stress_part(in_cell(c, i)) - stress_part(sample.nodal[i]));
      }
    for (int i = 0; i < grid.node_count(); ++i) sample.nodal[i] = stress_part(sample.nodal[i]);
    for (int c = 0; c < grid.cell_count(); ++c) {
      const auto &node = grid.shape[c].node;
      const Cell<dim> &cell = mesh_.cells[grid.mesh_cell[c]];
      Vec<dim> gradient{};
      double value = 0;
      for (int a = 0; a < dim; ++a)
        for (int d = 0; d < dim; ++d)
          gradient[d] += (sample.nodal[node[a + 1]] - sample.nodal[node[0]]) * cell.gradient[a][d];
      for (int a = 0; a <= dim; ++a) value += sample.nodal[node[a]] * vertex_weight(grid, blend, c, a);
      sample.gradient[c] = gradient, sample.value[c] = value;
    }
    find_body_force(grid, sample);
  }
}

/// -grad p on the soil in each cell.
template <int dim>
void PrescribedPoreWater<dim>::find_body_force(const FilledGrid<dim> &grid, Sample &sample) const {
  if (!pressure_.open_water_load()) return;
  if (sample.body_force.empty()) make_room(sample.body_force, mesh_.node_count());
  std::fill_n(sample.body_force.begin(), grid.node_count(), Vec<dim>{});
  for (int c = 0; c < grid.cell_count(); ++c)
    for (int k = 0; k <= dim; ++k)
      add_scaled<dim>(sample.body_force[grid.shape[c].node[k]], -grid.nodal_share[c][k], sample.gradient[c]);
}

/// Weights of the two samples at a time, times the ramp. A trial state beyond the later one sees the line go on.
template <int dim>
std::array<double, 2> PrescribedPoreWater<dim>::shares(double time, double ramp) const {
  const double late = ramp * (time - sample_time_[0]) / (sample_time_[1] - sample_time_[0]);
  return {ramp - late, late};
}

template <int dim>
void PrescribedPoreWater<dim>::add_force(const FilledGrid<dim> &grid, const SoilState<dim> &state, double time,
                                         double ramp, Vec<dim> *force) const {
  const auto [early, late] = shares(time, ramp);
  const bool open = pressure_.open_water_load();
  for (int i = 0; open && i < grid.node_count(); ++i)
    for (int d = 0; d < dim; ++d)
      force[i][d] += early * sample_[0].body_force[i][d] + late * sample_[1].body_force[i][d];
  for (int c = 0; (apart_ || !open) && c < grid.cell_count(); ++c) {
    const Shape<dim> &shape = state.shape[c];
    const auto &node = shape.node;
    double stress = apart_ ? early * sample_[0].jump[c] + late * sample_[1].jump[c] : 0;
    if (!open) stress += early * sample_[0].value[c] + late * sample_[1].value[c];
    const double push = state.weight[c] * stress;
    for (int k = 0; k < dim; ++k)
      for (int d = 0; d < dim; ++d) {
        force[node[k + 1]][d] += push * shape.gradient[k][d];
        force[node[0]][d] -= push * shape.gradient[k][d];
      }
  }
}

template <int dim>
const double *PrescribedPoreWater<dim>::suction(const FilledGrid<dim> &grid, const double *blend,
                                                const PointSet &points, double time, double ramp) {
  sample(time, grid, blend);
  const auto [early, late] = shares(time, ramp);
  suction_.resize(std::max<size_t>(suction_.size(), points.count));
  for (int q = 0; q < points.count; ++q)
    suction_[q] = early * sample_[0].suction[points.cell[q]] + late * sample_[1].suction[points.cell[q]];
  return suction_.data();
}

template <int dim>
void PrescribedPoreWater<dim>::serialize(Archive &archive, const FilledGrid<dim> &grid,
                                         const typename FilledGrid<dim>::Rows &rows) {
  archive.serialize("pore water", sample_time_, last_time_, table_moves_);
  archive.column(rows.nodes, "extra mass", extra_mass_);
  const bool sampled = sample_time_[1] > sample_time_[0];
  if (!sampled) return;  // since the remap, which may have filled more cells than the samples know
  for (Sample &sample : sample_) {
    archive.column(rows.cells, "gradient of pore pressure", sample.gradient);
    archive.column(rows.cells, "pore pressure", sample.value);
    archive.column(rows.nodes, "nodal pore pressure", sample.nodal);
    archive.column(rows.cells, "suction", sample.suction);
    archive.column(rows.cells, "jump of pore pressure", sample.jump);
    if (archive.reading()) find_body_force(grid, sample);
  }
}

template class PrescribedPoreWater<2>;
template class PrescribedPoreWater<3>;

}  // namespace talus
