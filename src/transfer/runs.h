#pragma once
/// A run is a sequence of particles of one cell. On their way to and from the nodes the quantities of the cell stay in
/// registers, and each node is touched once.
#include <algorithm>

#include "transfer/transfer.h"

namespace talus {

/// Values of a history that a run holds in registers; further ones have loops of their own.
inline constexpr int unrolled_history = 4;

/// Particles that a run processes at a time. Work that calls functions is done after each such part, so that sums stay
/// in registers.
inline constexpr int run_part = 32;

/// Instantiates `one(dim, averaged, fluids)` for all that scenes may ask for.
#define TALUS_EACH_TRANSFER(one) TALUS_EACH_PHASES(one, 2) TALUS_EACH_PHASES(one, 3)
#define TALUS_EACH_PHASES(one, dim) \
  TALUS_EACH_KIND(one, dim, 0) TALUS_EACH_KIND(one, dim, 1) TALUS_EACH_KIND(one, dim, 2)
#define TALUS_EACH_KIND(one, dim, fluids) one(dim, true, fluids) one(dim, false, fluids)

/// Changes of the stress points that their particles take over, with averaged stress: factor of the volume, contents of
/// the pores [kg/m3], gains of history. They stand side by side, because the sweep over particles already reads and
/// writes as many arrays as the caches can prefetch.
template <int fluids, int dim>
void collect_changes(const PointSet &points, const Pores<dim> &pores, int history_count, double *change) {
  for (int q = 0; q < points.count; ++q) {
    *change++ = points.volume[q] / points.start_volume[q];
    // the fluid of a cell fills its pores evenly, so a particle that leaves the cell takes the pressure along
    for (int a = 0; a < fluids; ++a) *change++ = pores.mass[a][q] / (points.volume[q] - pores.grains[q]);
    for (int h = q * history_count; h < (q + 1) * history_count; ++h)
      *change++ = points.history[h] - points.start_history[h];
  }
}

/// Updates particles of one cell by what the nodes received since the last remap.
template <int dim, bool averaged, int fluids>
class RunFromNodes {
 public:
  static constexpr int vertices = dim + 1, components = stress_size<dim>;

  [[gnu::always_inline]] RunFromNodes(Body<dim> &body, const Lagrangian<dim> &from, int mesh_cell)
      : coordinates(from.grid.mesh().cells[mesh_cell]),
        body_(body),
        flip_(quad(from.flip)),
        over_density_(from.pores.over_density) {
    const int cell = from.grid.find_cell(mesh_cell);
#pragma GCC unroll 8
    for (int k = 0; k < vertices; ++k) {
      velocity_[k] = from.nodes.velocity[from.grid.shape[cell].node[k]];
      displacement_[k] = from.nodes.displacement[from.grid.shape[cell].node[k]];
#pragma GCC unroll 2
      for (int a = 0; a < fluids; ++a) fluid_velocity_[a][k] = from.nodes.fluid[a][from.grid.shape[cell].node[k]];
    }
    for (int a = 0; a < fluids; ++a) point_mass_[a] = from.pores.mass[a];
    if constexpr (averaged) {
      const int point = from.points.find(mesh_cell), count = body.history_count();
      stress = from.points.stress + point * components;
      const double *change = from.change + point * (1 + fluids + count);
      growth_ = change[0], content = change + 1, gain_ = change + 1 + fluids;
#pragma GCC unroll 4
      for (int h = 0; h < unrolled_history; ++h)
        if (h < count) first_gain_[h] = gain_[h];
    }
  }

  struct Moved {
    Quad coordinates;  ///< barycentric, in the cell that the particle may have left
    double pores;      ///< their volume, before the cap of the particle's [m3]
  };
  [[gnu::always_inline]] Moved move(int i) const {
    ParticleArrays<dim> &p = body_.particles();
    Quad v = flip_ * load<dim>(p.velocity[i].data()), x = load<dim>(p.position[i].data());
    const Quad n = coordinates(x);
#pragma GCC unroll 8
    for (int k = 0; k < vertices; ++k) {
      v += quad(n[k]) * velocity_[k];
      x += quad(n[k]) * displacement_[k];
    }
    store<dim>(p.velocity[i].data(), v);
    store<dim>(p.position[i].data(), x);
#pragma GCC unroll 2
    for (int a = 0; a < fluids; ++a) {
      Quad w = flip_ * load<dim>(p.fluid_velocity[a][i].data());
#pragma GCC unroll 8
      for (int k = 0; k < vertices; ++k) w += quad(n[k]) * fluid_velocity_[a][k];
      store<dim>(p.fluid_velocity[a][i].data(), w);
      if constexpr (!averaged) p.fluid_mass[a][i] = point_mass_[a][i];
    }
    double pores = 0;
    if constexpr (averaged) {
      const int count = body_.history_count();
#pragma GCC unroll 8
      for (int h = 0; h < unrolled_history; ++h)
        if (h < count) p.history[i * count + h] += first_gain_[h];
      p.volume[i] *= growth_;
      if constexpr (fluids > 0) pores = p.volume[i] - p.mass[i] * over_density_;
      if (body_.capped()) p.volume[i] = body_.admissible_volume(p.volume[i], p.rest_volume[i], p.history + i * count);
    }
    return {coordinates(x), pores};
  }
  /// Values of the history that `move` leaves for later, of particles first to last - 1.
  void move_rest(int first, int last) const {
    ParticleArrays<dim> &p = body_.particles();
    const int count = body_.history_count();
    if constexpr (averaged)
      for (int i = first; i < last; ++i)
        for (int h = unrolled_history; h < count; ++h) p.history[i * count + h] += gain_[h];
  }
  /// Writes the stress of the cell, and its fluids as they fill `pores`, to particle i.
  [[gnu::always_inline]] void give(int i, double pores) const {
    if constexpr (averaged) {
      std::copy_n(stress, components, &body_.particles().stress[i * components]);
#pragma GCC unroll 2
      for (int a = 0; a < fluids; ++a) body_.particles().fluid_mass[a][i] = content[a] * pores;
    }
  }

  const BarycentricMap<dim> coordinates;
  const double *stress = nullptr;   ///< of the stress point [Pa]
  const double *content = nullptr;  ///< of its pores, of each fluid [kg/m3]

 private:
  Body<dim> &body_;
  const Quad flip_;
  const double over_density_;
  const double *point_mass_[fluids ? fluids : 1]{};
  Quad velocity_[vertices], displacement_[vertices], fluid_velocity_[fluids ? fluids : 1][vertices];
  const double *gain_ = nullptr;
  double growth_ = 1, first_gain_[unrolled_history]{};
};

/// Adds particles of one cell to the grid, which their cell enters with them.
template <int dim, bool averaged, int fluids>
class RunToNodes {
 public:
  static constexpr int vertices = dim + 1, components = stress_size<dim>;

  [[gnu::always_inline]] RunToNodes(const Body<dim> &body, FilledGrid<dim> &grid, PointSet &points,
                                    const Pores<dim> &pores, int mesh_cell)
      : body_(body), grid_(grid), points_(points), pores_(pores), mesh_cell_(mesh_cell) {}

  /// Adds particle i with barycentric coordinates n; its stress, its fluids and what `add_rest` adds apart.
  [[gnu::always_inline]] void add(int i, Quad n) {
    const ParticleArrays<dim> &p = body_.particles();
    const Quad mn = quad(p.mass[i]) * n;
#pragma GCC unroll 8
    for (int k = 0; k < vertices; ++k) mass_[k] += quad(n[k]) * mn;
#pragma GCC unroll 8
    for (int d = 0; d < dim; ++d) {
      momentum_[d] += quad(p.velocity[i][d]) * mn;
    }
    share_ += quad(p.volume[i]) * n;
#pragma GCC unroll 2
    for (int a = 0; a < fluids; ++a)
#pragma GCC unroll 8
      for (int d = 0; d < dim; ++d) fluid_momentum_[a][d] += quad(p.fluid_velocity[a][i][d]) * mn;
    if constexpr (averaged && fluids > 0) grains_ += p.mass[i];
    if constexpr (averaged) {
      const int count = body_.history_count();
#pragma GCC unroll 4
      for (int h = 0; h < unrolled_history; ++h)
        if (h < count) history_[h] += p.volume[i] * p.history[i * count + h];
      limit_ += p.rest_volume[i];
    }
    ++count_;
  }
  /// Adds the stress and the fluids that particle i carries itself, with averaged stress ...
  [[gnu::always_inline]] void add_own(int i) {
    const ParticleArrays<dim> &p = body_.particles();
#pragma GCC unroll 8
    for (int s = 0; s < components; ++s) stress_[s] += p.volume[i] * p.stress[i * components + s];
#pragma GCC unroll 2
    for (int a = 0; a < fluids; ++a) fluid_mass_[a] += p.fluid_mass[a][i];
  }
  /// ... or, where all that are added have them in common, the volume of its pores [m3].
  [[gnu::always_inline]] void add_pores(double volume) { pore_volume_ += volume; }
  /// Sums into grid and stress points; `common` is the stress of all particles added and `content` that of their pores,
  /// null if they brought their own. The stress point of the cell, -1 if there is none or nothing was added.
  [[gnu::always_inline]] int finish(Vec<dim> *momentum, const double *common, const double *content) const {
    if (!count_) return -1;
    // what is entered with this run is set, not added to zeros, which would have to be written first
    const auto set = [](auto &sum, auto x) { sum = x; };
    const auto add = [](auto &sum, auto x) { sum += x; };
    const int cells = grid_.cell_count(), cell = grid_.enter_cell(mesh_cell_);
    cell == cells ? sum_into_cell(cell, set) : sum_into_cell(cell, add);
    double volume = 0;
#pragma GCC unroll 8
    for (int k = 0; k < vertices; ++k) {
      Vec<dim> &sum = momentum[grid_.shape[cell].node[k]];
#pragma GCC unroll 8
      for (int d = 0; d < dim; ++d) sum[d] += momentum_[d][k];
      volume += share_[k];
    }
    if constexpr (!averaged) return -1;
    const int known = points_.count, point = points_.enter(mesh_cell_, cell);
    point == known ? sum_into_point(point, common, content, volume, set)
                   : sum_into_point(point, common, content, volume, add);
    return point;
  }
  /// Adds what a law remembers of particle i beyond the first few values.
  void add_rest(int i, int point) const {
    const ParticleArrays<dim> &p = body_.particles();
    const int count = body_.history_count();
    double *history = points_.own_history.data() + point * count;
    for (int h = unrolled_history; h < count; ++h) history[h] += p.volume[i] * p.history[i * count + h];
  }

 private:
  template <class Sum>
  [[gnu::always_inline]] void sum_into_cell(int cell, Sum sum) const {
#pragma GCC unroll 2
    for (int a = 0; a < fluids; ++a)
#pragma GCC unroll 8
      for (int d = 0; d < dim; ++d) sum(pores_.impulse[a][cell][d], fluid_momentum_[a][d]);
    auto &matrix = grid_.mass_matrix[cell];
#pragma GCC unroll 8
    for (int k = 0, pair = vertices; k < vertices; ++k) {
      sum(matrix[k], mass_[k][k]), sum(grid_.nodal_share[cell][k], share_[k]);
#pragma GCC unroll 8
      for (int l = k + 1; l < vertices; ++l) sum(matrix[pair++], mass_[k][l]);
    }
  }
  template <class Sum>
  [[gnu::always_inline]] void sum_into_point(int point, const double *common, const double *content, double volume,
                                             Sum sum) const {
    const int count = body_.history_count();
    if constexpr (fluids > 0) sum(pores_.grains[point], grains_ * pores_.over_density);
#pragma GCC unroll 2
    for (int a = 0; a < fluids; ++a) sum(pores_.mass[a][point], content ? content[a] * pore_volume_ : fluid_mass_[a]);
    sum(points_.own_volume[point], volume), sum(points_.own_limit[point], limit_);
    double *stress = &points_.own_stress[point * components], *history = points_.own_history.data() + point * count;
#pragma GCC unroll 8
    for (int s = 0; s < components; ++s) sum(stress[s], common ? volume * common[s] : stress_[s]);
#pragma GCC unroll 4
    for (int h = 0; h < unrolled_history; ++h)
      if (h < count) sum(history[h], history_[h]);
    for (int h = unrolled_history; h < count; ++h) sum(history[h], 0.);  // add_rest follows
  }

  const Body<dim> &body_;
  FilledGrid<dim> &grid_;
  PointSet &points_;
  const Pores<dim> &pores_;
  const int mesh_cell_;
  int count_ = 0;
  Quad mass_[vertices]{}, momentum_[dim]{}, share_{}, fluid_momentum_[fluids ? fluids : 1][dim]{};
  double stress_[components]{}, history_[unrolled_history]{}, limit_ = 0, fluid_mass_[fluids ? fluids : 1]{},
                                                              grains_ = 0, pore_volume_ = 0;
};

}  // namespace talus
